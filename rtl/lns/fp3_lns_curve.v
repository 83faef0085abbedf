// SPDX-License-Identifier: Apache-2.0
// fp3_lns_curve: a logarithm or a power of two of a fraction, from a table of quadratics.
//
// Purpose   log2(1 + x), or with POWER 2^x - 1, for x in 0 .. 1: x plus a small, tabulated
//           correction. The bits are those of curve() in sw/machine/lns.c.
// Latency   4: the table, a register behind the table as block RAM is slow, the products, their
//           difference. A new x every cycle.
//
//     x_i 800000, POWER 0  ->  value_o 95C01A4, which is 0.58496 * 2^28, four edges later
`default_nettype none
module fp3_lns_curve #(
    parameter POWER = 0
) (
    input  wire        clk_i,
    input  wire [23:0] x_i,            // in 2^-24
    output wire [27:0] value_o         // in 2^-28
);
`include "gen/lns_curves.vh"
    // c0 + c1 * v - c2 * v^2, where v is the bits of x below the table's address. The registers
    // before and behind a product are inside the multiplier.
    wire [52:0] word;
    reg [23:0]  read_x_q, x_q;
    reg [19:0]  rest_q;
    reg [27:0]  base_q, late_base_q;
    wire [35:0] square, line, bend;
    wire        unused = &{square[35:30], square[12:0], line[35:34], line[13:0], bend[35:27], bend[16:0]};
    fp3_rom_registered #(.ADDR_W(9), .W(53), .WORDS(POWER != 0 ? POWERS : LOGS)) u_words (.clk_i(clk_i),
        .at_i(x_i[23:15]), .word_o(word));
    fp3_multiply #(.CUTS(2'b11)) u_square (.clk_i(clk_i), .a_i({3'd0, x_i[14:0]}), .b_i({3'd0, x_i[14:0]}),
        .p_o(square));
    fp3_multiply #(.SIGNED(1), .CUTS(2'b10)) u_line (.clk_i(clk_i), .a_i(word[27:10]), .b_i({3'd0, x_q[14:0]}),
        .p_o(line));
    fp3_multiply #(.CUTS(2'b10)) u_bend (.clk_i(clk_i), .a_i({8'd0, word[9:0]}), .b_i({1'b0, square[29:13]}),
        .p_o(bend));
    always @(posedge clk_i) begin
        read_x_q    <= x_i;
        x_q         <= read_x_q;
        base_q      <= POWER != 0 ? {x_q, 4'd0} - {3'd0, word[52:28]} : {x_q, 4'd0} + {3'd0, word[52:28]};
        rest_q      <= line[33:14] - {10'd0, bend[26:17]};
        late_base_q <= base_q;
    end
    wire [27:0] rest = {{8{rest_q[19]}}, rest_q};
    assign value_o = POWER != 0 ? late_base_q - rest : late_base_q + rest;
endmodule
`default_nettype wire
