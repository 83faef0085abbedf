// SPDX-License-Identifier: Apache-2.0
// fp3_fp_exponent: a power of two from its exponent, or an exponent from its number.
//
// Purpose   exp2: 2^n for a's integral part n; results above 2^127 are infinity, from 2^-127 to
//           2^-149 subnormal, below 0. logb: the exponent of |a|; a zero or subnormal number has
//           -infinity, infinity has infinity. No flag: the adder behind fp_value flushes what has
//           to be. Without infinities 2^128 is a number, the largest number stands for infinity,
//           and 128 is the exponent of those from 2^128 on.
// Latency   1, or 2 with CUT: a register behind the exponent as an integer, and one in front of the
//           bits of the result.
// Hazard    For a NaN z_o is meaningless: fp_value passes the NaN on.
//
//     log_i 0, a_i C0A00000 (-5)  ->  z_o 3D000000 (2^-5);   log_i 1, a_i 3D700000  ->  z_o C0A00000 (-5)
`default_nettype none
module fp3_fp_exponent #(
    parameter CUT      = 0,
    parameter FINITE   = 0             // as fp_add's
) (
    input  wire         clk_i,
    input  wire         log_i,         // logb, else exp2
    input  wire [31:16] a_i,           // the lower bits make no difference
    output wire [31:0]  z_o
);
    wire [7:0] e = a_i[30:23];

    // The integer |n|, of exp2 below 256, of logb below 128; whether it is more; and whether it is
    // -n.
    wire [7:0] shifted = {1'b1, a_i[22:16]} >> (~e[2:0] - 3'd1);       // 2^7 at e = 134
    wire       is_less = e < 8'd127;                                   // than 1
    reg  [7:0] n_q;
    reg        log_q, minus_q, over_q;
    always @(posedge clk_i) begin
        log_q <= log_i;
        if (log_i) begin
            n_q     <= {FINITE != 0 && &e, e[7] ? e[6:0] + 7'd1 : ~e[6:0]};     // |e - 127|
            minus_q <= is_less;
            over_q  <= (FINITE == 0 && &e) || e == 8'd0;
        end else begin
            n_q     <= is_less ? 8'd0 : shifted;
            minus_q <= a_i[31];
            over_q  <= e > 8'd134;
        end
    end

    // exp2: exponent, or the one bit of a subnormal number's fraction, which is |n| - 127 places
    // down.
    wire [7:0] power    = minus_q ? {1'b0, ~n_q[6:0]} : {FINITE != 0 && n_q[7], n_q[6:0]} + 8'd127;
    wire       is_low   = minus_q && (over_q || n_q >= 8'd127);
    wire       is_high  = !minus_q && (over_q || (n_q[7] && (FINITE == 0 || |n_q[6:0])));
    wire [7:0] below    = n_q + 8'd1;                                  // 128: 2^-127
    wire       is_tiny  = is_low && !over_q && below[7:5] == 3'b100;

    // logb: the integer as a number.
    wire [2:0] zeros;                                                  // 7: all
    wire       none;
    fp3_lzc #(.N(3)) u_zeros (.d_i({n_q[6:0], 1'b1}), .n_o(zeros), .zero_o(none));
    wire [7:0] exponent = over_q ? 8'd255 : FINITE != 0 && n_q[7] ? 8'd134 : &zeros ? 8'd0 : 8'd133 - {5'd0, zeros};
    wire [5:0] fraction = n_q[5:0] << zeros;

    wire       sign_c, tiny_c, most_c;
    wire [7:0] exponent_c;
    wire [5:0] fraction_c;
    wire [4:0] place_c;
    fp3_cut #(.W(22), .ON(CUT)) u_cut (.clk_i(clk_i),
        .d_i({FINITE != 0 && (log_q ? over_q : is_high), log_q && minus_q, !log_q && is_tiny,
              log_q ? exponent : is_high ? 8'd255 : is_low ? 8'd0 : power, fraction & {6{log_q && !over_q}}, below[4:0]}),
        .q_o({most_c, sign_c, tiny_c, exponent_c, fraction_c, place_c}));
    wire [22:0] last = {22'd0, tiny_c} << (5'd22 - place_c);
    assign z_o = {sign_c, exponent_c, {fraction_c, 17'd0} | last | {23{most_c}}};
    wire unused = none;
endmodule
`default_nettype wire
