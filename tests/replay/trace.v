// trace: stands in for a processor of two schedulers with three lanes each, to test sim/replay.v alone.
//
// Every read gives the inverse of its address. A write at ffffff00 retires something for as many
// cycles as it says, in some lanes: what, test_replay.py knows.
`default_nettype none
module trace #(
    parameter SCHEDULERS = 2,
    parameter LANES = 6
) (
    input  wire                        s_axi_aclk,
    input  wire                        s_axi_aresetn,
    input  wire [25:0]                 s_axi_awaddr,
    input  wire [2:0]                  s_axi_awprot,
    input  wire                        s_axi_awvalid,
    output wire                        s_axi_awready,
    input  wire [31:0]                 s_axi_wdata,
    input  wire [3:0]                  s_axi_wstrb,
    input  wire                        s_axi_wvalid,
    output wire                        s_axi_wready,
    output wire [1:0]                  s_axi_bresp,
    output reg                         s_axi_bvalid,
    input  wire                        s_axi_bready,
    input  wire [25:0]                 s_axi_araddr,
    input  wire [2:0]                  s_axi_arprot,
    input  wire                        s_axi_arvalid,
    output wire                        s_axi_arready,
    output reg  [31:0]                 s_axi_rdata,
    output wire [1:0]                  s_axi_rresp,
    output reg                         s_axi_rvalid,
    input  wire                        s_axi_rready,
    output wire                        irq,
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
    wire writes = s_axi_awvalid && s_axi_wvalid && !s_axi_bvalid && !busy;
    assign {s_axi_awready, s_axi_wready} = {2{writes}};
    assign s_axi_arready = !s_axi_rvalid && !busy;
    assign {s_axi_bresp, s_axi_rresp, irq} = 5'd0;
    always @(posedge s_axi_aclk)
        if (!s_axi_aresetn) begin
            {s_axi_bvalid, s_axi_rvalid} <= 2'b00;
            {left_q, time_q}             <= 64'd0;
        end else begin
            s_axi_bvalid <= s_axi_bvalid ? !s_axi_bready : writes;
            s_axi_rvalid <= s_axi_rvalid ? !s_axi_rready : s_axi_arvalid && !busy;
            if (!s_axi_rvalid) s_axi_rdata <= ~{6'd0, s_axi_araddr};
            if (writes && s_axi_awaddr == 26'h3ffff00) left_q <= s_axi_wdata;
            else if (busy) {left_q, time_q} <= {left_q - 32'd1, time_q + 32'd1};
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
