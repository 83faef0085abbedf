// SPDX-License-Identifier: Apache-2.0
// fp3_fp_value: passes an addend on, or replaces it by a comparison, a selection, an estimate, a
// rounding or an exponent.
//
// Purpose   min, max, abs, lt, le, sel, rcp, rsqrt, rint, exp2 and logb, while an addend waits for
//           its product: the sum of z_o and -0 is the instruction's result, with its flags.
// Latency   MUL_LATENCY - EARLY, at least 1, as beside the multiplier: up to three registers in the
//           logic, the others behind it. no_product_o comes a cycle before z_o: the product must
//           then be -0.
// Hazard    choice_i as in gen/choices.vh, and CHOICE_NONE where no such instruction is built
//           (VALUES = 0): then all of this is a delay, as long as z_o is not read late enough
//           (Z_LATE). Bits below the fraction are not 0 in z_o where an estimate has more bits: the
//           adder reads none of them.
//
//     choice_i CHOICE_MIN, a_i 3F800000, b_i C0000000  ->  z_o C0000000, MUL_LATENCY - EARLY edges
//     later
`default_nettype none
module fp3_fp_value #(
    parameter EARLY = 0,               // registers less
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire [CHOICE_W-1:0] choice_i,
    input  wire [31:0] a_i,
    input  wire [31:0] b_i,
    input  wire        true_i,         // sel: a
    output wire [31:0] z_o,
    output wire        no_product_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
    localparam DEPTH   = MUL_LATENCY - EARLY;
    localparam STAGES  = DEPTH < 3 ? DEPTH : 3;

    generate
        if (VALUES == 0) begin : g_plain
            wire unused = &{choice_i, b_i, true_i};
            assign no_product_o = 1'b0;
            fp3_delay #(.W(32), .N(DEPTH - Z_LATE)) u_delay (.clk_i(clk_i), .rst_i(1'b0), .d_i(a_i), .q_o(z_o));
        end else begin : g_value
            wire [31:0] a = a_i & KEPT, b = b_i & KEPT;      // arithmetic reads the bits below the fraction as 0
            wire plain = choice_i == CHOICE_NONE;
            wire minimum = choice_i == CHOICE_MIN, maximum = choice_i == CHOICE_MAX, sel = choice_i == CHOICE_SEL;
            wire lt = choice_i == CHOICE_LT, le = choice_i == CHOICE_LE;
            wire root = choice_i == CHOICE_RSQRT, estimated = root || choice_i == CHOICE_RCP;
            wire rint = ROUND != 0 && choice_i == CHOICE_RINT;
            wire logb = choice_i == CHOICE_LOGB, exponent = ROUND != 0 && (logb || choice_i == CHOICE_EXP2);
            fp3_delay #(.W(1), .N(DEPTH-1)) u_no_product (.clk_i(clk_i), .rst_i(1'b0), .d_i(!plain),
                .q_o(no_product_o));

            // Magnitudes are ordered as integers; without infinities, subnormal numbers are read as
            // zeros. What is known of the operands, and then what follows.
            wire        a_nan = FINITE == 0 && &a[30:23] && |a[22:0], b_nan = FINITE == 0 && &b[30:23] && |b[22:0];
            reg         a_lower_q, b_lower_q, nan_q, zeros_q, true_q;
            reg         minimum_q, maximum_q, sel_q, lt_q, le_q, estimated_q, rint_q, exponent_q, made_q;
            reg  [31:0] a_q, b_q;
            always @(posedge clk_i) begin
                a_lower_q   <= a[30:0] < b[30:0];
                b_lower_q   <= b[30:0] < a[30:0];
                nan_q       <= a_nan || b_nan;
                zeros_q     <= {a[30:23], b[30:23]} == 16'd0 && (FINITE != 0 || {a[22:0], b[22:0]} == 46'd0);
                true_q      <= true_i;
                {minimum_q, maximum_q, sel_q, lt_q, le_q} <= {minimum, maximum, sel, lt, le} & {5{SELECT != 0}};
                estimated_q <= ESTIMATE != 0 && estimated;
                rint_q      <= rint;
                exponent_q  <= exponent;
                made_q      <= rint || (SELECT != 0 && (lt || le)) || ((exponent || (ESTIMATE != 0 && estimated)) && !a_nan);
                a_q         <= {a[31] && !(SELECT != 0 && choice_i == CHOICE_ABS), a[30:0]};
                b_q         <= b;
            end
            wire        a_less  = !nan_q && !(FINITE != 0 && zeros_q) && (a_q[31] ? (b_q[31] ? b_lower_q : !zeros_q) : !b_q[31] && a_lower_q);
            wire        b_less  = !nan_q && !(FINITE != 0 && zeros_q) && (b_q[31] ? (a_q[31] ? a_lower_q : !zeros_q) : !a_q[31] && b_lower_q);
            wire        takes_b = (minimum_q && !a_less) || (maximum_q && !b_less) || (sel_q && !true_q);
            wire        is_one  = (lt_q && a_less) || (le_q && !nan_q && !b_less);

            wire        made, one, is_estimate, is_rint, is_exponent;
            wire [31:0] chosen, z;
            fp3_cut #(.W(37), .ON(STAGES == 3)) u_2 (.clk_i(clk_i),
                .d_i({made_q, is_one, estimated_q, rint_q, exponent_q, takes_b ? b_q : a_q}),
                .q_o({made, one, is_estimate, is_rint, is_exponent, chosen}));

            wire [31:13] estimate;
            if (ESTIMATE != 0 && LOGARITHMIC == 0 && MIXED == 0) begin : g_estimate
                fp3_fp_estimate #(.CUT(STAGES == 3), .FINITE(FINITE)) u_estimate (.clk_i(clk_i), .root_i(root),
                    .a_i(a[31:13]), .z_o(estimate));
            end else begin : g_no_estimate
                wire unused = root;
                assign estimate = {LOGARITHMIC != 0, 18'd0};               // log_arith adds the reciprocal to -0, lane_arith puts it in place of +0
            end
            wire [31:0] rounded, scaled;
            if (ROUND != 0) begin : g_rint
                fp3_fp_rint #(.CUT(STAGES == 3), .NEAREST(NEAREST)) u_rint (.clk_i(clk_i), .a_i(a), .z_o(rounded));
                fp3_fp_exponent #(.CUT(STAGES == 3), .FINITE(FINITE)) u_exponent (.clk_i(clk_i), .log_i(logb),
                    .a_i(a[31:16]), .z_o(scaled));
            end else begin : g_no_rint
                wire unused = logb;
                assign rounded = 32'd0;
                assign scaled  = 32'd0;
            end
            wire [31:0] number = rounded & {32{is_rint}} | scaled & {32{is_exponent}}
                                 | {estimate & {19{is_estimate}}, 13'd0} | BITS_ONE & {32{one}};
            fp3_cut #(.W(32), .ON(STAGES >= 2)) u_3 (.clk_i(clk_i), .d_i(made ? number : chosen), .q_o(z));
            fp3_delay #(.W(32), .N(DEPTH-STAGES)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(z), .q_o(z_o));
        end
    endgenerate
endmodule
`default_nettype wire
