// hub: one host port in front of those of all schedulers.
//
// Purpose   The top of an address names a scheduler, or all of them: then a write goes to all, and
//           a read gives the OR of what they answer.
// Latency   Two cycles more than the scheduler's own port.
// Promise   Every request is answered; one to a scheduler that there is not, with an error.
// Hazard    Schedulers take a request in the same cycle: all that are asked are ready together.
`default_nettype none
module hub #(
    parameter N = 1                    // schedulers, at most 64
) (
    input  wire            clk_i,
    input  wire            rst_i,
    // The host
    input  wire            req_valid_i,
    output wire            req_ready_o,
    input  wire            req_write_i,
    input  wire [31:0]     req_addr_i,
    input  wire [31:0]     req_wdata_i,
    output wire            rsp_valid_o,
    input  wire            rsp_ready_i,
    output wire [31:0]     rsp_rdata_o,
    output wire            rsp_error_o,
    // The schedulers
    output wire [N-1:0]    req_valid_o,
    input  wire [N-1:0]    req_ready_i,
    output wire            req_write_o,
    output wire [23:0]     req_addr_o,
    output wire [31:0]     req_wdata_o,
    input  wire [N-1:0]    rsp_valid_i,
    output wire            rsp_ready_o,
    input  wire [32*N-1:0] rsp_rdata_i,
    input  wire [N-1:0]    rsp_error_i
);
`include "gen/registers.vh"
    localparam [7:0] ALL = ADDRESS_BROADCAST;

    reg         ask_q, wait_q, respond_q, error_q;
    reg [N-1:0] whom_q;
    reg         write_q;
    reg [23:0]  addr_q;
    reg [31:0]  wdata_q, rdata_q;

    wire [7:0]   who = req_addr_i[ADDRESS_SCHEDULER_HI:ADDRESS_SCHEDULER_LO];
    wire [N-1:0] whom;
    reg  [31:0]  rdata;
    integer      k;
    genvar       n;
    generate
        for (n = 0; n < N; n = n + 1) begin : g_whom
            localparam [7:0] NUMBER = n;
            assign whom[n] = who == NUMBER || who == ALL;
        end
    endgenerate
    always @* begin
        rdata = 32'd0;
        for (k = 0; k < N; k = k + 1) rdata = rdata | (rsp_rdata_i[32*k +: 32] & {32{whom_q[k]}});
    end

    assign req_ready_o = !rst_i && !ask_q && !wait_q && !respond_q;
    wire   taken    = |(whom_q & req_ready_i) || whom_q == {N{1'b0}};
    wire   answered = &(rsp_valid_i | ~whom_q);          // by all: a scheduler that runs refuses sooner
    always @(posedge clk_i) begin
        if (rst_i) {ask_q, wait_q, respond_q} <= 3'b000;
        else begin
            ask_q     <= (req_valid_i && req_ready_o) || (ask_q && !taken);
            wait_q    <= (ask_q && taken) || (wait_q && !answered);
            respond_q <= (wait_q && answered) || (respond_q && !rsp_ready_i);
        end
        if (req_valid_i && req_ready_o)
            {whom_q, write_q, addr_q, wdata_q} <= {whom, req_write_i, req_addr_i[23:0], req_wdata_i};
        if (wait_q) begin
            rdata_q <= rdata;
            error_q <= |(rsp_error_i & whom_q) || whom_q == {N{1'b0}};
        end
    end
    assign req_valid_o = whom_q & {N{ask_q}};
    assign {req_write_o, req_addr_o, req_wdata_o} = {write_q, addr_q, wdata_q};
    assign rsp_ready_o = wait_q && answered;
    assign rsp_valid_o = respond_q;
    assign rsp_rdata_o = rdata_q;
    assign rsp_error_o = error_q;

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i && ask_q && taken && |(whom_q & ~req_ready_i)) begin
            $display("%m: of the schedulers %b that are asked only %b are ready", whom_q, whom_q & req_ready_i); $stop;
        end
`endif
endmodule
`default_nettype wire
