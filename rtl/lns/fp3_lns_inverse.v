// SPDX-License-Identifier: Apache-2.0
// fp3_lns_inverse: 1 / a or 1 / sqrt(a) of a binary32 number, through its logarithm.
//
// Purpose   Normalises a, takes the logarithm of its significand, negates the logarithm (and halves
//           it for a root), and takes the power of two. Bits and flags are those of
//           fp3_lns_float_rcp and fp3_lns_float_rsqrt in sw/machine/lns.c, but a NaN gives 0 on z_o
//           and flags_o.
//
//           a ──► normalised ──► lns_curve: log2 ──► -log2 or -log2/2 ──► lns_curve: power of two ──► rounded
//           edges          2                   5                       1                           5
//
// Latency   13; a new number every cycle. There is no register at the ports, no reset and no valid
//           bit.
// Result    Without on_i, z_o and flags_o are 0.
//
//     on_i 1, root_i 0, a_i 40400000  ->  z_o 3EAAAAAB, flags_o 1, thirteen edges later      (1 / 3)
`default_nettype none
module fp3_lns_inverse (
    input  wire        clk_i,
    input  wire        on_i,
    input  wire        root_i,         // 1 / sqrt(a)
    input  wire [31:0] a_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    // Operands without a finite inverse: the result is 0 (not asked for, NaN, infinity), NaN or
    // infinity.
    wire low = ~|a_i[30:23], top = &a_i[30:23], rest = |a_i[22:0];
    wire zero = low && !rest, nan = top && rest;
    wire asked = on_i && !nan;
    wire invalid = asked && root_i && a_i[31] && !zero;
    wire by_zero = asked && zero;
    wire number  = asked && !invalid && !zero && !top;
    wire minus   = asked && a_i[31] && !root_i;

    // Two steps move the leading 1 to the top: first by multiples of 8, then by up to 7.
    wire [23:0] significand = {!low, a_i[22:0]};
    wire        by16 = ~|significand[23:8];
    wire        by8  = ~|significand[23:16];
    wire        root;
    reg  [23:0] moved_q;
    reg  [1:0]  upper_q;
    reg  [7:0]  exponent_q;
    fp3_delay #(.W(1), .N(2)) u_root (.clk_i(clk_i), .rst_i(1'b0), .d_i(root_i), .q_o(root));
    always @(posedge clk_i) begin
        moved_q    <= by16 ? {significand[7:0], 16'd0} : by8 ? {significand[15:0], 8'd0} : significand;
        upper_q    <= {by16, by8 && !by16};
        exponent_q <= low ? 8'd1 : a_i[30:23];
    end
    wire        by4 = ~|moved_q[23:20];
    wire        by2 = by4 ? ~|moved_q[19:18] : ~|moved_q[23:22];
    wire        by1 = by4 ? (by2 ? !moved_q[17] : !moved_q[19]) : (by2 ? !moved_q[21] : !moved_q[23]);
    wire [23:0] nearly;
    fp3_mux4 #(.W(24)) u_fine (.n_i({by4, by2}), .d0_i(moved_q), .d1_i({moved_q[21:0], 2'd0}),
        .d2_i({moved_q[19:0], 4'd0}),
        .d3_i({moved_q[17:0], 6'd0}), .q_o(nearly));
    wire        unused_top = nearly[23];                  // 1 unless by1
    reg  [22:0] fraction_q;
    reg  [9:0]  whole_q;                                  // signed: the logarithm's integer part, plus 127
    always @(posedge clk_i) begin
        fraction_q <= by1 ? {nearly[21:0], 1'b0} : nearly[22:0];
        whole_q    <= {2'd0, exponent_q} - {5'd0, upper_q, by4, by2, by1};
    end

    // The result is exact for a power of two; the root, for a power of four.
    wire        is_root, is_exact;
    wire [9:0]  whole;
    wire [27:0] log;
    reg  [27:0] log_q;
    fp3_lns_curve u_log (.clk_i(clk_i), .x_i({fraction_q, 1'b0}), .value_o(log));
    fp3_delay #(.W(12), .N(5)) u_whole (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({root, ~|fraction_q && !(root && !whole_q[0]), whole_q}),
        .q_o({is_root, is_exact, whole}));
    always @(posedge clk_i) log_q <= log;

    // 254 - log or (381 - log) / 2: the result's logarithm plus 127, to the nearest 2^-24.
    wire [37:0] less = {is_root ? 10'd381 : 10'd254, 23'd0, is_root ? 5'd17 : 5'd9} + ~{whole, log_q};
    reg  [33:0] power_of_q;                               // signed
    reg         is_exact_q;
    wire        unused_less = &less[3:0];
    always @(posedge clk_i) begin
        power_of_q <= is_root ? {less[37], less[37:5]} : less[37:4];
        is_exact_q <= is_exact;
    end

    wire [27:0] power;
    reg  [27:0] power_q;
    wire        exact;
    wire [9:0]  e;
    fp3_lns_curve #(.POWER(1)) u_power (.clk_i(clk_i), .x_i(power_of_q[23:0]), .value_o(power));
    fp3_delay #(.W(11), .N(5)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i({is_exact_q, power_of_q[33:24]}),
        .q_o({exact, e}));
    always @(posedge clk_i) power_q <= power;

    // Subnormal results below 2^-127 have two zeros in front.
    wire        is_invalid, is_by_zero, is_number, sign;
    fp3_delay #(.W(4), .N(13)) u_kind (.clk_i(clk_i), .rst_i(1'b0), .d_i({invalid, by_zero, number, minus}),
        .q_o({is_invalid, is_by_zero, is_number, sign}));
    wire        tiny = e[9] || ~|e;
    wire        over = is_number && !e[9] && (e[8] || &e[7:0]);
    wire [31:7] unrounded = e[9] ? {10'd1, power_q[27:13]} : tiny ? {9'd1, power_q[27:12]} : {e[7:0], power_q[27:11]};
    wire [6:0]  below     = e[9] ? power_q[12:6] : tiny ? power_q[11:5] : power_q[10:4];
    wire [30:0] n         = {unrounded, below[6:1]} + {30'd0, below[0]};
    wire        unused    = &power_q[3:0];
    assign z_o     = is_invalid ? BITS_NAN : {sign, is_by_zero || over ? {8'd255, 23'd0} : n & {31{is_number}}};
    assign flags_o = {is_invalid, is_by_zero, over, is_number && tiny && !exact, is_number && (!exact || over)};
endmodule
`default_nettype wire
