// SPDX-License-Identifier: Apache-2.0
// fp3_widen: converts 16 bits of a store to binary32.
//
// Purpose   STORAGE is 1: bfloat16, 2: binary16. Exact.
// Latency   None.
//
//     binary16    narrow_i = 0001     word_o = 33800000    2^-24
`default_nettype none
module fp3_widen #(
    parameter STORAGE = 1
) (
    input  wire [15:0] narrow_i,
    output wire [31:0] word_o
);
    generate
        if (STORAGE == 1) begin : g_bfloat16
            assign word_o = {narrow_i, 16'd0};
        end else begin : g_binary16
            wire [3:0] zeros;                                   // in front of a subnormal number's fraction
            wire       is_none;
            fp3_lzc #(.N(4)) u_zeros (.d_i({narrow_i[9:0], 6'd0}), .n_o(zeros), .zero_o(is_none));
            wire       is_small = narrow_i[14:10] == 5'd0;
            wire       is_out   = narrow_i[14:10] == 5'd31;
            wire [9:0] fraction = is_small ? narrow_i[9:0] << (zeros + 4'd1) : narrow_i[9:0];
            wire [7:0] exponent = is_out ? 8'd255 : is_small ? 8'd112 - {4'd0, zeros} : {3'd0, narrow_i[14:10]} + 8'd112;
            assign word_o = {narrow_i[15], is_small && is_none ? 8'd0 : exponent, fraction, 13'd0};
        end
    endgenerate
endmodule
`default_nettype wire
