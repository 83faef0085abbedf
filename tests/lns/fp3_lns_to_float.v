// SPDX-License-Identifier: Apache-2.0
// fp3_lns_to_float: the binary32 number of a logarithmic word.
//
// Purpose   The logarithm's integer part is the exponent, 2^fraction the significand. Below 2^-126
//           the result is subnormal, with UF and NX.
// Latency   5; a new word every cycle.
//
//     a_i 3FC00000  ->  z_o 3FB504F3, which is sqrt(2), five edges later
`default_nettype none
module fp3_lns_to_float (
    input  wire        clk_i,
    input  wire [31:0] a_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    wire        top   = &a_i[30:23];
    wire        nan   = top && |a_i[22:0];
    wire        tiny  = ~|a_i[30:23] && |a_i[22:0];
    wire [22:0] x     = a_i[22:0] & {23{!top}};

    wire [27:0] power;
    wire [11:0] around;
    fp3_lns_curve #(.POWER(1)) u_power (.clk_i(clk_i), .x_i({x, 1'b0}), .value_o(power));
    fp3_delay #(.W(12), .N(5)) u_around (.clk_i(clk_i), .rst_i(1'b0), .d_i({nan, tiny, |x, a_i[31:23]}), .q_o(around));
    reg  [27:0] power_q;
    always @(posedge clk_i) power_q <= power;
    wire        is_nan, is_tiny, is_inexact, sign;
    wire [7:0]  e;
    assign {is_nan, is_tiny, is_inexact, sign, e} = around;
    wire [30:0] high = is_tiny ? {9'd1, power_q[27:6]} : {e, power_q[27:5]};
    wire [30:0] n    = high + {30'd0, is_tiny ? power_q[5] : power_q[4]};
    wire        unused = &power_q[3:0];
    assign z_o     = is_nan ? BITS_NAN : {sign, n};
    assign flags_o = {3'b000, is_tiny, is_inexact};
endmodule
`default_nettype wire
