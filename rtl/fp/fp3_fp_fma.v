// SPDX-License-Identifier: Apache-2.0
// fp3_fp_fma: fused multiply-add, z + x * y or z - x * y, rounded once, IEEE 754 binary.
//
// Purpose   The exact product and z are added in one window, wide enough that bits below it are
//           only sticky:
//
//               carry | z at most so far left | product             | two bits more
//                 1         FRAC + 3             2 * FRAC + 2          2
//
//           z starts at the left end and is shifted right. If the product is so small that z would
//           be beyond the left end, z is not shifted: the product is then only sticky. So the
//           exponent of the left end is never below that of z, and a subnormal result needs no
//           right shift. The sum may be negative: it is normalised as it is, and negated where it
//           is rounded.
// Latency   x and y: popcount(CUTS) + WAIT cycles, one operation per cycle. z_i and subtract_i come
//           as much later as the product takes: popcount(CUTS[3:0]) + WAIT cycles. With Z_EARLY
//           they come with x and y: z is shifted by ones and fours beside the multiplication, and
//           only by sixteens behind it. CUTS = 0, WAIT = 0 is a function. Places: 0 operands, 1
//           partial products, 2 first sums, 3 product, 4 distance, 5 z shifted, 6 added, 7 zeros in
//           front counted by sixteens, 8 shifted by them, 9 normalised, 10 rounded.
// Result    As of fp_add and fp_mul: every NaN result is the quiet NaN with sign 0 and only the top
//           fraction bit; infinity times zero is invalid also if z is a NaN; tininess after
//           rounding.
// Modes     NEAREST = 0 truncates: overflow gives the largest finite number.
//           SUBNORMAL = 0 reads subnormals as zeros of their sign. An exact result that is not
//           zero and below the smallest normal number gives a zero of its sign, UF and NX.
//
//     fp_fma #(.CUTS(11'h7ff)) u_fma (.clk_i(clk_i), .x_i(x), .y_i(y), .no_product_i(1'b0),
//     .subtract_i(subtract), .z_i(z_4),
//         .z_o(result), .flags_o(flags));      // z_4 four cycles after x and y, the result eleven
`default_nettype none
module fp3_fp_fma #(
    parameter        EXP       = 8,     // exponent bits, at least 3
    parameter        FRAC      = 23,    // fraction bits, 2 to 30
    parameter        SUBNORMAL = 1,     // 1: gradual underflow, 0: flush to zero
    parameter        NEAREST   = 1,     // 1: to nearest, ties to even, 0: toward zero
    parameter [10:0] CUTS      = 0,
    parameter        WAIT      = 0,     // more registers behind the product
    parameter        Z_EARLY   = 0      // 1: no_product_i has no effect
) (
    input  wire              clk_i,
    input  wire [EXP+FRAC:0] x_i, y_i,
    input  wire              no_product_i, // -0 for the product; comes a cycle before z_i, with WAIT = 0 beside it
    input  wire              subtract_i,   // 1: z - x * y
    input  wire [EXP+FRAC:0] z_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o       // {NV, DZ, OF, UF, NX}
);
    localparam P = FRAC + 1;
    localparam W = 3 * P + 5;              // the window
    localparam PLACE = EXP > 8 ? EXP + 2 : 10;   // bits of an exponent, signed
    generate
        if (FRAC < 2 || FRAC > 30) begin : g_frac
            FRAC_must_be_2_to_30 u_error ();
        end
        if (EXP < 3) begin : g_exp
            EXP_must_be_at_least_3 u_error ();
        end
    endgenerate

    // The product, and the registers behind it. The last register may take another product.
    wire [2*P-1:0]   p, p_3;
    wire [PLACE-1:0] place, place_3, distance_early;
    wire [PLACE-1:0] e_z = {{PLACE-EXP{1'b0}}, z_i[FRAC +: EXP]};
    wire [4:0]       kind, kind_3;
    fp3_fp_fma_product #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .PLACE(PLACE), .AHEAD(Z_EARLY),
        .CUTS(CUTS[3:0])) u_product (.clk_i(clk_i),
        .x_i(x_i), .y_i(y_i), .e_z_i(e_z), .p_o(p), .place_o(place), .distance_o(distance_early), .sign_o(kind[4]),
        .zero_o(kind[3]), .inf_o(kind[2]),
        .nan_o(kind[1]), .invalid_o(kind[0]));
    localparam [4:0] MINUS_ZERO = 5'b11000;
    generate
        if (Z_EARLY != 0) begin : g_early
            wire unused = &{no_product_i};
            fp3_delay #(.W(2*P), .N(WAIT)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(p), .q_o(p_3));
            assign {place_3, kind_3} = {place, kind};
        end else if (WAIT == 0) begin : g_at_once
            assign p_3     = p & {2*P{!no_product_i}};
            assign place_3 = place;
            assign kind_3 = no_product_i ? MINUS_ZERO : kind;
        end else begin : g_wait
            wire [2*P-1:0]   p_late;
            wire [PLACE-1:0] place_late;
            wire [4:0]       kind_late;
            fp3_delay #(.W(2*P+PLACE+5), .N(WAIT-1)) u_late (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({p, place, kind}), .q_o({p_late, place_late, kind_late}));
            reg [2*P-1:0]   p_q;
            reg [PLACE-1:0] place_q;
            reg [4:0]       kind_q;
            always @(posedge clk_i) begin
                place_q <= place_late;
                if (no_product_i) {p_q, kind_q} <= {{2*P{1'b0}}, MINUS_ZERO};
                else              {p_q, kind_q} <= {p_late, kind_late};
            end
            assign {p_3, place_3, kind_3} = {p_q, place_q, kind_q};
        end
    endgenerate
    wire px_sign, px_zero, px_inf, px_nan, px_invalid;
    assign {px_sign, px_zero, px_inf, px_nan, px_invalid} = kind_3;

    // z, and how far it is from the left end.
    wire [EXP-1:0] ez = z_i[FRAC +: EXP];
    wire z_normal = |ez, z_top = &ez;
    wire [FRAC-1:0] fz = z_i[FRAC-1:0] & {FRAC{SUBNORMAL != 0 || z_normal}};
    wire z_some = |fz;
    wire z_nan  = z_top && z_some, z_inf = z_top && !z_some, z_sign = z_i[EXP+FRAC];
    wire minus  = z_sign ^ px_sign ^ subtract_i;
    wire clash  = z_inf && px_inf && !px_nan && minus;
    wire nan    = z_nan || px_nan || clash;
    wire invalid = px_invalid || (z_nan && !fz[FRAC-1]) || clash;
    wire infinite = (z_inf || px_inf) && !nan;

    // A subnormal z counts as twice as large with exponent 0, so the distance needs no comparison.
    wire [P-1:0]     sig      = z_normal ? {1'b1, fz} : {fz, 1'b0};
    wire [PLACE-1:0] distance = Z_EARLY != 0 ? distance_early : place_3 - e_z;
    wire             stays    = px_zero || distance[PLACE-1];
    wire             beyond   = |distance[PLACE-2:7];
    wire [6:0]       n        = (distance[6:0] | {7{beyond}}) & {7{!stays}};

    wire [P-1:0]     sig_4;
    wire [2*P-1:0]   p_4;
    wire [6:0]       n_4;
    wire [PLACE-1:0] e_4;
    wire [5:0]       what_4, what_5, what_6, what_7, what_8, what_9;   // minus, signs of z and of infinity, kind
    fp3_cut #(.W(3*P+PLACE+13), .ON(CUTS[4])) u_4 (.clk_i(clk_i),
        .d_i({sig, p_3, n, stays ? e_z : place_3, minus, z_sign, z_inf ? z_sign : px_sign ^ subtract_i, infinite, nan, invalid}),
        .q_o({sig_4, p_4, n_4, e_4, what_4}));

    // With Z_EARLY everything else waits here for the product.
    localparam BESIDE = Z_EARLY == 0 ? 0 : WAIT + {31'd0, CUTS[0]} + {31'd0, CUTS[1]} + {31'd0, CUTS[2]} + {31'd0, CUTS[3]};
    wire [PLACE-1:0] e_late;
    wire [5:0]       what_late;
    fp3_delay #(.W(PLACE+6), .N(BESIDE)) u_beside (.clk_i(clk_i), .rst_i(1'b0), .d_i({e_4, what_4}),
        .q_o({e_late, what_late}));

    wire [W-2:0]     z_5;
    wire [2*P-1:0]   p_5;
    wire [PLACE-1:0] e_5;
    wire             lost_5, lost_6, lost_7, lost_8, lost_9;
    fp3_fp_fma_align #(.P(P), .W(W-1), .WAIT(BESIDE), .CUTS(CUTS[5])) u_align (.clk_i(clk_i), .z_i(sig_4),
        .n_i(n_4), .d_o(z_5), .lost_o(lost_5));
    fp3_cut #(.W(2*P+PLACE+6), .ON(CUTS[5])) u_5 (.clk_i(clk_i),
        .d_i({p_4 ^ {2*P{what_late[5]}}, e_late, what_late}), .q_o({p_5, e_5, what_5}));

    // z, plus or minus the product. What is lost of z is above what the sum has.
    wire [W-3:0] sum;
    wire         unused_carry;
    assign {sum, unused_carry} = {1'b0, z_5[W-2:2], 1'b1} + {{P+3{what_5[5]}}, p_5, what_5[5]};

    wire [W-1:0]     s_6;
    wire [PLACE-1:0] e_6;
    fp3_cut #(.W(W+PLACE+7), .ON(CUTS[6])) u_6 (.clk_i(clk_i),
        .d_i({sum, z_5[1:0], lost_5, e_5, what_5}), .q_o({s_6, lost_6, e_6, what_6}));

    wire [P+1:0]     d_9;
    wire             more_9, negative_9;
    wire [PLACE-1:0] e_9;
    wire [3:0]       n_9;
    fp3_fp_fma_normalize #(.W(W), .K(P+2), .PLACE(PLACE), .LATE(Z_EARLY), .CUTS(CUTS[9:7])) u_normalize (
        .clk_i(clk_i), .s_i(s_6),
        .negative_i(what_6[5] && s_6[W-1]), .limit_i(e_6), .d_o(d_9), .more_o(more_9), .negative_o(negative_9),
        .limit_o(e_9), .n_o(n_9));
    fp3_cut #(.W(7), .ON(CUTS[7])) u_7 (.clk_i(clk_i), .d_i({lost_6, what_6}), .q_o({lost_7, what_7}));
    fp3_cut #(.W(7), .ON(CUTS[8])) u_8 (.clk_i(clk_i), .d_i({lost_7, what_7}), .q_o({lost_8, what_8}));
    fp3_cut #(.W(7), .ON(CUTS[9])) u_9 (.clk_i(clk_i), .d_i({lost_8, what_8}), .q_o({lost_9, what_9}));

    wire minus_9, z_sign_9, inf_sign_9, inf_9, nan_9, invalid_9;
    assign {minus_9, z_sign_9, inf_sign_9, inf_9, nan_9, invalid_9} = what_9;
    fp3_fp_fma_round #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .PLACE(PLACE),
        .CUTS(CUTS[10])) u_round (
        .clk_i(clk_i), .d_i(d_9), .more_i(more_9 || lost_9), .negative_i(negative_9), .e_i(e_9), .n_i(n_9),
        .minus_i(minus_9),
        .sign_i(inf_9 ? inf_sign_9 : z_sign_9 ^ negative_9), .inf_i(inf_9), .nan_i(nan_9), .invalid_i(invalid_9),
        .z_o(z_o), .flags_o(flags_o));
endmodule
`default_nettype wire
