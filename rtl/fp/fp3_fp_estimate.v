// SPDX-License-Identifier: Apache-2.0
// fp3_fp_estimate: a first approximation of 1 / a or 1 / sqrt(a), from a table.
//
// Purpose   The bits of sw/machine/estimate.c. For a NaN z_o is meaningless: fp_value passes the
//           NaN on. Without infinities, where no estimate exists z_o is the largest number,
//           7FFFE000: for 1 / 0 (with its sign), and for 1 / sqrt(a) of a negative a, so that the
//           next operation overflows.
// Latency   1, or 2 with CUT: a register behind the table and nothing between them, as block RAM is
//           slow. The table is one block of 2048 words of 9 bits.
//
//     root_i 0, a_i 40000000  ->  z_o 3EFFC000, a little less than 1/2
`default_nettype none
module fp3_fp_estimate #(
    parameter CUT      = 0,
    parameter FINITE   = 0             // as fp_add's
) (
    input  wire         clk_i,
    input  wire         root_i,        // 1 / sqrt(a)
    input  wire [31:13] a_i,           // the lower bits make no difference
    output wire [31:13] z_o            // ... and are 0
);
`include "gen/estimates.vh"
    wire       sign = a_i[31];
    wire [7:0] e    = a_i[30:23];
    wire       low  = e == 8'd0;                         // zero or subnormal
    wire       top  = FINITE == 0 && e == 8'd255;      // infinity
    wire       high = e >= 8'd253;                       // 1 / a is subnormal or zero

    (* rom_style = "block", syn_romstyle = "block_rom" *) reg [8:0] words [0:2047];
    reg [8:0] word_q;
    integer   i;
    initial for (i = 0; i < 2048; i = i + 1) words[i] = ESTIMATES[9*i +: 9];
    always @(posedge clk_i) word_q <= words[{root_i, root_i ? a_i[23:14] : a_i[22:13]}];

    // Whether the fraction is the table's; else it is 0, or that of a signalling NaN, for which the
    // adder raises invalid, or, without infinities, that of the largest estimate. A subnormal
    // estimate has its leading 1 in the fraction.
    reg       sign_q, known_q, late_q, small_q, nan_q;
    reg [7:0] e_q;
    always @(posedge clk_i)
        if (root_i) begin
            sign_q  <= 1'b0;
            known_q <= !low && !sign && !top;
            nan_q   <= FINITE == 0 ? !low && sign : low || sign;
            late_q  <= !e[0];
            small_q <= 1'b0;
            e_q     <= low || sign ? 8'd255 : top ? 8'd0 : 8'd190 - {1'b0, e[7:1]} - {7'd0, e[0]};
        end else begin
            sign_q  <= sign;
            known_q <= !low && !top;
            nan_q   <= FINITE != 0 && low;
            late_q  <= high && !e[0];
            small_q <= high;
            e_q     <= low ? 8'd255 : high ? 8'd0 : 8'd253 - e;
        end
    wire       sign_c, known_c, late_c, small_c, nan_c;
    wire [7:0] e_c;
    wire [8:0] word_c;
    fp3_cut #(.W(22), .ON(CUT)) u_cut (.clk_i(clk_i), .d_i({sign_q, known_q, late_q, small_q, nan_q, e_q, word_q}),
        .q_o({sign_c, known_c, late_c, small_c, nan_c, e_c, word_c}));
    wire [9:0] early    = small_c ? {1'b1, word_c} : {word_c, 1'b0};
    wire [9:0] fraction = late_c ? {1'b0, early[9:1]} : early;
    assign z_o = {sign_c, e_c, known_c ? fraction : {FINITE != 0 && nan_c, nan_c, {8{FINITE != 0 && nan_c}}}};
endmodule
`default_nettype wire
