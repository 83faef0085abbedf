// SPDX-License-Identifier: Apache-2.0
// fp3_tile: schedulers and lanes with the arithmetic that they share.
//
// Purpose   Two ways to share. Several schedulers, each with a program of its own, share one adder
//           and one multiplier (the paper's Figure 3): they ask, and an arbiter grants. Or one
//           scheduler drives several lanes, each with units of its own: control is shared.
//           config_rules refuses several lanes under several schedulers.
//
//           scheduler ──┐ arbiter                         ┌─► lane ◄─► unit
//           scheduler ──┴───► shared_arith                scheduler ─► lane ◄─► unit
//
// Latency   See lane; UNIT_LATENCY from operands to result. A grant is for the operands TIMING_TOLD +
//           TIMING_OPERANDS cycles later.
// Hazard    In each cycle at most one scheduler has the adder, and one the multiplier (checked).
`default_nettype none
`include "host/answer.vh"
`include "lane/bundles.vh"
`include "sequence/issued.vh"
module fp3_tile #(
`include "config/config.vh"
) (
    input  wire                     clk_i,
    input  wire                     rst_i,
    // A host port for each scheduler
    input  wire [SCHEDULERS-1:0]    req_valid_i,
    input  wire                     req_write_i,
    input  wire [23:0]              req_addr_i,
    input  wire [31:0]              req_wdata_i,
    output wire [`FP3_ANSWER_W*SCHEDULERS-1:0] answer_o,
    output wire [SCHEDULERS-1:0]    irq_o,
    output wire [SCHEDULERS-1:0]    loads_o,       // see tile_scheduler
    output wire [SCHEDULERS-1:0]    stores_o,
    // Trace: STREAMS parts for each scheduler, and for each lane of each
    output wire [`FP3_ISSUED_W*SCHEDULERS*STREAMS-1:0]        issued_o,
    output wire [`FP3_WRITTEN_W*SCHEDULERS*LANES*STREAMS-1:0] written_o
);
    localparam N = LANES * STREAMS;        // sockets of a scheduler

    wire [SCHEDULERS-1:0]                   running, adds, muls, sweep_end, grant;
    wire [`FP3_OPERANDS_W*SCHEDULERS*N-1:0] operands;
    wire [`FP3_RESULT_W*SCHEDULERS*N-1:0]   results;

    genvar s, l, p;
    generate
        for (s = 0; s < SCHEDULERS; s = s + 1) begin : g_scheduler
            fp3_tile_scheduler #(.CONFIG(CONFIG)) u_scheduler (
                .clk_i(clk_i), .rst_i(rst_i),
                .req_valid_i(req_valid_i[s]), .req_write_i(req_write_i),
                .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
                .answer_o(answer_o[`FP3_ANSWER_W*s +: `FP3_ANSWER_W]), .irq_o(irq_o[s]),
                .running_o(running[s]), .adds_o(adds[s]), .muls_o(muls[s]), .sweep_end_o(sweep_end[s]),
                .grant_i(grant[s]), .loads_o(loads_o[s]), .stores_o(stores_o[s]),
                .operands_o(operands[`FP3_OPERANDS_W*N*s +: `FP3_OPERANDS_W*N]),
                .result_i(results[`FP3_RESULT_W*N*s +: `FP3_RESULT_W*N]),
                .written_o(written_o[`FP3_WRITTEN_W*N*s +: `FP3_WRITTEN_W*N]),
                .issued_o(issued_o[`FP3_ISSUED_W*STREAMS*s +: `FP3_ISSUED_W*STREAMS]));
        end

        if (SCHEDULERS > 1) begin : g_shared
            wire [SCHEDULERS-1:0] adds_late, muls_late;
            reg                   idle_q;            // the order begins anew, so that runs take the same cycles
            always @(posedge clk_i) idle_q <= running == {SCHEDULERS{1'b0}};
            fp3_arbiter #(.N(SCHEDULERS)) u_arbiter (.clk_i(clk_i), .rst_i(rst_i || idle_q),
                .adds_i(adds), .muls_i(muls), .sweep_end_i(sweep_end), .grant_o(grant));
            fp3_delay #(.W(2*SCHEDULERS), .N(TIMING_TOLD + TIMING_OPERANDS)) u_granted (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({adds & grant, muls & grant}), .q_o({adds_late, muls_late}));
            fp3_shared_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .adds_i(adds_late), .muls_i(muls_late),
                .operands_i(operands), .result_o(results));
        end else begin : g_own
            assign grant = 1'b1;
            wire unused = &{running, adds, muls, sweep_end};
            for (l = 0; l < LANES; l = l + 1) begin : g_lane
                for (p = 0; p < STREAMS; p = p + 1) begin : g_stream
                    localparam S = STREAMS * l + p;
                    fp3_unit #(.STREAM(p), .CONFIG(CONFIG)) u_unit (.clk_i(clk_i),
                        .operands_i(operands[`FP3_OPERANDS_W*S +: `FP3_OPERANDS_W]),
                        .result_o(results[`FP3_RESULT_W*S +: `FP3_RESULT_W]));
                end
            end
        end
    endgenerate

`ifdef FP3_CHECK
    wire [SCHEDULERS-1:0] adding = adds & grant, multiplying = muls & grant;
    always @(posedge clk_i)
        if (!rst_i && (|(adding & (adding - 1'b1)) || |(multiplying & (multiplying - 1'b1)))) begin
            $display("%m: granted to more than one: adder %b, multiplier %b", adding, multiplying); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
