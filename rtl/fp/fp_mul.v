// fp_mul: floating-point multiplier, IEEE 754, subnormals and flags included.
//
// Purpose   z = a * b in any binary format with EXP >= 3; default binary32, round to nearest
//           even, gradual underflow, tininess after rounding, every NaN result 7FC00000.
// Latency   popcount(CUTS) cycles, one operation per cycle; CUTS = 0 is a function of a_i, b_i.
//           There is no reset, enable or valid bit: a tag travels beside it.
//           Places: 0 operands classified, 1 partial products, 2 first sums, 3 product,
//           4 shifted by sixteens and fours, 5 by ones, 6 rounded.
// Flags     {NV, DZ, OF, UF, NX}. NV: a signalling NaN, or zero times infinity.
// Options   SUBNORMAL = 0: a subnormal operand is a zero of its sign; a nonzero product whose
//           exact value lies below the least normal number (tiny before rounding) becomes a
//           zero of its sign with UF and NX. NEAREST = 0: truncate; overflow then gives the
//           largest finite number with OF and NX.
//
//     fp_mul #(.CUTS(7'b0101000)) u (.clk_i(clk), .a_i(x), .b_i(y), .z_o(z), .flags_o(f));
//     // two edges later z = x * y: 3F800001 * 40000000 = 40000001, f = 0
`default_nettype none
module fp_mul #(
    parameter       EXP       = 8,
    parameter       FRAC      = 23,
    parameter       SUBNORMAL = 1,
    parameter       NEAREST   = 1,
    parameter [6:0] CUTS      = 0
) (
    input  wire                clk_i,
    input  wire [EXP+FRAC:0]   a_i, b_i,
    output wire [EXP+FRAC:0]   z_o,
    output wire [4:0]          flags_o
);
    localparam SW = FRAC < 7 ? 5 : $clog2(2*FRAC + 3);      // shift amount

    // Operands.
    wire [EXP-1:0]  ae = a_i[EXP+FRAC-1:FRAC], be = b_i[EXP+FRAC-1:FRAC];
    wire [FRAC-1:0] af = a_i[FRAC-1:0], bf = b_i[FRAC-1:0];
    wire a_normal = |ae, b_normal = |be;
    wire a_empty = ~|af, b_empty = ~|bf;
    wire [2*FRAC+1:0] p;
    fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS[3:0])) u_product (
        .clk_i(clk_i), .a_i({a_normal, af}), .b_i({b_normal, bf}), .p_o(p));

    // Leading zeros are counted in one operand at most. In front of a cut there is time to choose
    // it; otherwise fp_mul_scale counts in both and chooses last.
    wire [FRAC-1:0] either = a_normal ? bf : af;
    wire [EXP-1:0]  ae_0, be_0;
    wire [FRAC-1:0] af_0, bf_0;
    wire a_normal_0, b_normal_0, a_empty_0, b_empty_0, a_top_0, b_top_0, a_quiet_0, b_quiet_0, sign_0;
    cut #(.W(2*EXP+2*FRAC+9), .ON(CUTS[0])) u_0 (.clk_i(clk_i),
        .d_i({ae, be, CUTS[0] ? {either, either} : {af, bf}, a_normal, b_normal, a_empty, b_empty,
              &ae, &be, af[FRAC-1], bf[FRAC-1], a_i[EXP+FRAC] ^ b_i[EXP+FRAC]}),
        .q_o({ae_0, be_0, af_0, bf_0, a_normal_0, b_normal_0, a_empty_0, b_empty_0,
              a_top_0, b_top_0, a_quiet_0, b_quiet_0, sign_0}));

    // Class of the result.
    wire a_zero = !a_normal_0 && (a_empty_0 || SUBNORMAL == 0);
    wire b_zero = !b_normal_0 && (b_empty_0 || SUBNORMAL == 0);
    wire a_nan = a_top_0 && !a_empty_0, b_nan = b_top_0 && !b_empty_0;
    wire nv = (a_nan && !a_quiet_0) || (b_nan && !b_quiet_0)
           || (a_top_0 && b_zero && a_empty_0) || (b_top_0 && a_zero && b_empty_0);
    wire inf  = a_top_0 || b_top_0;
    wire zero = a_zero || b_zero;

    // Beside the product: how far to shift it, its exponent, its class.
    wire [SW-1:0] shift_2;
    wire [EXP+4:0] place_2;
    fp_mul_scale #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .SW(SW), .CUTS(CUTS[2:1]))
        u_scale (.clk_i(clk_i), .ae_i(ae_0), .be_i(be_0), .af_i(af_0), .bf_i(bf_0),
                 .a_normal_i(a_normal_0), .b_normal_i(b_normal_0),
                 .shift_o(shift_2), .place_o(place_2));
    wire nv_1, quiet_1, inf_1, zero_1, sign_1;
    cut #(.W(5), .ON(CUTS[1])) u_1 (.clk_i(clk_i),
        .d_i({nv, a_nan || b_nan, inf, zero, sign_0}), .q_o({nv_1, quiet_1, inf_1, zero_1, sign_1}));
    wire nan = nv_1 || quiet_1;
    wire [4:0] class_2;
    cut #(.W(5), .ON(CUTS[2])) u_2 (.clk_i(clk_i),
        .d_i({nv_1, nan, inf_1 && !nan, zero_1 && !nan, sign_1 && !nan}), .q_o(class_2));

    // abc9 believes that multipliers take no time, and would hurry the shift instead of the
    // product; keep makes it see both as early.
    (* keep *) wire [SW-1:0] shift_3;
    wire [EXP+9:0] side_3, side_4, side_5;
    cut #(.W(SW+EXP+10), .ON(CUTS[3])) u_3 (.clk_i(clk_i),
        .d_i({shift_2, place_2, class_2}), .q_o({shift_3, side_3}));

    // Shift by sixteens, fours and ones; what falls off below is sticky.
    wire [SW-1:0]      by_16 = {shift_3[SW-1:4], 4'd0};
    wire [3:0]         by_4  = {shift_3[3:2], 2'd0};
    wire [2*FRAC+18:0] wide  = {16'd0, p, 1'b0};
    wire [FRAC+17:0]   sixteens;
    wire [FRAC+5:0]    fours, fours_4;
    wire [FRAC:0]      sixteens_unused;
    wire [11:0]        fours_unused;
    assign {sixteens_unused, sixteens} = wide >> by_16;
    assign {fours_unused, fours} = sixteens >> by_4;
    // A four of bits is lost if the shift goes beyond it: told beside the shift, not behind it.
    localparam FOURS = (2*FRAC + 6) / 4;
    localparam LOST  = (FOURS + 3) / 4;                  // fours of those
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
    cut #(.W(FRAC+EXP+18+LOST), .ON(CUTS[4])) u_4 (.clk_i(clk_i),
        .d_i({fours, lost, shift_3[1:0], side_3}), .q_o({fours_4, losts_4, by_1, side_4}));

    wire [2:0]      ones_unused;
    wire [FRAC+2:0] fine, t;
    wire            lost_4 = |losts_4;
    wire            stick = lost_4 || |(fours_4[2:0] & ~(3'd7 << by_1));
    assign {ones_unused, fine} = fours_4 >> by_1;
    wire            st;
    cut #(.W(FRAC+EXP+14), .ON(CUTS[5])) u_5 (.clk_i(clk_i),
        .d_i({fine, stick, side_4}), .q_o({t, st, side_5}));
    wire [EXP-1:0]  field_5;
    wire            low_5, over_5, by1_5, by2_5, gone_5, nv_5, nan_5, inf_5, zero_5, sign_5;
    assign {field_5, low_5, over_5, by1_5, by2_5, gone_5, nv_5, nan_5, inf_5, zero_5, sign_5}
        = side_5;

    // Both places of the leading one are rounded, by half a unit; a tie then clears the last
    // bit. The top bit of t chooses, beside the adders. Exponent and fraction are one number,
    // so a carry out of the fraction needs no care, up to infinity itself.
    wire top   = t[FRAC+2];
    wire right = top || low_5;
    localparam [0:0] HALF = NEAREST != 0;
    wire [EXP+FRAC:0] hi = {field_5, t[FRAC+1:1]} + {{EXP-1{1'b0}}, top, {FRAC{1'b0}}, HALF};
    wire [EXP+FRAC:0] lo = {field_5, t[FRAC:0]} + {{EXP+FRAC{1'b0}}, HALF};
    wire hi_lo_unused = &{hi[0], lo[0]};
    wire hi_odd  = hi[1] && !(HALF && t[1:0] == 2'b10 && !st);
    wire lo_odd  = lo[1] && !(HALF && t[0] && !st);
    wire tiny    = gone_5 || (low_5 && !top);
    wire flush   = SUBNORMAL == 0 && tiny;
    wire usual   = !nan_5 && !inf_5 && !zero_5;
    wire beyond  = usual && !gone_5 && (over_5 || (by1_5 && top));
    wire edge_5  = usual && !gone_5 && ((by1_5 && !right) || (by2_5 && top));
    wire inexact = usual && (t[0] || st || (right && t[1]) || flush || beyond);
    wire under_5 = usual && tiny && (inexact || flush);
    wire near    = HALF && SUBNORMAL != 0 && t[0];    // rounds to normal with a finer last place
    wire clear_5 = !usual || flush || (beyond && HALF);           // fraction bits
    wire zeros_5 = zero_5 || (usual && flush);        // exponent bits
    wire full_5  = nan_5 || inf_5 || beyond;

    wire [EXP+FRAC-1:0] hi_6, lo_6;
    wire right_6, clear_6, zeros_6, full_6, nan_6, nv_6, sign_6, beyond_6, edge_6, under_6, near_6,
         inexact_6;
    cut #(.W(2*EXP+2*FRAC+12), .ON(CUTS[6])) u_6 (.clk_i(clk_i),
        .d_i({hi[EXP+FRAC:2], hi_odd, lo[EXP+FRAC:2], lo_odd, right, clear_5, zeros_5, full_5, nan_5,
              nv_5, sign_5, beyond, edge_5, under_5, near, inexact}),
        .q_o({hi_6, lo_6, right_6, clear_6, zeros_6, full_6, nan_6,
              nv_6, sign_6, beyond_6, edge_6, under_6, near_6, inexact_6}));

    // Pack.
    wire [EXP+FRAC-1:0] r = right_6 ? hi_6 : lo_6;
    wire [EXP-1:0]  ez = (r[EXP+FRAC-1:FRAC] & {EXP{!zeros_6}}) | {EXP{full_6}};
    wire [FRAC-1:0] fz = (r[FRAC-1:0] & {FRAC{!clear_6}});
    wire            brim = full_6 && !clear_6;      // truncated overflow: the largest finite
    assign z_o = {sign_6, ez[EXP-1:1], ez[0] && !brim,
                  fz[FRAC-1] || nan_6 || brim, fz[FRAC-2:0] | {FRAC-1{brim}}};
    wire of = beyond_6 || (edge_6 && r[FRAC]);
    assign flags_o = {nv_6, 1'b0, of, under_6 && !(near_6 && r[FRAC]), inexact_6 || of};
endmodule
`default_nettype wire
