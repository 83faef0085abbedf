// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_product: the exact product of two significands, by the multipliers of an iCE40
// UltraPlus.
//
// Purpose   Takes the place of rtl/fp/fp3_fp_mul_product.v: four SB_MAC16, whose own registers are
//           those at cuts 0 and 1, and one addition.
// Latency   As there, popcount(CUTS). Places: 0 operands, 1 partial products, 2 first sums, 3
//           product.
// Range     FRAC from 16 to 23, as there is one low part of 16 bits. Anything else ends
//           elaboration: take the generic module.
// Tiles     A significand is 16 low bits and a high part of at most 8. The hidden bit is multiplied
//           as any other.
// Hazard    nextpnr takes a multiplier for registered on both sides, whatever its parameters say.
//           Without cuts 0 and 1 it does not see the paths through the multipliers.
//
//     fp_mul_product #(.FRAC(23), .CUTS(4'b0011)) u (.clk_i(clk), .a_i(x), .b_i(y), .p_o(p));
//     // two edges later p == x * y
`default_nettype none
module fp3_fp_mul_product #(
    parameter       FRAC = 23,         // fraction bits, 16 to 23
    parameter [3:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [FRAC:0]     a_i, b_i, // hidden bit and fraction
    output wire [2*FRAC+1:0] p_o
);
    localparam L = 16;                 // low part, the width of a multiplier
    localparam H = FRAC + 1 - L;       // high part
    generate
        if (FRAC < 16 || FRAC > 23) begin : g_frac
            FRAC_must_be_16_to_23_with_the_multipliers_of_an_iCE40 u_error ();
        end
    endgenerate

    wire [15:0] al = a_i[L-1:0], bl = b_i[L-1:0];
    wire [15:0] ah = {{L-H{1'b0}}, a_i[FRAC:L]}, bh = {{L-H{1'b0}}, b_i[FRAC:L]};
    genvar i;
    generate
        for (i = 0; i < 4; i = i + 1) begin : g_tile
            wire [31:0] product;
            wire        co_unused, accumco_unused, signextout_unused;
            // Selection 3 shows the product of 16 bits by 16, or its register.
            SB_MAC16 #(
                .A_REG(CUTS[0]), .B_REG(CUTS[0]), .PIPELINE_16x16_MULT_REG2(CUTS[1]),
                .TOPOUTPUT_SELECT(2'd3), .BOTOUTPUT_SELECT(2'd3)
            ) u (
                .CLK(clk_i), .CE(1'b1), .A(i[0] ? ah : al), .B(i[1] ? bh : bl), .C(16'd0), .D(16'd0),
                .AHOLD(1'b0), .BHOLD(1'b0), .CHOLD(1'b0), .DHOLD(1'b0),
                .IRSTTOP(1'b0), .IRSTBOT(1'b0), .ORSTTOP(1'b0), .ORSTBOT(1'b0),
                .OLOADTOP(1'b0), .OLOADBOT(1'b0), .ADDSUBTOP(1'b0), .ADDSUBBOT(1'b0),
                .OHOLDTOP(1'b0), .OHOLDBOT(1'b0), .CI(1'b0), .ACCUMCI(1'b0), .SIGNEXTIN(1'b0),
                .O(product), .CO(co_unused), .ACCUMCO(accumco_unused), .SIGNEXTOUT(signextout_unused));
        end
    endgenerate
    wire [31:0] ll = g_tile[0].product, hl = g_tile[1].product, lh = g_tile[2].product, hh = g_tile[3].product;

    wire [FRAC+1:0]   mid = {1'b0, lh[FRAC:0]} + {1'b0, hl[FRAC:0]};        // << L
    wire [FRAC+1:0]   mid_c;
    wire [2*FRAC+1:0] outer_c;
    fp3_cut #(.W(3*FRAC+4), .ON(CUTS[2])) u_sums (
        .clk_i(clk_i), .d_i({mid, hh[2*H-1:0], ll}), .q_o({mid_c, outer_c}));

    wire [2*FRAC+1:0] p = {outer_c[2*FRAC+1:L] + {{H-1{1'b0}}, mid_c}, outer_c[L-1:0]};
    wire              unused = &{hl[31:FRAC+1], lh[31:FRAC+1], hh[31:2*H]};
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[3])) u_product (.clk_i(clk_i), .d_i(p), .q_o(p_o));
endmodule
`default_nettype wire
