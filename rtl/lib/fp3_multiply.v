// SPDX-License-Identifier: Apache-2.0
// fp3_multiply: a product of two numbers of 18 bits, and where it is cut by registers.
//
// Purpose   One multiplier of a device, with the registers that are inside it:
//           rtl/fpga/ecp5/fp3_multiply.v takes its place there.
// Latency   popcount(CUTS) cycles, one operation per cycle. Places: 0 operands, 1 product.
//
//     multiply #(.SIGNED(1), .CUTS(2'b11)) u (.clk_i(clk_i), .a_i(x), .b_i(y), .p_o(p));     // two edges later p == x * y
`default_nettype none
module fp3_multiply #(
    parameter       SIGNED = 0,        // 1: both are in two's complement
    parameter [1:0] CUTS   = 0
) (
    input  wire        clk_i,
    input  wire [17:0] a_i, b_i,
    output wire [35:0] p_o
);
    wire [17:0] a, b;
    wire [35:0] p;
    fp3_cut #(.W(36), .ON(CUTS[0])) u_operands (.clk_i(clk_i), .d_i({a_i, b_i}), .q_o({a, b}));
    generate
        if (SIGNED != 0) begin : g_signed
            assign p = $signed(a) * $signed(b);
        end else begin : g_unsigned
            assign p = a * b;
        end
    endgenerate
    fp3_cut #(.W(36), .ON(CUTS[1])) u_product (.clk_i(clk_i), .d_i(p), .q_o(p_o));
endmodule
`default_nettype wire
