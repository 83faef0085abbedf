// SPDX-License-Identifier: Apache-2.0
// fp3_multiply: a product of two numbers of 18 bits, by a multiplier of an ECP5.
//
// Purpose   Takes the place of rtl/lib/fp3_multiply.v: the registers are those inside the
//           MULT18X18D, whose delay without them bounds the clock.
// Latency   As there, popcount(CUTS). Places: 0 operands, 1 product.
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
    localparam IN = CUTS[0] ? "CLK0" : "NONE", OUT = CUTS[1] ? "CLK0" : "NONE";
    localparam IS_SIGNED = SIGNED != 0;
    MULT18X18D #(
        .REG_INPUTA_CLK(IN), .REG_INPUTB_CLK(IN), .REG_PIPELINE_CLK("NONE"), .REG_OUTPUT_CLK(OUT),
        .CLK0_DIV("ENABLED"), .SOURCEB_MODE("B_SHIFT"), .RESETMODE("SYNC"), .GSR("DISABLED")
    ) u (
        .CLK0(clk_i), .CE0(1'b1), .RST0(1'b0),
        .SIGNEDA(IS_SIGNED), .SIGNEDB(IS_SIGNED), .SOURCEA(1'b0), .SOURCEB(1'b0),
        .A0(a_i[0]), .A1(a_i[1]), .A2(a_i[2]), .A3(a_i[3]), .A4(a_i[4]), .A5(a_i[5]),
        .A6(a_i[6]), .A7(a_i[7]), .A8(a_i[8]), .A9(a_i[9]), .A10(a_i[10]), .A11(a_i[11]),
        .A12(a_i[12]), .A13(a_i[13]), .A14(a_i[14]), .A15(a_i[15]), .A16(a_i[16]), .A17(a_i[17]),
        .B0(b_i[0]), .B1(b_i[1]), .B2(b_i[2]), .B3(b_i[3]), .B4(b_i[4]), .B5(b_i[5]),
        .B6(b_i[6]), .B7(b_i[7]), .B8(b_i[8]), .B9(b_i[9]), .B10(b_i[10]), .B11(b_i[11]),
        .B12(b_i[12]), .B13(b_i[13]), .B14(b_i[14]), .B15(b_i[15]), .B16(b_i[16]), .B17(b_i[17]),
        .P0(p_o[0]), .P1(p_o[1]), .P2(p_o[2]), .P3(p_o[3]), .P4(p_o[4]), .P5(p_o[5]),
        .P6(p_o[6]), .P7(p_o[7]), .P8(p_o[8]), .P9(p_o[9]), .P10(p_o[10]), .P11(p_o[11]),
        .P12(p_o[12]), .P13(p_o[13]), .P14(p_o[14]), .P15(p_o[15]), .P16(p_o[16]), .P17(p_o[17]),
        .P18(p_o[18]), .P19(p_o[19]), .P20(p_o[20]), .P21(p_o[21]), .P22(p_o[22]), .P23(p_o[23]),
        .P24(p_o[24]), .P25(p_o[25]), .P26(p_o[26]), .P27(p_o[27]), .P28(p_o[28]), .P29(p_o[29]),
        .P30(p_o[30]), .P31(p_o[31]), .P32(p_o[32]), .P33(p_o[33]), .P34(p_o[34]), .P35(p_o[35]));
endmodule
`default_nettype wire
