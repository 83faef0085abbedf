// SPDX-License-Identifier: Apache-2.0
// fp3_fp_fma_round: rounds and packs the normalised sum of fp_fma.
//
// Purpose   The one rounding of a fused multiply-add, with all flags. A negative sum -v comes as
//           the bits of its two's complement: v is the inverted significand, and one more, less
//           what follows. So one increment negates and rounds.
// Latency   As many cycles as CUTS has ones: behind the increment.
//
//     d_i 1.10..01 10, e_i 128, n_i 2  ->  1.10..10, exponent 127      (a tie goes to even)
`default_nettype none
module fp3_fp_fma_round #(
    parameter EXP       = 8,
    parameter FRAC      = 23,
    parameter SUBNORMAL = 1,
    parameter NEAREST   = 1,
    parameter PLACE     = 10,
    parameter CUTS      = 0
) (
    input  wire              clk_i,
    input  wire [FRAC+2:0]   d_i,      // hidden bit, fraction, two bits more
    input  wire              more_i,   // the OR of the bits below
    input  wire              negative_i,
    input  wire [PLACE-1:0]  e_i,      // e_i + 1 - n_i is the exponent
    input  wire [3:0]        n_i,
    input  wire              minus_i,  // a difference: 0 of it is +0
    input  wire              sign_i,   // of the result, once it is not negative
    input  wire              inf_i,    // infinity, whatever the sum is
    input  wire              nan_i,    // or NaN
    input  wire              invalid_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o
);
    localparam P = FRAC + 1;
    wire [P-1:0] t = d_i[P+1:2] ^ {P{negative_i}};
    wire g = d_i[1], r = d_i[0];
    wire exact  = !g && !r && !more_i;
    wire tie    = g && !r && !more_i;
    wire up     = NEAREST == 0 ? negative_i && exact
                : negative_i ? !g || (tie && t[0]) : g && (t[0] || !tie);
    wire ones   = &t[FRAC-1:0];
    wire hidden = t[P-1];
    wire zero   = !negative_i && exact && d_i[P+1:2] == 0;

    // Tiny: it stays below the smallest normal number if it is rounded as if exponents had no
    // bound, or before it is rounded if such numbers are flushed.
    wire tiny   = !hidden && !(NEAREST != 0 && SUBNORMAL != 0 ? ones && (negative_i ? !g && !(r && more_i) : g && r)
                                                              : negative_i && ones && exact);
    wire flush  = SUBNORMAL == 0 && tiny && !zero;
    wire usual  = !inf_i && !nan_i;

    // Exponent and fraction are one number: a carry out of the fraction counts into the exponent.
    // Without the hidden bit the field is 0, not 1.
    wire [4:0] add = {4'd0, hidden} - {1'b0, n_i};
    wire [PLACE+FRAC-1:0] rounded = {e_i, t[FRAC-1:0]} + {{PLACE-5{add[4]}}, add, {FRAC-1{1'b0}}, up};

    wire [PLACE+FRAC-1:0] w;
    wire usual_1, inf_1, nan_1, zero_1, flush_1, minus_1, sign_1, invalid_1, tiny_1, inexact_1;
    fp3_cut #(.W(PLACE+FRAC+10), .ON(CUTS)) u_round (.clk_i(clk_i),
        .d_i({rounded, usual, inf_i, nan_i, zero, flush, minus_i, sign_i && !nan_i, invalid_i,
              tiny && (!exact || flush), !exact || flush}),
        .q_o({w, usual_1, inf_1, nan_1, zero_1, flush_1, minus_1, sign_1, invalid_1, tiny_1, inexact_1}));
    wire clear = zero_1 || flush_1;
    wire over = usual_1 && !clear && (|w[PLACE+FRAC-1:EXP+FRAC] || &w[EXP+FRAC-1:FRAC]);
    wire top  = nan_1 || inf_1 || over;
    wire most = over && NEAREST == 0;                      // the largest finite number
    wire own  = !top && !clear;
    assign z_o = {sign_1 && !(zero_1 && minus_1 && usual_1), {EXP-1{top}} | (w[FRAC+1 +: EXP-1] & {EXP-1{own}}), (top && !most) || (w[FRAC] && own),
                  nan_1 || most || (w[FRAC-1] && own), {FRAC-1{most}} | (w[FRAC-2:0] & {FRAC-1{own}})};
    assign flags_o = {invalid_1, 1'b0, over, usual_1 && tiny_1, usual_1 && (inexact_1 || over)};
endmodule
`default_nettype wire
