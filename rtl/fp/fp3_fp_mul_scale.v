// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_scale: the shift of fp_mul's product, and the exponent of the result.
//
// Purpose   {product, 0} >> shift_o puts the leading one of a normal product at the top of FRAC + 3
//           bits or just below it. A subnormal operand, its leading one at bit n, shifts by n
//           instead of FRAC; a small exponent asks for more: room. So n - room is the exponent of
//           the product counted as 1 to 1.99..; with zero or less the result is subnormal unless
//           the top bit is set, and the shift is room. Two subnormals underflow whatever n is. For
//           an operand that is zero, infinite or NaN, shift and exponent are meaningless: fp_mul
//           then takes its result from the operand's class.
// Latency   popcount(CUTS), beside fp_mul_product: bit 0 is place 1 of fp_mul, bit 1 place 2.
//
//     fp_mul_scale u (..., .shift_o(shift), .place_o(place));
//     // place: the bundle PLACE
`default_nettype none
`include "fp/place.vh"
module fp3_fp_mul_scale #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       SUBNORMAL = 1,
    parameter       FINITE    = 0,
    parameter       SW        = 6,     // width of the shift
    parameter [1:0] CUTS      = 0
) (
    input  wire            clk_i,
    input  wire [EXP-1:0]  ae_i, be_i,
    input  wire [FRAC-1:0] af_i, bf_i,
    input  wire            a_normal_i, b_normal_i,
    output wire [SW-1:0]   shift_o,
    output wire [`FP3_PLACE_W-1:0] place_o
);
    localparam XW  = (EXP > SW ? EXP : SW) + 2;     // signed exponent
    localparam BIAS = (1 << (EXP - 1)) - 1;
    localparam TOP = (1 << EXP) - (FINITE == 0 ? 1 : 0);      // the first exponent that is too large: that of an infinity
    localparam MID = FRAC + BIAS;

    function [SW-1:0] leading;            // index of the leading one, four bits at a time
        input [FRAC-1:0] x;
        reg   [FRAC+2:0] y;
        reg   [SW-3:0]   g;
        begin
            y    = {3'b000, x};
            leading = 0;
            for (g = 0; 4*g < FRAC; g = g + 1)
                if (|y[4*g +: 4])
                    leading = {g, y[4*g+3] || y[4*g+2], y[4*g+3] || (!y[4*g+2] && y[4*g+1])};
        end
    endfunction

    // Both n are computed before the choice between them is known. A zero exponent counts as 1.
    wire both = a_normal_i && b_normal_i;
    wire [SW-1:0] n = SUBNORMAL == 0 || both ? FRAC[SW-1:0] : a_normal_i ? leading(bf_i) : leading(af_i);
    wire [XW-1:0] a = {{XW-EXP{1'b0}}, ae_i[EXP-1:1], ae_i[0] || !a_normal_i};
    wire [XW-1:0] b = {{XW-EXP{1'b0}}, be_i[EXP-1:1], be_i[0] || !b_normal_i};
    // a + b - MID: the three bits of a place become two, so that one carry goes through, not two.
    localparam integer LESS = -MID;
    localparam [XW-1:0] K = LESS[XW-1:0];
    wire [XW-1:0] carry = (a & b) | (K & (a | b));
    wire [XW-1:0] sum   = (a ^ b ^ K) + {carry[XW-2:0], 1'b0};
    wire unused_carry = carry[XW-1];
    wire [SW-1:0] n_1;
    wire [XW-1:0] sum_1;
    fp3_cut #(.W(SW+XW), .ON(CUTS[0])) u_1 (.clk_i(clk_i), .d_i({n, sum}), .q_o({n_1, sum_1}));

    // n - room, but not by way of room. Which of both is the shift, the exponent's sign says: asked
    // behind the cut, where the product is not there yet.
    wire [XW-1:0] exponent = sum_1 + {{XW-SW{1'b0}}, n_1};
    wire [XW-1:0] room     = -sum_1;
    wire          beyond   = |room[XW-1:SW];    // then all ones: only sticky bits are left

    wire [XW-1:0] exponent_2;
    wire [SW-1:0] n_2, room_2;
    wire          beyond_2;
    fp3_cut #(.W(2*SW+1+XW), .ON(CUTS[1])) u_2 (.clk_i(clk_i),
        .d_i({n_1, room[SW-1:0], beyond, exponent}), .q_o({n_2, room_2, beyond_2, exponent_2}));
    wire           under_2 = exponent_2[XW-1];
    assign shift_o = SUBNORMAL == 0 ? FRAC[SW-1:0] : under_2 ? room_2 | {SW{beyond_2}} : n_2;

    // The exponent is evaluated there, so no logic waits for it.
    `FP3_PLACE_FIELDS
    assign place_field = exponent_2[EXP-1:0] & {EXP{!under_2}};
    assign place_low   = under_2 || exponent_2 == 0;
    assign place_over  = !under_2 && exponent_2 >= TOP[XW-1:0];
    assign place_by1   = exponent_2 == TOP[XW-1:0] - 1;
    assign place_by2   = exponent_2 == TOP[XW-1:0] - 2;
    assign place_gone  = SUBNORMAL == 0 && under_2;
    assign place_o     = `FP3_PLACE;
endmodule
`default_nettype wire
`include "config/undefine.vh"
