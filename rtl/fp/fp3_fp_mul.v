// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul: floating-point multiplier, IEEE 754, subnormals and flags included.
//
// Purpose   z = a * b in a binary format with EXP >= 3, FRAC from 2 to 30 (SW bits hold the shift);
//           default binary32, round to nearest even, gradual underflow, tininess after rounding,
//           every NaN result 7FC00000. A device's own fp_mul_product may have a narrower range, and
//           refuses the rest (rtl/fpga/).
// Latency   popcount(CUTS) cycles, one operation per cycle; CUTS = 0 is a function of a_i, b_i.
//           There is no reset, enable or valid bit: a tag travels beside it.
//           Places: 0 operands classified, 1 partial products, 2 first sums, 3 product,
//           4 shifted by sixteens and fours, 5 by ones, 6 rounded.
// Flags     {NV, DZ, OF, UF, NX}. NV: a signalling NaN, or zero times infinity.
// Options   SUBNORMAL = 0: a subnormal operand is a zero of its sign; a nonzero product whose
//           exact value lies below the least normal number (tiny before rounding) becomes a
//           zero of its sign with UF and NX. NEAREST = 0: truncate; overflow then gives the
//           largest finite number with OF and NX. FINITE = 1, with both of these, is the arithmetic
//           of Cell's SPU: the largest exponent is a number's, overflow gives the largest number,
//           and every zero result is +0.
//
//     fp_mul #(.CUTS(7'b0101000)) u (.clk_i(clk), .a_i(x), .b_i(y), .z_o(z), .flags_o(f));
//     // two edges later z = x * y: 3F800001 * 40000000 = 40000001, f = 0
`default_nettype none
`include "fp/place.vh"
module fp3_fp_mul #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       SUBNORMAL = 1,
    parameter       NEAREST   = 1,
    parameter       FINITE    = 0,
    parameter [6:0] CUTS      = 0
) (
    input  wire                clk_i,
    input  wire [EXP+FRAC:0]   a_i, b_i,
    output wire [EXP+FRAC:0]   z_o,
    output wire [4:0]          flags_o
);
    localparam SW = 6;                 // shift amount: less than 2*FRAC + 3
    generate
        if (FRAC < 2 || FRAC > 30) begin : g_frac
            FRAC_must_be_2_to_30 u_error ();
        end
        if (EXP < 3) begin : g_exp
            EXP_must_be_at_least_3 u_error ();
        end
        if (FINITE != 0 && (SUBNORMAL != 0 || NEAREST != 0)) begin : g_finite
            FINITE_needs_SUBNORMAL_0_and_NEAREST_0 u_error ();
        end
    endgenerate

    // Operands.
    wire [EXP-1:0]  ae = a_i[EXP+FRAC-1:FRAC], be = b_i[EXP+FRAC-1:FRAC];
    wire [FRAC-1:0] af = a_i[FRAC-1:0], bf = b_i[FRAC-1:0];
    wire a_normal = |ae, b_normal = |be;
    wire a_empty = ~|af, b_empty = ~|bf;
    wire [2*FRAC+1:0] p;
    fp3_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS[3:0])) u_product (
        .clk_i(clk_i), .a_i({a_normal, af}), .b_i({b_normal, bf}), .p_o(p));

    // At most one operand has leading zeros that count. Before a cut there is time to select it;
    // otherwise fp_mul_scale counts in both operands and selects last.
    wire [FRAC-1:0] either = a_normal ? bf : af;
    wire [EXP-1:0]  ae_0, be_0;
    wire [FRAC-1:0] af_0, bf_0;
    wire a_normal_0, b_normal_0, a_empty_0, b_empty_0, a_top_0, b_top_0, a_quiet_0, b_quiet_0, sign_0;
    fp3_cut #(.W(2*EXP+2*FRAC+9), .ON(CUTS[0])) u_0 (.clk_i(clk_i),
        .d_i({ae, be, CUTS[0] ? {either, either} : {af, bf}, a_normal, b_normal, a_empty, b_empty,
              FINITE == 0 && &ae, FINITE == 0 && &be, af[FRAC-1], bf[FRAC-1], a_i[EXP+FRAC] ^ b_i[EXP+FRAC]}),
        .q_o({ae_0, be_0, af_0, bf_0, a_normal_0, b_normal_0, a_empty_0, b_empty_0,
              a_top_0, b_top_0, a_quiet_0, b_quiet_0, sign_0}));

    // Class of the result.
    wire a_zero = !a_normal_0 && (a_empty_0 || SUBNORMAL == 0);
    wire b_zero = !b_normal_0 && (b_empty_0 || SUBNORMAL == 0);
    wire a_nan = a_top_0 && !a_empty_0, b_nan = b_top_0 && !b_empty_0;
    wire nv = (a_nan && !a_quiet_0) || (b_nan && !b_quiet_0)
           || (a_top_0 && b_zero && a_empty_0) || (b_top_0 && a_zero && b_empty_0);
    wire infinite = a_top_0 || b_top_0;
    wire zero = a_zero || b_zero;

    // Beside the product: how far to shift it, its exponent, its class.
    wire [SW-1:0] shift_2;
    wire [`FP3_PLACE_W-1:0] place_2, place_3, place_4, place_5;
    fp3_fp_mul_scale #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .FINITE(FINITE), .SW(SW), .CUTS(CUTS[2:1]))
        u_scale (.clk_i(clk_i), .ae_i(ae_0), .be_i(be_0), .af_i(af_0), .bf_i(bf_0),
                 .a_normal_i(a_normal_0), .b_normal_i(b_normal_0),
                 .shift_o(shift_2), .place_o(place_2));
    wire nv_1, quiet_1, inf_1, zero_1, sign_1;
    fp3_cut #(.W(5), .ON(CUTS[1])) u_1 (.clk_i(clk_i),
        .d_i({nv, a_nan || b_nan, infinite, zero, sign_0}), .q_o({nv_1, quiet_1, inf_1, zero_1, sign_1}));
    wire nan = nv_1 || quiet_1;
    wire [4:0] class_2, class_3, class_4, class_5;
    fp3_cut #(.W(5), .ON(CUTS[2])) u_2 (.clk_i(clk_i),
        .d_i({nv_1, nan, inf_1 && !nan, zero_1 && !nan, sign_1 && !nan}), .q_o(class_2));

    // abc9 believes that multipliers take no time, and would hurry the shift instead of the
    // product; keep makes it see both as early.
    (* keep *) wire [SW-1:0] shift_3;
    fp3_cut #(.W(SW+`FP3_PLACE_W+5), .ON(CUTS[3])) u_3 (.clk_i(clk_i),
        .d_i({shift_2, place_2, class_2}), .q_o({shift_3, place_3, class_3}));

    // Shift by sixteens, fours and ones; what falls off below is sticky.
    wire [2*FRAC+18:0] wide = {16'd0, p, 1'b0};
    localparam W16 = FRAC + 18, W4 = FRAC + 6, W1 = FRAC + 3;
    wire [W16+47:0] from = {{47-FRAC{1'b0}}, wide};
    wire [W16-1:0]  sixteens;
    wire [W4-1:0]   fours, fours_4;
    fp3_mux4 #(.W(W16)) u_sixteens (.n_i(shift_3[5:4]), .q_o(sixteens),
        .d0_i(from[0 +: W16]), .d1_i(from[16 +: W16]), .d2_i(from[32 +: W16]), .d3_i(from[48 +: W16]));
    fp3_mux4 #(.W(W4)) u_fours (.n_i(shift_3[3:2]), .q_o(fours),
        .d0_i(sixteens[0 +: W4]), .d1_i(sixteens[4 +: W4]), .d2_i(sixteens[8 +: W4]), .d3_i(sixteens[12 +: W4]));
    // Four bits are lost if the shift goes beyond them; computed beside the shift, not after it.
    localparam FOURS = (2*FRAC + 6) / 4;
    localparam LOST  = (FOURS + 3) / 4;                  // fours of these
    wire [4*LOST-1:0] gone;
    wire [LOST-1:0] lost, losts_4;
    genvar i;
    generate
        for (i = 0; i < 4*LOST; i = i + 1) begin : g_four
            if (i < FOURS) begin : g_some
                assign gone[i] = |wide[4*i +: 4] && {{34-SW{1'b0}}, shift_3[SW-1:2]} > i;
            end else begin : g_none
                assign gone[i] = 1'b0;
            end
        end
        for (i = 0; i < LOST; i = i + 1) begin : g_lost
            assign lost[i] = |gone[4*i +: 4];
        end
    endgenerate
    wire [1:0] by_1;
    fp3_cut #(.W(W4+LOST+2+`FP3_PLACE_W+5), .ON(CUTS[4])) u_4 (.clk_i(clk_i),
        .d_i({fours, lost, shift_3[1:0], place_3, class_3}), .q_o({fours_4, losts_4, by_1, place_4, class_4}));

    wire [W1-1:0]   fine, t;
    wire            lost_4 = |losts_4;
    wire            stick = lost_4 || |(fours_4[2:0] & ~(3'd7 << by_1));
    fp3_mux4 #(.W(W1)) u_ones (.n_i(by_1), .q_o(fine),
        .d0_i(fours_4[0 +: W1]), .d1_i(fours_4[1 +: W1]), .d2_i(fours_4[2 +: W1]), .d3_i(fours_4[3 +: W1]));
    // With CUTS[5] one adder rounds, and its operand is selected before that register (lower).
    // Without it two adders work side by side, and the top bit selects one of their sums.
    localparam [0:0] ONE = CUTS[5];
    wire            lower, st;
    fp3_cut #(.W(W1+2+`FP3_PLACE_W+5), .ON(CUTS[5])) u_5 (.clk_i(clk_i),
        .d_i({fine, stick, ONE && !fine[FRAC+2] && !place_4[`FP3_PLACE_LOW], place_4, class_4}),
        .q_o({t, st, lower, place_5, class_5}));
    `FP3_PLACE_FIELDS
    assign `FP3_PLACE = place_5;
    wire            nv_5, nan_5, inf_5, zero_5, sign_5;
    assign {nv_5, nan_5, inf_5, zero_5, sign_5} = class_5;

    // Both places of the leading one are rounded, by half a unit, and the top bit of t chooses
    // beside the adders; with ONE, lower chooses in front of one adder. A tie then clears the last
    // bit. Exponent and fraction are one number, so a carry out of the fraction needs no care, up
    // to infinity itself.
    wire top   = t[FRAC+2];
    localparam [0:0] HALF = NEAREST != 0;
    wire [EXP+FRAC:0] hi = {place_field, lower ? t[FRAC:0] : t[FRAC+1:1]} + {{EXP-1{1'b0}}, top, {FRAC{1'b0}}, HALF};
    wire [EXP+FRAC:0] lo = ONE ? hi : {place_field, t[FRAC:0]} + {{EXP+FRAC{1'b0}}, HALF};
    wire hi_lo_unused = &{hi[0], lo[0]};
    wire lo_tie  = HALF && t[0] && !st;
    wire hi_tie  = lower ? lo_tie : HALF && t[1:0] == 2'b10 && !st;
    wire hi_odd  = hi[1] && !hi_tie;
    wire lo_odd  = ONE ? hi_odd : lo[1] && !lo_tie;

    // The source of each bit of the result, in two bits (fp_mul_pack): 0, 1, lo, hi. The top bit of
    // t is late, so it is the first index, and both answers wait for it.
    localparam [1:0] ALL_0 = 2'd0, ALL_1 = 2'd1;
    wire       usual = !nan_5 && !inf_5 && !zero_5;
    wire [1:0] right  = {1'b1, place_low};
    wire [1:0] tiny   = {place_gone, place_gone || place_low};
    wire [1:0] flush  = tiny & {2{SUBNORMAL == 0}};
    wire [1:0] beyond = {place_over || place_by1, place_over} & {2{usual && !place_gone}};
    wire [1:0] brink  = {place_by2, place_by1 && !place_low} & {2{HALF && usual && !place_gone}};     // beyond if it carries
    wire [11:0] early [0:1];
    generate
        for (i = 0; i < 2; i = i + 1) begin : g_top
            wire [1:0] rounded  = {1'b1, right[i]};
            wire [1:0] exponent = nan_5 || inf_5 || beyond[i] ? ALL_1 : zero_5 || flush[i] ? ALL_0 : rounded;
            wire [1:0] lowest   = beyond[i] && !HALF && FINITE == 0 ? ALL_0 : exponent;     // truncated: the largest finite number
            wire [1:0] rest     = !usual || flush[i] || (beyond[i] && HALF) ? ALL_0 : beyond[i] ? ALL_1 : rounded;
            wire [1:0] of       = beyond[i] ? ALL_1 : brink[i] ? rounded : ALL_0;
            assign early[i] = {exponent, lowest, nan_5 ? ALL_1 : rest, rest, of,
                               usual && tiny[i], usual && (flush[i] || beyond[i])};
        end
    endgenerate
    wire [1:0] exponent_5, lowest_5, top_5, rest_5, of_5;
    wire       tiny_5, lossy_5;                       // lossy: inexact whatever t is
    assign {exponent_5, lowest_5, top_5, rest_5, of_5, tiny_5, lossy_5} = top ? early[1] : early[0];
    wire       some_5 = usual && (t[0] || st || (t[1] && (top || place_low)));
    wire       near   = HALF && SUBNORMAL != 0 && t[0];        // rounds to normal with a finer last place
    wire [1:0] nx_5   = some_5 || lossy_5 ? ALL_1 : of_5;
    wire [1:0] uf_5   = !tiny_5 || !(some_5 || lossy_5) ? ALL_0 : near ? {1'b1, top || place_low} : ALL_1;    // not of lo or hi

    wire [EXP+FRAC-1:0] hi_6, lo_6;
    wire [1:0] exponent_6, lowest_6, top_6, rest_6, of_6, uf_6, nx_6;
    wire nv_6, sign_6;
    fp3_cut #(.W(2*EXP+2*FRAC+16), .ON(CUTS[6])) u_6 (.clk_i(clk_i),
        .d_i({hi[EXP+FRAC:2], hi_odd, lo[EXP+FRAC:2], lo_odd, exponent_5, lowest_5, top_5, rest_5, of_5, uf_5, nx_5,
              nv_5, sign_5 && !(FINITE != 0 && exponent_5 == ALL_0)}),
        .q_o({hi_6, lo_6, exponent_6, lowest_6, top_6, rest_6, of_6, uf_6, nx_6, nv_6, sign_6}));

    wire of, uf, nx;
    fp3_fp_mul_pack #(.W(EXP+FRAC+3), .INVERT(2)) u_pack (
        .which_i({{EXP-1{exponent_6}}, lowest_6, top_6, {FRAC-1{rest_6}}, of_6, uf_6, nx_6}),
        .hi_i({hi_6, {3{hi_6[FRAC]}}}), .lo_i({lo_6, {3{lo_6[FRAC]}}}),
        .z_o({z_o[EXP+FRAC-1:0], of, uf, nx}));
    assign z_o[EXP+FRAC] = sign_6;
    assign flags_o = {nv_6, 1'b0, of, uf, nx};
endmodule
`default_nettype wire
`include "config/undefine.vh"
