// SPDX-License-Identifier: Apache-2.0
// fp3_fp_add_swap: the front of fp_add: decodes, compares, and puts the greater operand first.
//
// Purpose   Guarantees big >= little to the stages behind, without infinities and NaNs: such a
//           result is made here, as a big operand to which 0 is added.
// Latency   As many cycles as CUTS has ones.
// Result    With special_o the result is big_o + little_o as it stands: the exponent is e_o, and
//           the bit that is the hidden one elsewhere is the top fraction bit.
//
//     1.5 - 12.0  ->  big 1.1000.., little 1.1000.., n 3, e 130, sign 1, minus 1
`default_nettype none
module fp3_fp_add_swap #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       N         = 5,      // bits of the distance
    parameter       SUBNORMAL = 1,
    parameter       FINITE    = 0,
    parameter [1:0] CUTS      = 0       // after: compare, swap
) (
    input  wire              clk_i,
    input  wire              sub_i,
    input  wire [EXP+FRAC:0] a_i,
    input  wire [EXP+FRAC:0] b_i,
    output wire [FRAC:0]     big_o,     // significands
    output wire [FRAC:0]     little_o,
    output wire [FRAC+1:0]   diff_o,    // big - little with one bit more, right for a distance of 0 or 1
    output wire [N-1:0]      n_o,       // the distance
    output wire              gone_o,    // it is greater than n_o can say
    output wire [EXP-1:0]    e_o,       // exponent of big, 1 if it is subnormal
    output wire              sign_o,    // of the result
    output wire              minus_o,   // big - little, else big + little
    output wire              special_o, // infinity or NaN: see above
    output wire              nought_o,  // unless special, zero: as special, with exponent 0
    output wire              invalid_o
);
    localparam M = EXP + FRAC;          // the magnitude, and the place of the sign

    wire [EXP-1:0] ea = a_i[FRAC +: EXP], eb = b_i[FRAC +: EXP];
    wire a_zero = ea == 0, b_zero = eb == 0, a_ones = FINITE == 0 && &ea, b_ones = FINITE == 0 && &eb;
    wire a_some = |a_i[FRAC-1:0], b_some = |b_i[FRAC-1:0];
    wire differ = a_i[M] ^ b_i[M] ^ sub_i;
    // Equality of the magnitudes is computed for each quarter before the cut, and combined behind
    // it.
    localparam Q = M / 4 + 1;
    wire [4*Q-1:0] unlike = {{4*Q-M{1'b0}}, a_i[M-1:0] ^ b_i[M-1:0]};
    wire [3:0]     same   = {~|unlike[3*Q +: Q], ~|unlike[2*Q +: Q], ~|unlike[Q +: Q], ~|unlike[0 +: Q]};
    wire swap;                          // a sum bit is ready a LUT sooner than a comparison
    wire [M-1:0] unused_difference;
    assign {swap, unused_difference} = {1'b0, a_i[M-1:0]} - {1'b0, b_i[M-1:0]};

    // The distance is the difference of the exponents, but one less when exactly one of them is 0,
    // whose weight is that of 1: x - y - 1 = ~(y - x). Which difference it is, and whether it is
    // inverted, is decided behind the cut.
    wire [EXP-1:0] d_ba = eb - ea;
    wire [EXP-1:0] d_ab;
    wire           less;                // in exponent: known before swap
    assign {less, d_ab} = {1'b0, ea} - {1'b0, eb};
    wire           one = ea[0] ^ eb[0] ^ a_zero ^ b_zero;       // the distance if it is 0 or 1
    wire           gone_a = |d_ab[EXP-1:N];
    wire           gone_b = |d_ba[EXP-1:N];

    wire [M:0]   a0, b0;
    wire [N-1:0] d_ab0, d_ba0;
    wire gone_a0, gone_b0, less0, one0, swap0;
    wire [3:0]   same0;
    wire a_zero0, b_zero0, a_ones0, b_ones0, a_some0, b_some0, differ0;
    fp3_cut #(.W(2*M + 2*N + 18), .ON(CUTS[0])) u_compare (.clk_i(clk_i),
        .d_i({a_i[M], b_i[M] ^ sub_i, a_i[M-1:0], b_i[M-1:0], d_ab[N-1:0], d_ba[N-1:0], gone_a, gone_b, less, one,
              same, swap, a_zero, b_zero, a_ones, b_ones, a_some, b_some, differ}),
        .q_o({a0[M], b0[M], a0[M-1:0], b0[M-1:0], d_ab0, d_ba0, gone_a0, gone_b0, less0, one0,
              same0, swap0, a_zero0, b_zero0, a_ones0, b_ones0, a_some0, b_some0, differ0}));

    wire a_nan   = a_ones0 && a_some0, b_nan = b_ones0 && b_some0;
    wire special = a_ones0 || b_ones0;
    wire clash   = a_ones0 && b_ones0 && differ0;       // inf - inf, or a NaN among them
    wire nan     = a_nan || b_nan || clash;
    wire invalid = (a_nan && !a0[FRAC-1]) || (b_nan && !b0[FRAC-1]) || (clash && !a_some0 && !b_some0);

    wire            odd = a_zero0 ^ b_zero0;
    wire [N-1:0]    n   = (less0 ^ odd ? d_ba0 : d_ab0) ^ {N{odd}};
    wire [M:0]      x = swap0 ? b0 : a0;
    wire [FRAC-1:0] y = swap0 ? a0[FRAC-1:0] : b0[FRAC-1:0];
    wire            x_some = !a_zero0 || !b_zero0;      // the exponent of x is not 0
    wire            y_some = !a_zero0 && !b_zero0;
    wire            nought = (&same0 && differ0) || (SUBNORMAL == 0 && !x_some);
    wire [FRAC:0]   big    = special ? {nan, {FRAC{1'b0}}}
                           : {x_some, x[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || x_some}}};
    wire [FRAC:0]   little = {y_some, y & {FRAC{SUBNORMAL != 0 || y_some}}};

    fp3_cut #(.W(2*FRAC + N + EXP + 8), .ON(CUTS[1])) u_swap (.clk_i(clk_i),
        .d_i({big, little, n, special || (less0 ? gone_b0 : gone_a0),
              x[FRAC+1 +: EXP-1], x[FRAC] || !x_some, x[M] && !nan && !(nought && (FINITE != 0 || differ0)),
              differ0 && !special, special, nought, invalid}),
        .q_o({big_o, little_o, n_o, gone_o, e_o, sign_o, minus_o, special_o, nought_o, invalid_o}));

    // Without a register in front of it the choice is late: both are shifted before it is made, and
    // subtracted if no register is behind it either.
    wire [FRAC:0]   a_little = {y_some, a0[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || y_some}}};
    wire [FRAC:0]   b_little = {y_some, b0[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || y_some}}};
    wire [FRAC+1:0] a_low    = one0 ? {1'b0, a_little} : {a_little, 1'b0};
    wire [FRAC+1:0] b_low    = one0 ? {1'b0, b_little} : {b_little, 1'b0};
    generate
        if (CUTS[1]) begin : g_after
            wire [FRAC+1:0] low = CUTS[0] ? (one0 ? {1'b0, little} : {little, 1'b0}) : swap0 ? a_low : b_low;
            wire [FRAC+1:0] lower;
            fp3_cut #(.W(FRAC + 2), .ON(1)) u_lower (.clk_i(clk_i), .d_i(low), .q_o(lower));
            assign diff_o = {big_o, 1'b0} - lower;
        end else begin : g_before
            wire [FRAC+1:0] a_less_b = {x_some, a0[FRAC-1:0], 1'b0} - b_low;
            wire [FRAC+1:0] b_less_a = {x_some, b0[FRAC-1:0], 1'b0} - a_low;
            assign diff_o = swap0 ? b_less_a : a_less_b;
        end
    endgenerate
endmodule
`default_nettype wire
