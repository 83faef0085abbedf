// SPDX-License-Identifier: Apache-2.0
// fp3_fp_add_near: the path of fp_add for differences that lose leading bits.
//
// Purpose   Operands at most one place apart may cancel; their difference is exact, so it
//           needs a long move left but neither alignment nor rounding.
// Latency   As many cycles as CUTS has ones.
// Result    With close_i, right for a difference below its big operand's leading bit, not zero, and
//           e_i > 1; fp_add_round picks it only then. Without close_i it is the overflow value.
//
//     result = {sign, e_o, frac_o}; hidden_o = 0: it is subnormal
`default_nettype none
module fp3_fp_add_near #(
    parameter       EXP     = 8,
    parameter       FRAC    = 23,
    parameter       NEAREST = 1,
    parameter       FINITE   = 0,
    parameter [3:0] CUTS    = 0        // after: subtract, count, move by much, move by little
) (
    input  wire            clk_i,
    input  wire [FRAC+1:0] diff_i,     // hidden bit, fraction, guard
    input  wire [EXP-1:0]  e_i,        // exponent field of the big operand
    input  wire [EXP-1:0]  e1_i,       // e_i two cuts later, or 0 where the result is zero; it counts with close_i only
    input  wire            close_i,
    output wire [FRAC-1:0] frac_o,
    output wire [EXP-1:0]  e_o,
    output wire            hidden_o
);
    localparam D = FRAC + 2;
    localparam N = $clog2(D);
    localparam [N-1:0] MUCH = {N{1'b1}} << (N - 2);

    // The difference may move left by e_i - 1 places: a marker stops the count there.
    reg  [D-1:0] marker;
    integer      i;
    always @*
        for (i = 0; i < D; i = i + 1) marker[i] = {{32-EXP{1'b0}}, e_i} == D - i;

    wire [D-1:0]   diff0, counted;
    wire           close0;
    fp3_cut #(.W(2*D + 1), .ON(CUTS[0])) u_subtract (.clk_i(clk_i),
        .d_i({diff_i, diff_i | marker, close_i}), .q_o({diff0, counted, close0}));

    wire [N-1:0]   left;
    wire           unused_zero;
    fp3_lzc #(.N(N)) u_lzc (.d_i({counted, {(1<<N)-D{1'b0}}}), .n_o(left), .zero_o(unused_zero));

    wire [D-1:0]   diff1;
    wire [N-1:0]   left1;
    wire           close1;
    fp3_cut #(.W(D + N + 1), .ON(CUTS[1])) u_count (.clk_i(clk_i),
        .d_i({diff0, left, close0}), .q_o({diff1, left1, close1}));

    wire [D-1:0]   diff2;
    wire [N-1:0]   left2;
    wire [EXP-1:0] e2;
    wire           close2;
    fp3_cut #(.W(D + N + EXP + 1), .ON(CUTS[2])) u_much (.clk_i(clk_i),
        .d_i({diff1 << (left1 & MUCH), left1 & ~MUCH, e1_i - {{EXP-N{1'b0}}, left1}, close1}),
        .q_o({diff2, left2, e2, close2}));

    // Stopped by the marker, the exponent is 1 and the field 0.
    wire [D-1:0]   normal = diff2 << left2;
    wire           unused_guard = normal[0];
    wire           hidden = close2 && normal[D-1];
    wire [FRAC-1:0] frac  = close2 ? normal[1 +: FRAC] : {FRAC{NEAREST == 0}};
    wire [EXP-1:0]  e     = close2 ? {e2[EXP-1:1], e2[0] && hidden} : {{EXP-1{1'b1}}, NEAREST != 0 || FINITE != 0};
    fp3_cut #(.W(FRAC + EXP + 1), .ON(CUTS[3])) u_little (.clk_i(clk_i),
        .d_i({frac, e, hidden}), .q_o({frac_o, e_o, hidden_o}));
endmodule
`default_nettype wire
