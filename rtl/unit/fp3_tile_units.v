// SPDX-License-Identifier: Apache-2.0
// fp3_tile_units: the arithmetic of a tile, behind one socket for each stream of each lane.
//
// Purpose   A lane has units of its own, except where several schedulers share one adder and one
//           multiplier: then they ask, and an arbiter grants.
//
//           own       operands of a stream ──► unit ──► its result
//           shared    adds_i, muls_i ──► arbiter ──► grant_o
//                     operands of all ──► shared_arith ──► results of all
//
// Latency   UNIT_LATENCY from operands to result. A grant is for the operands TIMING_TOLD +
//           TIMING_OPERANDS cycles later.
// Hazard    In each cycle at most one scheduler has the adder, and one the multiplier.
`default_nettype none
`include "unit/socket.vh"
module fp3_tile_units #(
`include "config/config.vh"
) (
    input  wire                  clk_i,
    input  wire                  rst_i,
    // Who asks for what: each scheduler
    input  wire [SCHEDULERS-1:0] running_i,
    input  wire [SCHEDULERS-1:0] adds_i,
    input  wire [SCHEDULERS-1:0] muls_i,
    input  wire [SCHEDULERS-1:0] sweep_end_i, // the last of its sweep
    output wire [SCHEDULERS-1:0] grant_o,
    // Each lane of each scheduler, STREAMS parts
    input  wire [`FP3_OPERANDS_W*SCHEDULERS*LANES*STREAMS-1:0] operands_i,
    output wire [`FP3_RESULT_W*SCHEDULERS*LANES*STREAMS-1:0]   result_o
);
    genvar l, p;
    generate
        if (SCHEDULERS > 1) begin : g_shared
            wire [SCHEDULERS-1:0] adds_late, muls_late;
            reg idle_q;                              // the order begins anew, so that a run's cycles do not
            always @(posedge clk_i) idle_q <= running_i == {SCHEDULERS{1'b0}};      // depend on runs before it
            fp3_arbiter #(.N(SCHEDULERS)) u_arbiter (.clk_i(clk_i), .rst_i(rst_i || idle_q),
                .adds_i(adds_i), .muls_i(muls_i), .sweep_end_i(sweep_end_i), .grant_o(grant_o));
            fp3_delay #(.W(2*SCHEDULERS), .N(TIMING_TOLD + TIMING_OPERANDS)) u_granted (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({adds_i & grant_o, muls_i & grant_o}), .q_o({adds_late, muls_late}));
            fp3_shared_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .adds_i(adds_late), .muls_i(muls_late),
                .operands_i(operands_i), .result_o(result_o));
        end else begin : g_own
            assign grant_o = 1'b1;
            wire unused = &{rst_i, running_i, adds_i, muls_i, sweep_end_i};
            for (l = 0; l < LANES; l = l + 1) begin : g_lane
                for (p = 0; p < STREAMS; p = p + 1) begin : g_stream
                    localparam S = STREAMS * l + p;
                    fp3_unit #(.STREAM(p), .CONFIG(CONFIG)) u_unit (.clk_i(clk_i),
                        .operands_i(operands_i[`FP3_OPERANDS_W*S +: `FP3_OPERANDS_W]), .result_o(result_o[`FP3_RESULT_W*S +: `FP3_RESULT_W]));
                end
            end
        end
    endgenerate

`ifdef FP3_CHECK
    wire [SCHEDULERS-1:0] adding = adds_i & grant_o, multiplying = muls_i & grant_o;
    always @(posedge clk_i)
        if (!rst_i && (|(adding & (adding - 1'b1)) || |(multiplying & (multiplying - 1'b1)))) begin
            $display("%m: granted to more than one: adder %b, multiplier %b", adding, multiplying); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
