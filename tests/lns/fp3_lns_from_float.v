// SPDX-License-Identifier: Apache-2.0
// fp3_lns_from_float: the logarithmic word of a binary32 number.
//
// Purpose   The exponent, and the logarithm of the significand. Numbers up to 2^-127 become zeros,
//           with UF and NX.
// Latency   6; a new number every cycle.
//
//     a_i 40400000  ->  z_o 404AE00D, which is 2^(128 + 0.58496 - 127), six edges later
`default_nettype none
module fp3_lns_from_float (
    input  wire        clk_i,
    input  wire [31:0] a_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    // Of the subnormal numbers, those above 2^-127 have one zero in front.
    wire        low   = ~|a_i[30:23];
    wire        lost  = low && |a_i[22:0] && (!a_i[22] || ~|a_i[21:0]);
    wire        keep  = &a_i[30:23] || (low && ~|a_i[22:0]);       // infinity, NaN, zero
    wire        nan   = &a_i[30:23] && |a_i[22:0];
    wire [23:0] x     = (low ? {a_i[21:0], 2'b00} : {a_i[22:0], 1'b0}) & {24{!keep && !lost}};

    wire [27:0] log;
    wire [11:0] around;
    reg  [23:0] x_q;
    fp3_lns_curve u_log (.clk_i(clk_i), .x_i(x_q), .value_o(log));
    fp3_delay #(.W(12), .N(6)) u_around (.clk_i(clk_i), .rst_i(1'b0), .d_i({nan, lost, |x, a_i[31:23]}), .q_o(around));
    reg  [27:0] log_q;
    always @(posedge clk_i) begin
        x_q   <= x;
        log_q <= log;
    end
    wire        is_nan, is_lost, is_inexact, sign;
    wire [7:0]  e;
    assign {is_nan, is_lost, is_inexact, sign, e} = around;
    wire [30:0] n = {e, log_q[27:5]} + {30'd0, log_q[4]};
    wire        unused = &log_q[3:0];
    assign z_o     = is_nan ? BITS_NAN : {sign, n};
    assign flags_o = {3'b000, is_lost, is_lost || is_inexact};
endmodule
`default_nettype wire
