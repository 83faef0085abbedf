// SPDX-License-Identifier: Apache-2.0
// fp3_hub: passes requests to the host ports of all schedulers.
//
// Purpose   The top of an address names a scheduler, or all schedulers: then a write goes to all,
//           and a read gives the OR of their answers. A request that does not stream waits until
//           QUIET cycles after the last write that does: by then the lanes have reported that write
//           (fp3).
//           The registers `pending` and `pending_more` are shown here, where all interrupts are:
//           the schedulers answer 0 there.
// Latency   One cycle on the way there, one back.
// Promise   Every request is answered; one to a nonexistent scheduler, with an error:
//           scheduler 0 is asked, for an address that nothing has.
// Hazard    Schedulers with the same request answer in the same cycle; a scheduler without a
//           request answers 0.
`default_nettype none
`include "host/answer.vh"
module fp3_hub #(
    parameter N = 1,                   // schedulers, at most 64
    parameter QUIET = 0,               // cycles
    parameter [31:0] STREAM = 0        // what streams has one of these bits in its address
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    // The host
    input  wire                   req_valid_i,
    output wire                   req_ready_o,
    input  wire                   req_write_i,
    input  wire [31:0]            req_addr_i,             // the scheduler in its top 8 bits
    input  wire [31:0]            req_wdata_i,
    output wire [`FP3_ANSWER_W-1:0]   answer_o,
    // The schedulers; address and data stand until the next request
    output wire [N-1:0]           req_valid_o,
    output wire                   req_write_o,
    output wire [23:0]            req_addr_o,
    output wire [31:0]            req_wdata_o,
    input  wire [`FP3_ANSWER_W*N-1:0] answer_i,
    input  wire [N-1:0]           irq_i
);
`include "gen/registers.vh"
    localparam [7:0]   ALL     = ADDRESS_BROADCAST;
    localparam [23:0]  NOWHERE = 24'd1;                 // no multiple of 4
    localparam [N-1:0] FIRST   = 1;

    reg [N-1:0] ask_q;
    reg         write_q;
    reg [23:0]  addr_q;
    reg [31:0]  wdata_q;

    // A register is alone: its address stands until it is answered.
    reg         pending_q;
    reg  [63:0] irqs;
    wire [31:0] pending = addr_q[2] ? irqs[63:32] : irqs[31:0];
    always @* begin
        irqs        = 64'd0;
        irqs[N-1:0] = irq_i;
    end

    wire [7:0]           who = req_addr_i[31:24];
    wire [N-1:0]         whom;
    wire                 nobody = whom == {N{1'b0}};
    reg  [`FP3_ANSWER_W-1:0] answer, answer_q;
    integer              k;
    genvar               n;
    generate
        for (n = 0; n < N; n = n + 1) begin : g_whom
            localparam [7:0] NUMBER = n;
            assign whom[n] = who == NUMBER || who == ALL;
        end
    endgenerate
    // The time since the last streaming write
    wire takes;
    generate
        if (QUIET == 0) begin : g_no_quiet
            assign takes = 1'b1;
        end else begin : g_quiet
            localparam W = $clog2(QUIET + 1);
            wire         streams = |(req_addr_i & STREAM);
            reg  [W-1:0] left_q;
            wire         quiet   = left_q == {W{1'b0}};
            always @(posedge clk_i)
                if (rst_i)                                     left_q <= {W{1'b0}};
                else if (req_valid_i && req_write_i && streams) left_q <= QUIET[W-1:0];
                else if (!quiet)                               left_q <= left_q - 1'b1;
            assign takes = quiet || streams;
        end
    endgenerate
    always @* begin
        answer = {`FP3_ANSWER_W{1'b0}} | {{`FP3_ANSWER_W-32{1'b0}}, pending & {32{pending_q}}};
        for (k = 0; k < N; k = k + 1) answer = answer | answer_i[`FP3_ANSWER_W*k +: `FP3_ANSWER_W];
    end

    always @(posedge clk_i) begin
        ask_q    <= (nobody ? FIRST : whom) & {N{req_valid_i && !rst_i && takes}};
        answer_q <= answer;
        if (rst_i) pending_q <= 1'b0;
        else if (req_valid_i && takes) pending_q <= !nobody && req_addr_i[23:3] == {8'd0, ADDR_PENDING[15:3]};
        if (req_valid_i && takes) {write_q, addr_q, wdata_q} <= {req_write_i, nobody ? NOWHERE : req_addr_i[23:0], req_wdata_i};
    end
    assign req_ready_o = !rst_i && takes;
    assign req_valid_o = ask_q;
    assign {req_write_o, req_addr_o, req_wdata_o} = {write_q, addr_q, wdata_q};
    // The bus may be out of reset already; answers to requests from before the reset are dropped.
    `FP3_ANSWER_FIELDS
    assign `FP3_ANSWER  = answer_q;
    assign answer_o = {answer_wrote && !rst_i, answer_write_error, answer_read && !rst_i, answer_read_error, answer_rdata};

`ifdef FP3_CHECK
    reg  [2*N-1:0] writes_q;           // the schedulers that a write was for, in the last two cycles
    wire [N-1:0]   wrote;
    generate
        for (n = 0; n < N; n = n + 1) begin : g_wrote
            assign wrote[n] = answer_i[`FP3_ANSWER_W*(n+1) - 1];
        end
    endgenerate
    always @(posedge clk_i) begin
        writes_q <= rst_i ? {2*N{1'b0}} : {writes_q[N-1:0], ask_q & {N{write_q}}};
        if (!rst_i && wrote != writes_q[N +: N]) begin
            $display("%m: the schedulers %b were asked to write, %b answer", writes_q[N +: N], wrote); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
