// SPDX-License-Identifier: Apache-2.0
// fp3_lns_mul: z = a * b or a / b of logarithmic words, exact unless the result leaves the range.
//
// Purpose   The sum or the difference of two logarithms.
// Latency   0, or 1 with CUT: a register behind the sum.
// Result    0 * infinity, 0 / 0, infinity / infinity and NaN give the NaN 7FC00000; x / 0 an
//           infinity and DZ.
//
//     divide_i 0, a_i 40000000, b_i C0800000  ->  z_o C1000000, flags_o 0      (2 * -4)
`default_nettype none
module fp3_lns_mul #(
    parameter CUT = 0
) (
    input  wire        clk_i,
    input  wire        divide_i,
    input  wire [31:0] a_i,
    input  wire [31:0] b_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    wire a_top = &a_i[30:23], b_top = &b_i[30:23], a_rest = |a_i[22:0], b_rest = |b_i[22:0];
    wire a_infinite = a_top && !a_rest, b_infinite = b_top && !b_rest;
    wire a_zero = ~|a_i[30:0], b_zero = ~|b_i[30:0];

    // Division by 0 is multiplication by infinity; division by infinity is multiplication by 0.
    wire b_large = divide_i ? b_zero : b_infinite, b_small = divide_i ? b_infinite : b_zero;
    wire nan     = (a_top && a_rest) || (b_top && b_rest);
    wire invalid = !nan && ((a_infinite && b_small) || (a_zero && b_large));
    wire infinite = a_infinite || b_large, zero = a_zero || b_small;

    // 1 is at 127 * 2^23. The integer parts are signed here: -127 to 383.
    wire [32:0] sum   = {2'd0, a_i[30:0]} + ({2'd0, b_i[30:0]} ^ {33{divide_i}}) + {divide_i ? 10'd127 : -10'd127, 22'd0, divide_i};
    wire        by_zero = divide_i && b_zero && !nan && !invalid && !a_infinite;
    wire [38:0] known;
    fp3_cut #(.W(39), .ON(CUT)) u_cut (.clk_i(clk_i),
        .d_i({a_i[31] ^ b_i[31], nan || invalid, invalid, by_zero, infinite, zero, sum}), .q_o(known));
    wire        sign, is_nan, is_invalid, is_by_zero, is_infinite, none;
    wire [9:0]  place;
    wire [22:0] fraction;
    assign {sign, is_nan, is_invalid, is_by_zero, is_infinite, none, place, fraction} = known;
    wire        is_number = !is_nan && !is_infinite && !none;
    wire        under = is_number && (place[9] || ~|{place[8:0], fraction});
    wire        over  = is_number && !place[9] && (place[8] || &place[7:0]);
    assign z_o = is_nan ? BITS_NAN : {sign, is_infinite || over ? {8'd255, 23'd0} : {place[7:0], fraction} & {31{!none && !under}}};
    assign flags_o = {is_invalid, is_by_zero, over, under, over || under};
endmodule
`default_nettype wire
