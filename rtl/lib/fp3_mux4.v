// SPDX-License-Identifier: Apache-2.0
// fp3_mux4: one of four words.
//
// Purpose   A level of a shifter by two bits, or any choice by two bits on a long path.
// Latency   0. A function: no clock.
// Device    rtl/fpga/ecp5/fp3_mux4.v takes its place on ECP5, where a slice has a multiplexer
//           behind two LUTs of four inputs. The synthesis tools may find it by themselves, or make
//           two LUTs in a row instead.
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
    assign q_o = n_i[1] ? (n_i[0] ? d3_i : d2_i) : (n_i[0] ? d1_i : d0_i);
endmodule
`default_nettype wire
