// lns_curve: a logarithm or a power of two of a fraction, from a table of quadratics.
//
// Purpose   log2(1 + x), or with POWER 2^x - 1, x in 0 .. 1: x itself and a small correction, which is tabulated. The bits of
//           curve() in sw/machine/lns.c.
// Latency   4: the table, a register behind it as block RAM is slow, the slope, its product with the rest of x. A new x every cycle.
//
//     x_i 800000, POWER 0  ->  value_o 95C01A6, which is 0.58496 * 2^28, four edges later
`default_nettype none
module lns_curve #(
    parameter POWER = 0
) (
    input  wire        clk_i,
    input  wire [23:0] x_i,            // in 2^-24
    output wire [27:0] value_o         // in 2^-28
);
`include "gen/lns_curves.vh"
    (* rom_style = "block" *) reg [52:0] words [0:511];
    integer i;
    initial for (i = 0; i < 512; i = i + 1) words[i] = POWER != 0 ? POWERS[53*i +: 53] : LOGS[53*i +: 53];

    reg [52:0] read_q, word_q;
    reg [23:0] read_x_q, x_q;
    always @(posedge clk_i) begin
        read_q   <= words[x_i[23:15]];
        word_q   <= read_q;
        read_x_q <= x_i;
        x_q      <= read_x_q;
    end

    // (c1 - c2 * v) * v, v being what of x the table has not seen.
    wire [24:0]        c0   = word_q[52:28];
    wire signed [17:0] c1   = word_q[27:10];
    wire [24:0]        bend = {15'd0, word_q[9:0]} * {10'd0, x_q[14:0]};
    wire               unused_bend = &bend[15:0];
    reg signed [17:0]  slope_q;
    reg [14:0]         v_q;
    reg [27:0]         base_q;
    always @(posedge clk_i) begin
        slope_q <= c1 - {9'd0, bend[24:16]};
        v_q     <= x_q[14:0];
        base_q  <= POWER != 0 ? {x_q, 4'd0} - {3'd0, c0} : {x_q, 4'd0} + {3'd0, c0};
    end

    wire signed [33:0] product = slope_q * $signed({1'b0, v_q});
    wire               unused_product = &product[13:0];
    reg [19:0]         rest_q;
    reg [27:0]         late_base_q;
    always @(posedge clk_i) begin
        rest_q      <= product[33:14];
        late_base_q <= base_q;
    end
    wire [27:0] rest = {{8{rest_q[19]}}, rest_q};
    assign value_o = POWER != 0 ? late_base_q - rest : late_base_q + rest;
endmodule
`default_nettype wire
