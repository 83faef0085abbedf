// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_product: the exact product of two significands, by the multipliers of an ECP5.
//
// Purpose   Takes the place of rtl/fp/fp3_fp_mul_product.v: the registers at cuts 0 and 1 are those
//           inside the MULT18X18D, whose delay without them bounds the clock.
// Latency   As there, popcount(CUTS). Places: 0 operands, 1 partial products, 2 first sums, 3
//           product. The hidden bit comes late: without cut 0 the multiplier waits for it.
// Range     FRAC up to 23: with more bits the rows of logic below are too short, which ends
//           elaboration.
// Tiles     Up to FRAC = 17 one multiplier is enough. Beyond, a significand is 18 low bits and a
//           high part of at most 6: three tiles are multipliers, the one of both high parts is
//           logic. The hidden bit is multiplied as any other: the additions that the generic
//           version makes for it are not needed.
//
//     fp_mul_product #(.FRAC(23), .CUTS(4'b0111)) u (.clk_i(clk_i), .a_i(x), .b_i(y), .p_o(p));
//     // three edges later p == x * y
`default_nettype none
module fp3_fp_mul_product #(
    parameter       FRAC = 23,         // fraction bits, 2 to 23
    parameter [3:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [FRAC:0]     a_i, b_i, // hidden bit and fraction
    output wire [2*FRAC+1:0] p_o
);
    genvar i, k;
    generate
        if (FRAC > 23) begin : g_frac
            FRAC_must_be_at_most_23_with_the_multipliers_of_an_ECP5 u_error ();
        end
    endgenerate

    wire [2*FRAC+1:0] p;
    generate
        if (FRAC < 18) begin : g_one
            wire [35:0] product;
            wire        unused = &product;                 // bits above the product
            fp3_multiply #(.CUTS(CUTS[1:0])) u (.clk_i(clk_i), .a_i({{17-FRAC{1'b0}}, a_i}),
                .b_i({{17-FRAC{1'b0}}, b_i}), .p_o(product));
            fp3_cut #(.W(2*FRAC+2), .ON(CUTS[2])) u_sum (.clk_i(clk_i), .d_i(product[2*FRAC+1:0]), .q_o(p));
        end else begin : g_tiles
            localparam L = 18;             // low part, the width of a multiplier
            localparam H = FRAC + 1 - L;   // high part
            wire [17:0] al = a_i[L-1:0], bl = b_i[L-1:0];
            wire [17:0] ah = {{L-H{1'b0}}, a_i[FRAC:L]}, bh = {{L-H{1'b0}}, b_i[FRAC:L]};
            wire [35:0] ll, lh, hl;            // partial products
            fp3_multiply #(.CUTS(CUTS[1:0])) u_ll (.clk_i(clk_i), .a_i(al), .b_i(bl), .p_o(ll));
            fp3_multiply #(.CUTS(CUTS[1:0])) u_lh (.clk_i(clk_i), .a_i(al), .b_i(bh), .p_o(lh));
            fp3_multiply #(.CUTS(CUTS[1:0])) u_hl (.clk_i(clk_i), .a_i(ah), .b_i(bl), .p_o(hl));

            // The high parts, in three rows of two digits of b. A row is a carry chain and nothing
            // else: a LUT of the chain adds a bit of a * b[0] and one of 2 * a * b[1], as A & B ^ C
            // & D; its lowest four bits, A & B, are the carry where that is 0.
            localparam [15:0] ROW = 16'h7888;
            wire [5:0]  a, b;
            wire [7:0]  a1 = {2'b00, a}, a2 = {1'b0, a, 1'b0};
            wire [23:0] rows, rows_c;
            fp3_cut #(.W(12), .ON(CUTS[0])) u_high (.clk_i(clk_i), .d_i({ah[5:0], bh[5:0]}), .q_o({a, b}));
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
            fp3_cut #(.W(24), .ON(CUTS[1])) u_rows (.clk_i(clk_i), .d_i(rows), .q_o(rows_c));
            wire [11:0] hh = {4'b0000, rows_c[7:0]} + {2'b00, rows_c[15:8], 2'b00} + {rows_c[23:16], 4'b0000};

            wire [FRAC+1:0]   mid = {1'b0, lh[FRAC:0]} + {1'b0, hl[FRAC:0]};        // << L
            wire [FRAC+1:0]   mid_c;
            wire [2*FRAC+1:0] outer_c;
            fp3_cut #(.W(3*FRAC+4), .ON(CUTS[2])) u_sums (
                .clk_i(clk_i), .d_i({mid, hh[2*H-1:0], ll}), .q_o({mid_c, outer_c}));

            assign p = {outer_c[2*FRAC+1:L] + {{H-1{1'b0}}, mid_c}, outer_c[L-1:0]};
            wire unused = &{lh[35:FRAC+1], hl[35:FRAC+1], hh};
        end
    endgenerate
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[3])) u_product (.clk_i(clk_i), .d_i(p), .q_o(p_o));
endmodule
`default_nettype wire
