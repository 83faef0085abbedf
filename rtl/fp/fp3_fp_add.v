// SPDX-License-Identifier: Apache-2.0
// fp3_fp_add: z = a + b or a - b, IEEE 754 binary.
//
// Purpose   One adder for every format, depth and rounding: correctly rounded, with flags.
//           Two paths share one end: operands far apart need alignment and rounding but
//           hardly normalisation; those at most one place apart the reverse (fp_add_near).
// Latency   As many cycles as CUTS has ones; a new pair every cycle. CUTS = 0 is a function.
//           There is no register at the ports, no reset and no valid bit: a tag travels beside it.
// Result    Signed zeros, infinities, gradual underflow. Every NaN result is the quiet NaN
//           with sign 0 and only the top fraction bit. A tiny sum is exact, so UF stays 0.
// Modes     NEAREST = 0 truncates: overflow gives the largest finite number.
//           SUBNORMAL = 0 reads subnormals as zeros of their sign. An exact sum that is not
//           zero and below the smallest normal number gives a zero of its sign, UF and NX.
//           FINITE = 1, with both of these, is the arithmetic of Cell's SPU: the largest exponent
//           is a number's, overflow gives the largest number, and every zero result is +0.
//
//     fp_add #(.CUTS(7'b001_0010)) u_add (.clk_i(clk_i), .sub_i(sub), .a_i(a), .b_i(b),
//         .z_o(z), .flags_o(flags));              // two cycles later
`default_nettype none
module fp3_fp_add #(
    parameter       EXP       = 8,     // exponent bits, > $clog2(FRAC + 4)
    parameter       FRAC      = 23,    // fraction bits, 2 to 30
    parameter       SUBNORMAL = 1,     // 1: gradual underflow, 0: flush to zero
    parameter       NEAREST   = 1,     // 1: to nearest, ties to even, 0: toward zero
    parameter       FINITE    = 0,     // 1: no infinity and no NaN: see above
    // A register after: 0 compare, 1 swap, 2 align in part, 3 align, 4 add, 5 pick, 6 choose.
    parameter [6:0] CUTS      = 0
) (
    input  wire              clk_i,
    input  wire              sub_i,    // 1: a - b
    input  wire [EXP+FRAC:0] a_i,
    input  wire [EXP+FRAC:0] b_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o   // {NV, DZ, OF, UF, NX}
);
    localparam S = FRAC + 4;           // a sum: carry, hidden bit, fraction, guard, round
    localparam N = $clog2(S);          // bits of a shift amount
    generate
        if (FRAC < 2 || FRAC > 30) begin : g_frac
            FRAC_must_be_2_to_30 u_error ();
        end
        if (EXP <= N) begin : g_exp
            EXP_must_be_more_than_clog2_of_FRAC_plus_4 u_error ();
        end
        if (FINITE != 0 && (SUBNORMAL != 0 || NEAREST != 0)) begin : g_finite
            FINITE_needs_SUBNORMAL_0_and_NEAREST_0 u_error ();
        end
    endgenerate

    wire [FRAC:0]   big1, little1;
    wire [FRAC+1:0] diff1;
    wire [N-1:0]    n1;
    wire [EXP-1:0]  e1;
    wire gone1, sign1, minus1, special1, nought1, invalid1;
    fp3_fp_add_swap #(.EXP(EXP), .FRAC(FRAC), .N(N), .SUBNORMAL(SUBNORMAL), .FINITE(FINITE), .CUTS(CUTS[1:0])) u_swap (
        .clk_i(clk_i), .sub_i(sub_i), .a_i(a_i), .b_i(b_i), .big_o(big1), .little_o(little1),
        .diff_o(diff1), .n_o(n1), .gone_o(gone1), .e_o(e1), .sign_o(sign1), .minus_o(minus1),
        .special_o(special1), .nought_o(nought1), .invalid_o(invalid1));

    wire            close1 = minus1 && !gone1 && ~|n1[N-1:1];
    wire [FRAC-1:0] near_frac5;
    wire [EXP-1:0]  near_e5;
    wire            near_hidden5;
    wire [EXP-1:0]  e3;
    fp3_fp_add_near #(.EXP(EXP), .FRAC(FRAC), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(CUTS[5:2])) u_near (
        .clk_i(clk_i), .diff_i(diff1), .e_i(e1), .e1_i(e3), .close_i(close1),
        .frac_o(near_frac5), .e_o(near_e5), .hidden_o(near_hidden5));

    // Align, by the low bits of the distance first: they are known first.
    wire [S-2:0] low1;
    wire         lost1;
    fp3_shift_right_sticky #(.W(S-1), .N(N-2)) u_align_low (
        .d_i({little1, 2'b00}), .n_i(n1[N-3:0]), .q_o(low1), .sticky_o(lost1));

    wire [FRAC:0]  big2;
    wire [S-2:0]   low2;
    wire [1:0]     n2;
    wire [EXP-1:0] e2;
    wire lost2, gone2, close2, minus2, special2, nought2, sign2, invalid2;
    fp3_cut #(.W(FRAC + S + EXP + 10), .ON(CUTS[2])) u_part (.clk_i(clk_i),
        .d_i({big1, low1, n1[N-1:N-2], e1, lost1, gone1, close1, minus1, special1, nought1, sign1, invalid1}),
        .q_o({big2, low2, n2, e2, lost2, gone2, close2, minus2, special2, nought2, sign2, invalid2}));

    wire         made2 = special2 || nought2;
    wire         zero2 = nought2 && !special2;
    wire [S-2:0] high2;
    wire         more2;
    fp3_shift_right_sticky #(.W(S-1), .N(2), .UNIT(1 << (N-2))) u_align_high (
        .d_i(low2), .n_i(n2), .q_o(high2), .sticky_o(more2));
    wire [S-2:0] other2  = high2 & {S-1{!gone2}} ^ {S-1{minus2}};
    wire         sticky2 = !made2 && (lost2 || more2 || (gone2 && |low2));

    wire [FRAC:0]  big3;
    wire [S-2:0]   other3;
    wire sticky3, close3, minus3, made3, sign3, invalid3;
    fp3_cut #(.W(FRAC + S + EXP + 6), .ON(CUTS[3])) u_align (.clk_i(clk_i),
        .d_i({big2, other2, e2 & {EXP{!zero2}}, sticky2, close2, minus2, made2, sign2, invalid2}),
        .q_o({big3, other3, e3, sticky3, close3, minus3, made3, sign3, invalid3}));

    // Add. The bits shifted out make the true difference slightly smaller than the computed one, by
    // less than one unit in the last place. Rounding to nearest corrects that later; truncation
    // borrows it here.
    wire [S-1:0] sum3;
    wire         unused_carry;
    assign {sum3, unused_carry} = {1'b0, big3, 2'b00, 1'b1}
                                + {minus3, other3, minus3 && (NEAREST != 0 || !sticky3)};

    wire [S-1:0]   sum4;
    wire [EXP-1:0] e4;
    wire sticky4, below4, close4, made4, sign4, invalid4;
    fp3_cut #(.W(S + EXP + 6), .ON(CUTS[4])) u_add (.clk_i(clk_i),
        .d_i({sum3, e3, sticky3, NEAREST != 0 && minus3 && sticky3, close3, made3, sign3, invalid3}),
        .q_o({sum4, e4, sticky4, below4, close4, made4, sign4, invalid4}));

    fp3_fp_add_round #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE),
                   .CUTS(CUTS[6:5])) u_round (
        .clk_i(clk_i), .sum_i(sum4), .sticky_i(sticky4), .below_i(below4), .e_i(e4),
        .close_i(close4), .made_i(made4), .sign_i(sign4), .invalid_i(invalid4),
        .near_frac_i(near_frac5), .near_e_i(near_e5), .near_hidden_i(near_hidden5),
        .z_o(z_o), .flags_o(flags_o));
endmodule
`default_nettype wire
