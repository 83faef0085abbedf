// SPDX-License-Identifier: Apache-2.0
// fp3_lns_add_curve: the functions behind a logarithmic sum, as quadratics: c0 - c1 * u + (c2 * u +
// c3) * u.
//
// Purpose   log2(1 + 2^-r), and of a difference -log2(1 - 2^-r), or for r < 4 this function
//           without its pole. The result is line_o + bend_o, with the bits of
//           fp3_lns_of_distance in sw/machine/lns.c.
// Latency   6; a new r every cycle.
//
//     minus_i 0, r_i 0000000  ->  line_o + bend_o 1000000E, six edges later: 2^28 and 14 of the 16
//     units that round
`default_nettype none
module fp3_lns_add_curve (
    input  wire        clk_i,
    input  wire        minus_i,        // of a difference
    input  wire [27:0] r_i,            // in 2^-23, below 32
    output wire [29:0] line_o,         // signed, in 2^-28
    output wire [29:0] bend_o
);
`include "gen/lns_sums.vh"
    // Intervals of 1/32 below 8, 1/16 below 16, 1/8 above. Bits of u beyond the 18 upper ones make
    // no difference. The registers before and behind a product are inside the multiplier.
    wire [9:0]  at = {minus_i, r_i[27] ? {2'b11, r_i[26:20]} : r_i[26] ? {2'b10, r_i[25:19]} : {1'b0, r_i[25:18]}};
    wire [66:0] word;
    reg  [17:0] u0_q, u1_q, u2_q, u3_q;
    reg  [29:0] c0_q, late_c0_q, line_q, late_line_q;
    reg  [6:0]  c3_q, late_c3_q;
    wire [35:0] fall, curve, bend;
    wire        unused = &{fall[13:0], curve[35:30], curve[11:0], bend[20:0]};
    fp3_rom_registered #(.ADDR_W(10), .W(67), .WORDS({DIFFERENCES, SUMS})) u_words (.clk_i(clk_i), .at_i(at),
        .word_o(word));
    fp3_multiply #(.CUTS(2'b11)) u_fall (.clk_i(clk_i), .a_i(word[36:19]), .b_i(u1_q), .p_o(fall));
    fp3_multiply #(.CUTS(2'b11)) u_curve (.clk_i(clk_i), .a_i({6'd0, word[18:7]}), .b_i(u1_q), .p_o(curve));
    fp3_multiply #(.CUTS(2'b11)) u_bend (.clk_i(clk_i), .a_i(curve[29:12] + {11'd0, late_c3_q}), .b_i(u3_q),
        .p_o(bend));
    always @(posedge clk_i) begin
        u0_q        <= r_i[27] ? r_i[19:2] : r_i[26] ? r_i[18:1] : r_i[17:0];
        {u1_q, u2_q, u3_q} <= {u0_q, u1_q, u2_q};
        {c0_q, c3_q}           <= {word[66:37], word[6:0]};
        {late_c0_q, late_c3_q} <= {c0_q, c3_q};
        line_q      <= late_c0_q - {8'd0, fall[35:14]};
        late_line_q <= line_q;
    end
    assign line_o = late_line_q;
    assign bend_o = {15'd0, bend[35:21]};
endmodule
`default_nettype wire
