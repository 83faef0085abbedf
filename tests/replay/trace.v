// trace: stands in for a processor of two schedulers with three lanes each, to test sim/replay.v alone.
//
// Every read gives the inverse of its address. A write at ffffff00 retires something for as many
// cycles as it says, in some lanes: what, test_replay.py knows.
`default_nettype none
module trace #(
    parameter SCHEDULERS = 2,
    parameter LANES = 6
) (
    input  wire                        clk_i,
    input  wire                        rst_i,
    input  wire                        req_valid_i,
    output wire                        req_ready_o,
    input  wire                        req_write_i,
    input  wire [31:0]                 req_addr_i,
    input  wire [31:0]                 req_wdata_i,
    output reg                         rsp_valid_o,
    input  wire                        rsp_ready_i,
    output reg  [31:0]                 rsp_rdata_o,
    output wire                        rsp_error_o,
    output wire [SCHEDULERS-1:0]       issue_valid_o,
    output wire [16*SCHEDULERS-1:0]    issue_pc_o,
    output wire [16*SCHEDULERS-1:0]    issue_context_o,
    output wire [32*SCHEDULERS-1:0]    issue_word_o,
    output wire [LANES-1:0]            retire_valid_o,
    output wire [16*LANES-1:0]         retire_context_o,
    output wire [32*LANES-1:0]         retire_object_o,
    output wire [6*LANES-1:0]          retire_register_o,
    output wire [32*LANES-1:0]         retire_value_o,
    output wire [5*LANES-1:0]          retire_flags_o
);
    reg [31:0] left_q, time_q;
    wire busy = left_q != 32'd0;
    assign req_ready_o = !rsp_valid_o && !busy;
    assign rsp_error_o = 1'b0;
    always @(posedge clk_i)
        if (rst_i) begin
            rsp_valid_o <= 1'b0;
            left_q      <= 32'd0;
            time_q      <= 32'd0;
        end else begin
            if (req_valid_i && req_ready_o) begin
                rsp_valid_o <= 1'b1;
                rsp_rdata_o <= ~req_addr_i;
                if (req_write_i && req_addr_i == 32'hffffff00) left_q <= req_wdata_i;
            end else if (rsp_ready_i) rsp_valid_o <= 1'b0;
            if (busy) {left_q, time_q} <= {left_q - 32'd1, time_q + 32'd1};
        end

    genvar s, n;
    generate
        for (s = 0; s < SCHEDULERS; s = s + 1) begin : g_scheduler
            assign issue_valid_o[s]             = busy && time_q[s];
            assign issue_pc_o[16*s +: 16]       = time_q[15:0];
            assign issue_context_o[16*s +: 16]  = s;
            assign issue_word_o[32*s +: 32]     = 32'h20001083 + 32'h08000000 * s;
        end
        for (n = 0; n < LANES; n = n + 1) begin : g_lane
            wire [31:0] mix = 32'd2654435761 * (time_q * 32'd64 + n + 32'd1);
            assign retire_valid_o[n]            = busy && mix[31];
            assign retire_context_o[16*n +: 16] = n;
            assign retire_object_o[32*n +: 32]  = time_q * 32'd1000 + n;
            assign retire_register_o[6*n +: 6]  = mix[5:0];
            assign retire_value_o[32*n +: 32]   = mix;
            assign retire_flags_o[5*n +: 5]     = mix[30:26];
        end
    endgenerate
endmodule
`default_nettype wire
