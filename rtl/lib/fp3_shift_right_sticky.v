// SPDX-License-Identifier: Apache-2.0
// fp3_shift_right_sticky: shifts right and says whether a one fell out.
//
// Purpose   Aligns a significand and keeps the bit that rounding needs. sticky_o is about this
//           shift alone: the user ORs the sticky bits of several shifts.
// Latency   0.
//
//     d_i 0110_1000, n_i 2, UNIT 2  ->  q_o 0000_0110, sticky_o 1      (W = 8, N = 2)
`default_nettype none
module fp3_shift_right_sticky #(
    parameter W    = 26,               // width
    parameter N    = 5,                // bits of the amount
    parameter UNIT = 1                 // a power of two: moves by n_i * UNIT
) (
    input  wire [W-1:0] d_i,
    input  wire [N-1:0] n_i,
    output wire [W-1:0] q_o,
    output wire         sticky_o
);
    localparam A = N + $clog2(UNIT);
    wire [A-1:0] n = {{A-N{1'b0}}, n_i} << $clog2(UNIT);
    assign q_o      = d_i >> n;
    assign sticky_o = |(d_i & ~({W{1'b1}} << n));
endmodule
`default_nettype wire
