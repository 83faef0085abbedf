// SPDX-License-Identifier: Apache-2.0
// fp3_mux4: one of four words, by the multiplexers in an ECP5's slices.
//
// Purpose   Takes the place of rtl/lib/fp3_mux4.v: each bit is one slice, two LUTs and the PFUMX
//           behind them. n_i[1], which may be late, passes no LUT, and nothing else becomes a part
//           of these LUTs.
// Latency   0, as there.
//
//     mux4 #(.W(32)) u (.n_i(by), .d0_i(x), .d1_i(x >> 1), .d2_i(x >> 2), .d3_i(x >> 3), .q_o(y));   // y = x >> by
`default_nettype none
module fp3_mux4 #(
    parameter W = 1                    // width
) (
    input  wire [1:0]   n_i,           // which
    input  wire [W-1:0] d0_i, d1_i, d2_i, d3_i,
    output wire [W-1:0] q_o
);
    localparam [15:0] CHOOSE = 16'hcaca;           // C ? B : A
    genvar i;
    generate
        for (i = 0; i < W; i = i + 1) begin : g_bit
            wire high, low;
            LUT4 #(.INIT(CHOOSE)) u_high (.A(d2_i[i]), .B(d3_i[i]), .C(n_i[0]), .D(1'b0), .Z(high));
            LUT4 #(.INIT(CHOOSE)) u_low  (.A(d0_i[i]), .B(d1_i[i]), .C(n_i[0]), .D(1'b0), .Z(low));
            PFUMX u_choose (.ALUT(high), .BLUT(low), .C0(n_i[1]), .Z(q_o[i]));
        end
    endgenerate
endmodule
`default_nettype wire
