// SPDX-License-Identifier: Apache-2.0
// fp3_lns_add: z = a + b or a - b of logarithmic words.
//
// Purpose   The larger operand's logarithm plus a function of the distance r of both logarithms:
//           log2(1 + 2^-r) or log2(1 - 2^-r). docs/logarithmic.md defines the bits of the sum;
//           sw/machine/lns.c computes the same bits.
//
//           r ──► lns_add_curve: sum, or difference without its pole ─────┐
//           r < 4, difference ──► normalised ──► lns_curve: log2(r) ─────(+)──► (+) ──► z
//           the larger operand ──────────────────────────────────────────────────┘
//
// Latency   9; a new pair every cycle. There is no register at the ports, no reset and no valid
//           bit.
// Result    NaN and infinity - infinity give the NaN 7FC00000; x - x is +0. OF and UF are raised
//           if the result leaves the range.
//
//     sub_i 0, a_i 3F800000, b_i 3F800000  ->  z_o 40000000, flags_o 0, nine edges later
`default_nettype none
module fp3_lns_add (
    input  wire        clk_i,
    input  wire        sub_i,          // 1: a - b
    input  wire [31:0] a_i,
    input  wire [31:0] b_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    localparam [7:0] TOP = 8'd255;     // the logarithm's integer part of infinity and NaN

    // The larger operand, and the distance of the smaller one.
    wire [31:0] a_less = {1'b0, a_i[30:0]} - {1'b0, b_i[30:0]};
    wire [30:0] b_less = b_i[30:0] - a_i[30:0];
    wire        b_sign = b_i[31] ^ sub_i;
    wire        a_top = a_i[30:23] == TOP, b_top = b_i[30:23] == TOP, a_rest = |a_i[22:0], b_rest = |b_i[22:0];
    reg  [31:0] big_q;
    reg  [30:0] r_q;
    reg         minus_q, nan_q, infinite_q, both_q, zero_q;
    always @(posedge clk_i) begin
        big_q      <= a_less[31] ? {b_sign, b_i[30:0]} : a_i;
        r_q        <= a_less[31] ? b_less : a_less[30:0];
        minus_q    <= a_i[31] ^ b_sign;
        nan_q      <= (a_top && a_rest) || (b_top && b_rest);
        infinite_q <= a_top || b_top;
        both_q     <= a_top && b_top;
        zero_q     <= ~|a_i[30:0] || ~|b_i[30:0];
    end

    // Results that are no sum of two numbers. none: 0 or NaN; big: the larger operand.
    wire equal   = ~|r_q;
    wire far     = |r_q[30:28];
    wire invalid = both_q && minus_q && !nan_q;
    wire nan     = nan_q || invalid;
    wire none    = nan || (minus_q && equal);
    wire big     = infinite_q || zero_q || far;
    wire exact   = infinite_q || zero_q || none || (minus_q ? r_q == {8'd1, 23'd0} : equal);
    wire near    = minus_q && ~|r_q[30:25];               // r < 4
    wire        invert;                                   // a difference at r >= 4 is tabulated with its sign changed
    wire [31:0] word;
    wire [4:0]  kind;
    fp3_delay #(.W(38), .N(7)) u_word (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({minus_q && !near, nan, invalid, none, big, !exact, big_q}), .q_o({invert, kind, word}));

    // Two steps move the distance's highest bit to the top: first by multiples of 8, then by up to 7.
    wire        by16 = ~|r_q[24:9];
    wire        by8  = by16 ? ~|r_q[8:1] : ~|r_q[24:17];
    wire [24:0] moved;
    fp3_mux4 #(.W(25)) u_coarse (.n_i({by16, by8}), .d0_i(r_q[24:0]), .d1_i({r_q[16:0], 8'd0}),
        .d2_i({r_q[8:0], 16'd0}),
        .d3_i({r_q[0], 24'd0}), .q_o(moved));
    reg  [24:0] moved_q;
    reg  [1:0]  upper_q;
    reg         near_q;
    always @(posedge clk_i) begin
        moved_q <= moved;
        upper_q <= {by16, by8};
        near_q  <= near;
    end
    wire        by4 = ~|moved_q[24:21];
    wire        by2 = by4 ? ~|moved_q[20:19] : ~|moved_q[24:23];
    wire        by1 = by4 ? (by2 ? !moved_q[18] : !moved_q[20]) : (by2 ? !moved_q[22] : !moved_q[24]);
    wire [24:0] nearly;
    fp3_mux4 #(.W(25)) u_fine (.n_i({by4, by2}), .d0_i(moved_q), .d1_i({moved_q[22:0], 2'd0}),
        .d2_i({moved_q[20:0], 4'd0}),
        .d3_i({moved_q[18:0], 6'd0}), .q_o(nearly));
    wire        unused_top = nearly[24];                  // 1 unless by1
    reg  [23:0] fraction_q;
    reg  [5:0]  whole_q;                                  // integer part of log2(r) - 2: -1 - places moved
    always @(posedge clk_i)
        if (!near_q) begin
            fraction_q <= 24'd0;
            whole_q    <= 6'd0;
        end else begin
            fraction_q <= by1 ? {nearly[22:0], 1'b0} : nearly[23:0];
            whole_q    <= ~{1'b0, upper_q, by4, by2, by1};
        end

    wire [27:0] log;
    wire [5:0]  whole;
    wire [29:0] smooth, bend;
    fp3_lns_curve u_log (.clk_i(clk_i), .x_i(fraction_q), .value_o(log));
    fp3_delay #(.W(6), .N(4)) u_whole (.clk_i(clk_i), .rst_i(1'b0), .d_i(whole_q), .q_o(whole));
    fp3_lns_add_curve u_smooth (.clk_i(clk_i), .minus_i(minus_q), .r_i(r_q[27:0]), .line_o(smooth), .bend_o(bend));

    reg [33:0] function_q;
    always @(posedge clk_i) function_q <= {{4{smooth[29]}}, smooth} + {4'd0, bend} + {whole, log};

    // The bits below the last place are dropped: the tables contain the half unit that rounds.
    reg  [32:0] total_q;
    reg  [31:0] word_q;
    reg         is_nan_q, is_invalid_q, is_none_q, is_big_q, is_inexact_q;
    wire        unused = &function_q[4:0];
    always @(posedge clk_i) begin
        total_q <= {2'd0, word[30:0]} + {{4{function_q[33] ^ invert}}, function_q[33:5] ^ {29{invert}}};
        word_q  <= word;
        {is_nan_q, is_invalid_q, is_none_q, is_big_q, is_inexact_q} <= kind;
    end
    wire        is_sum = !is_none_q && !is_big_q;
    wire        under  = is_sum && (total_q[32] || ~|total_q[31:0]);
    wire        over   = is_sum && !total_q[32] && (total_q[31] || &total_q[30:23]);
    wire [30:0] size   = is_big_q ? word_q[30:0] : total_q[30:0];
    assign z_o = is_nan_q ? BITS_NAN : is_none_q ? 32'd0
               : {word_q[31], over ? {TOP, 23'd0} : size & {31{!under}}};
    assign flags_o = {is_invalid_q, 1'b0, over, under, is_inexact_q || over || under};
endmodule
`default_nettype wire
