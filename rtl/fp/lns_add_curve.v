// lns_add_curve: the functions behind a logarithmic sum, as quadratics: c0 - c1 * u + (c2 * u + c3) * u.
//
// Purpose   log2(1 + 2^-r), and of a difference -log2(1 - 2^-r), or for r < 4 what is left of it without its pole. The result
//           is line_o + bend_o. The bits of fp3_lns_of_distance in sw/machine/lns.c.
// Latency   6; a new r every cycle.
//
//     minus_i 0, r_i 0000000  ->  line_o + bend_o 1000000E, which is 2^28 with 14 of the 16 that round, six edges later
`default_nettype none
module lns_add_curve (
    input  wire        clk_i,
    input  wire        minus_i,        // of a difference
    input  wire [27:0] r_i,            // in 2^-23, below 32
    output wire [29:0] line_o,         // signed, in 2^-28
    output wire [29:0] bend_o
);
`include "gen/lns_sums.vh"
    (* rom_style = "block" *) reg [66:0] words [0:1023];
    integer i;
    initial for (i = 0; i < 512; i = i + 1) begin
        words[i]       = SUMS[67*i +: 67];
        words[512 + i] = DIFFERENCES[67*i +: 67];
    end

    // Intervals of 1/32 below 8, 1/16 below 16, 1/8 above. Of u, what is beyond 18 bits makes no difference.
    reg [9:0]  at_q;
    reg [17:0] u0_q, u1_q, u2_q;
    reg [66:0] read_q, word_q;
    always @(posedge clk_i) begin
        at_q   <= {minus_i, r_i[27] ? {2'b11, r_i[26:20]} : r_i[26] ? {2'b10, r_i[25:19]} : {1'b0, r_i[25:18]}};
        u0_q   <= r_i[27] ? r_i[19:2] : r_i[26] ? r_i[18:1] : r_i[17:0];
        read_q <= words[at_q];
        u1_q   <= u0_q;
        word_q <= read_q;
        u2_q   <= u1_q;
    end

    wire [35:0] fall  = {18'd0, word_q[36:19]} * {18'd0, u2_q};
    wire [29:0] curve = {18'd0, word_q[18:7]} * {12'd0, u2_q};
    wire        unused_products = &{fall[13:0], curve[11:0]};
    reg  [29:0] c0_q;
    reg  [6:0]  c3_q;
    reg  [21:0] fall_q;
    reg  [17:0] curve_q, u3_q, slope_q, u4_q;
    reg  [29:0] line_q, line2_q;
    wire [35:0] product = {18'd0, slope_q} * {18'd0, u4_q};
    wire        unused_product = &product[20:0];
    reg  [14:0] bend_q;
    always @(posedge clk_i) begin
        c0_q    <= word_q[66:37];
        c3_q    <= word_q[6:0];
        fall_q  <= fall[35:14];
        curve_q <= curve[29:12];
        u3_q    <= u2_q;
        slope_q <= curve_q + {11'd0, c3_q};
        u4_q    <= u3_q;
        line_q  <= c0_q - {8'd0, fall_q};
        line2_q <= line_q;
        bend_q  <= product[35:21];
    end
    assign line_o = line2_q;
    assign bend_o = {15'd0, bend_q};
endmodule
`default_nettype wire
