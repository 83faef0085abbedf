// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_pack: the end of fp_mul: each bit of the result is 0, 1, or the bit of one of two
// rounded numbers.
//
// Purpose   One LUT of four inputs behind the adders that round, whose flip-flop is in the same
//           slice.
// Latency   0.
//
//     which_i 0, 1, 2, 3  ->  z_o 0, 1, lo_i, hi_i      (INVERT 0)
`default_nettype none
// The hierarchy is kept because a tool would otherwise make what chooses a part of the choice:
// larger LUTs, which reach their flip-flops through the routing.
(* keep_hierarchy *)
module fp3_fp_mul_pack #(
    parameter         W      = 34,     // bits
    parameter [W-1:0] INVERT = 0       // bits that are inverted bits of hi_i or lo_i
) (
    input  wire [2*W-1:0] which_i,
    input  wire [W-1:0]   hi_i,
    input  wire [W-1:0]   lo_i,
    output wire [W-1:0]   z_o
);
    genvar i;
    generate
        for (i = 0; i < W; i = i + 1) begin : g_bit
            assign z_o[i] = which_i[2*i+1] ? (which_i[2*i] ? hi_i[i] : lo_i[i]) ^ INVERT[i] : which_i[2*i];
        end
    endgenerate
endmodule
`default_nettype wire
