// fp_mul_product: the exact product of two significands, by the multipliers of an ECP5.
//
// Purpose   Takes the place of rtl/fp/fp_mul_product.v: the registers at cuts 0 and 1 are those inside
//           the MULT18X18D, whose delay without them bounds the clock.
// Latency   As there, popcount(CUTS). Places: 0 operands, 1 partial products, 2 first sums, 3 product.
//           The hidden bit comes late: without cut 0 the multiplier waits for it.
// Range     FRAC from 18 to 23: with fewer bits there is no high part, with more the rows of logic below are too short.
//           Anything else (a format of 8 bits has FRAC 3 or so) ends elaboration: take the generic module.
// Tiles     A significand is 18 low bits and a high part of at most 6. Three tiles are multipliers,
//           the one of both high parts is logic. The hidden bit is multiplied as any other: the
//           additions that the generic version makes for it are not needed.
//
//     fp_mul_product #(.FRAC(23), .CUTS(4'b0111)) u (.clk_i(clk_i), .a_i(x), .b_i(y), .p_o(p));
//     // three edges later p == x * y
`default_nettype none
module fp_mul_product #(
    parameter       FRAC = 23,         // fraction bits, 18 to 23
    parameter [3:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [FRAC:0]     a_i, b_i, // hidden bit and fraction
    output wire [2*FRAC+1:0] p_o
);
    localparam L = 18;                 // low part, the width of a multiplier
    localparam H = FRAC + 1 - L;       // high part
    generate
        if (FRAC < 18 || FRAC > 23) begin : g_frac
            FRAC_must_be_18_to_23_with_the_multipliers_of_an_ECP5 u_error ();
        end
    endgenerate
    localparam IN = CUTS[0] ? "CLK0" : "NONE", OUT = CUTS[1] ? "CLK0" : "NONE";

    wire [17:0] al = a_i[L-1:0], bl = b_i[L-1:0];
    wire [17:0] ah = {{L-H{1'b0}}, a_i[FRAC:L]}, bh = {{L-H{1'b0}}, b_i[FRAC:L]};
    wire [35:0] ll, lh, hl;            // partial products
    genvar i, k;
    generate
        for (i = 0; i < 3; i = i + 1) begin : g_tile
            wire [17:0] left  = i == 2 ? ah : al;
            wire [17:0] right = i == 1 ? bh : bl;
            wire [35:0] product;
            // CLK0_DIV "ENABLED" is the plain clock: the divided one counts on both edges.
            MULT18X18D #(
                .REG_INPUTA_CLK(IN), .REG_INPUTB_CLK(IN), .REG_PIPELINE_CLK("NONE"), .REG_OUTPUT_CLK(OUT),
                .CLK0_DIV("ENABLED"), .SOURCEB_MODE("B_SHIFT"), .RESETMODE("SYNC"), .GSR("DISABLED")
            ) u (
                .CLK0(clk_i), .CE0(1'b1), .RST0(1'b0),
                .SIGNEDA(1'b0), .SIGNEDB(1'b0), .SOURCEA(1'b0), .SOURCEB(1'b0),
                .A0(left[0]), .A1(left[1]), .A2(left[2]), .A3(left[3]), .A4(left[4]), .A5(left[5]),
                .A6(left[6]), .A7(left[7]), .A8(left[8]), .A9(left[9]), .A10(left[10]), .A11(left[11]),
                .A12(left[12]), .A13(left[13]), .A14(left[14]), .A15(left[15]), .A16(left[16]),
                .A17(left[17]),
                .B0(right[0]), .B1(right[1]), .B2(right[2]), .B3(right[3]), .B4(right[4]), .B5(right[5]),
                .B6(right[6]), .B7(right[7]), .B8(right[8]), .B9(right[9]), .B10(right[10]),
                .B11(right[11]), .B12(right[12]), .B13(right[13]), .B14(right[14]), .B15(right[15]),
                .B16(right[16]), .B17(right[17]),
                .P0(product[0]), .P1(product[1]), .P2(product[2]), .P3(product[3]), .P4(product[4]),
                .P5(product[5]), .P6(product[6]), .P7(product[7]), .P8(product[8]), .P9(product[9]),
                .P10(product[10]), .P11(product[11]), .P12(product[12]), .P13(product[13]),
                .P14(product[14]), .P15(product[15]), .P16(product[16]), .P17(product[17]),
                .P18(product[18]), .P19(product[19]), .P20(product[20]), .P21(product[21]),
                .P22(product[22]), .P23(product[23]), .P24(product[24]), .P25(product[25]),
                .P26(product[26]), .P27(product[27]), .P28(product[28]), .P29(product[29]),
                .P30(product[30]), .P31(product[31]), .P32(product[32]), .P33(product[33]),
                .P34(product[34]), .P35(product[35]));
        end
    endgenerate
    assign ll = g_tile[0].product;
    assign lh = g_tile[1].product;
    assign hl = g_tile[2].product;

    // The high parts, in three rows of two digits of b. A row is a carry chain and nothing else: a
    // LUT of the chain adds a bit of a * b[0] and one of 2 * a * b[1], as A & B ^ C & D; its lowest
    // four bits, A & B, are the carry where that is 0.
    localparam [15:0] ROW = 16'h7888;
    wire [5:0]  a, b;
    wire [7:0]  a1 = {2'b00, a}, a2 = {1'b0, a, 1'b0};
    wire [23:0] rows, rows_c;
    cut #(.W(12), .ON(CUTS[0])) u_high (.clk_i(clk_i), .d_i({ah[5:0], bh[5:0]}), .q_o({a, b}));
    generate
        for (i = 0; i < 3; i = i + 1) begin : g_row
            wire [4:0] carry;
            wire       unused = carry[4];
            assign carry[0] = 1'b0;
            for (k = 0; k < 4; k = k + 1) begin : g_pair
                CCU2C #(.INIT0(ROW), .INIT1(ROW), .INJECT1_0("NO"), .INJECT1_1("NO")) u (
                    .CIN(carry[k]), .COUT(carry[k+1]), .S0(rows[8*i+2*k]), .S1(rows[8*i+2*k+1]),
                    .A0(b[2*i]), .B0(a1[2*k]),   .C0(b[2*i+1]), .D0(a2[2*k]),
                    .A1(b[2*i]), .B1(a1[2*k+1]), .C1(b[2*i+1]), .D1(a2[2*k+1]));
            end
        end
    endgenerate
    cut #(.W(24), .ON(CUTS[1])) u_rows (.clk_i(clk_i), .d_i(rows), .q_o(rows_c));
    wire [11:0] hh = {4'b0000, rows_c[7:0]} + {2'b00, rows_c[15:8], 2'b00} + {rows_c[23:16], 4'b0000};

    wire [FRAC+1:0]   mid = {1'b0, lh[FRAC:0]} + {1'b0, hl[FRAC:0]};        // << L
    wire [FRAC+1:0]   mid_c;
    wire [2*FRAC+1:0] outer_c;
    cut #(.W(3*FRAC+4), .ON(CUTS[2])) u_sums (
        .clk_i(clk_i), .d_i({mid, hh[2*H-1:0], ll}), .q_o({mid_c, outer_c}));

    wire [2*FRAC+1:0] p = {outer_c[2*FRAC+1:L] + {{H-1{1'b0}}, mid_c}, outer_c[L-1:0]};
    wire              unused = &{lh[35:FRAC+1], hl[35:FRAC+1], hh};
    cut #(.W(2*FRAC+2), .ON(CUTS[3])) u_product (.clk_i(clk_i), .d_i(p), .q_o(p_o));
endmodule
`default_nettype wire
