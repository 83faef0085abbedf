// SPDX-License-Identifier: Apache-2.0
// fp3_lzc: counts the zeros above the highest one.
//
// Purpose   Says how far a sum or a significand must move left to be normal. Of an all-zero input
//           only zero_o is meaningful.
// Latency   0. A tree of halves: the depth grows with N, not with the width.
//
//     d_i 0001_0110  ->  n_o 3, zero_o 0      (N = 3)
`default_nettype none
module fp3_lzc #(
    parameter N = 5                    // bits of the count, >= 1; the width is 2**N
) (
    input  wire [(1<<N)-1:0] d_i,
    output wire [N-1:0]      n_o,
    output wire              zero_o
);
    generate
        if (N == 1) begin : g_pair
            assign n_o    = !d_i[1];
            assign zero_o = !(|d_i);
        end else begin : g_halves
            localparam H = 1 << (N - 1);
            wire [N-2:0] n_high, n_low;
            wire         zero_high, zero_low;
            fp3_lzc #(.N(N-1)) u_high (.d_i(d_i[2*H-1:H]), .n_o(n_high), .zero_o(zero_high));
            fp3_lzc #(.N(N-1)) u_low  (.d_i(d_i[H-1:0]),   .n_o(n_low),  .zero_o(zero_low));
            assign n_o    = {zero_high, zero_high ? n_low : n_high};
            assign zero_o = zero_high && zero_low;
        end
    endgenerate
endmodule
`default_nettype wire
