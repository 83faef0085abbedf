// SPDX-License-Identifier: Apache-2.0
// fp3_draws: which draw rounds the word that an object stores.
//
// Purpose   A draw depends only on the seed, the object, the step and the register, so every
//           engine, any number of lanes and any order of objects give the same bits. draw =
//           mix(mix(seed ^ step ^ register << 26) + object); a lane uses its low 16 bits. This
//           module computes the part that all lanes share; each lane adds its own part of the
//           number. Objects are visited in the order of their rows, so an object's number is the
//           last one plus the stride. If objects can sleep, their order varies, and each lane finds
//           the number itself.
//
// Latency   draw_o TIMING_MIX + 2 cycles after issue_i, TIMING_MIX + 1 after issue's ISSUE.
// Hazard    first_i comes with the first context of each sweep. A sweep goes through all objects of
//           its batch.
//
//     first = 5, stride = 2, two contexts:     batch 1: objects 5, 7     batch 2: objects 9, 11
`default_nettype none
`include "gen/settings.vh"
`include "front/marks.vh"
`include "lane/bundles.vh"
module fp3_draws #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire [`FP3_SETTINGS_W-1:0] settings_i,
    input  wire                   open_i,        // a round begins
    input  wire [31:0]            base_i,        // the number of the last step before it
    input  wire [31:0]            end_i,         // of its last step
    input  wire                   issue_i,
    input  wire                   first_i,       // of its sweep
    input  wire [`FP3_MARKS_W-1:0]    marks_i,
    input  wire [REGISTER_W-1:0]  register_i,
    output wire [DRAW_W-1:0]      draw_o
);
    `FP3_SETTINGS_FIELDS
    `FP3_MARKS_FIELDS
    `FP3_DRAW_FIELDS
    assign `FP3_SETTINGS = settings_i;
    assign `FP3_MARKS    = marks_i;
    assign draw_o    = `FP3_DRAW;

    reg         opened_q;              // the first batch of a round is still to come
    reg  [31:0] step_q;
    reg  [31:0] object_q, next_q, batch_q;       // now; of the next context; of the batch's first
    reg  [REGISTER_W-1:0] register_q;
    wire [31:0] object = !first_i ? next_q : !begins ? batch_q : opened_q ? setting_first : next_q;
    always @(posedge clk_i) begin
        opened_q <= open_i || (opened_q && !issue_i);
        if (issue_i) begin
            if (first_i) batch_q <= object;
            next_q   <= object + {19'd0, setting_stride};
            object_q <= object;
            if (first_i) step_q <= in_last ? end_i : (begins ? base_i : step_q) + {31'd0, newstep};
            register_q <= register_i;
        end
    end

    // A cycle later
    wire [31:0] mixed, object_late;
    reg         draws_q;
    reg  [31:0] number_q;
    fp3_mix u_mix (.clk_i(clk_i), .number_i(setting_seed ^ step_q ^ ({{32-REGISTER_W{1'b0}}, register_q} << 26)),
        .mixed_o(mixed));
    fp3_delay #(.W(32), .N(TIMING_MIX)) u_object (.clk_i(clk_i), .rst_i(1'b0), .d_i(object_q), .q_o(object_late));
    always @(posedge clk_i) begin
        draws_q  <= |setting_seed;
        number_q <= SLEEP != 0 ? mixed : mixed + object_late;
    end
    assign {draw_draws, draw_number, draw_first, draw_stride} = {draws_q, number_q, SLEEP != 0 ? {setting_first, setting_stride} : 45'd0};
endmodule
`default_nettype wire
`include "config/undefine.vh"
