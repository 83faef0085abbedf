// SPDX-License-Identifier: Apache-2.0
// fp3_fp_mul_product: the exact product of two significands, in four tiles of at most 18 bits.
//
// Purpose   The multiplication proper of fp_mul, a module of its own so that a proof can take
//           the product as a free input, and a device can bring its own registered multiplier.
//           The hidden bits a_i[FRAC], b_i[FRAC] come late (they say that an exponent is not
//           zero), so they bypass the multipliers: what they stand for is added afterwards,
//           in an adder that runs beside the tiles.
// Latency   popcount(CUTS) cycles, one operation per cycle. Places: 0 operands, 1 partial
//           products, 2 first sums, 3 product.
//
//     fp_mul_product #(.FRAC(23), .CUTS(4'b1010)) u (.clk_i(clk), .a_i(x), .b_i(y), .p_o(p));
//     // two edges later p == x * y
`default_nettype none
module fp3_fp_mul_product #(
    parameter       FRAC = 23,         // fraction bits, 2 to 30: fp_mul checks it
    parameter [3:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [FRAC:0]     a_i, b_i, // hidden bit and fraction
    output wire [2*FRAC+1:0] p_o
);
    wire [FRAC:0] a, b;
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[0])) u_operands (.clk_i(clk_i), .d_i({a_i, b_i}), .q_o({a, b}));

    // a * b = fraction * fraction + hidden << FRAC
    wire [FRAC+1:0] hidden = {1'b0, a[FRAC] & b[FRAC], b[FRAC-1:0] & {FRAC{a[FRAC]}}}
                           + {2'b00, a[FRAC-1:0] & {FRAC{b[FRAC]}}};
    wire [FRAC+1:0] hidden_c;
    fp3_cut #(.W(FRAC+2), .ON(CUTS[1])) u_hidden (.clk_i(clk_i), .d_i(hidden), .q_o(hidden_c));

    wire [2*FRAC+1:0] p;
    generate
        if (FRAC > 18) begin : g_tiles
            localparam L = 18;         // low part, the width of a multiplier
            localparam H = FRAC - L;   // high part
            wire [2*L-1:0]    ll, ll_c;
            wire [2*H-1:0]    hh, hh_c;
            wire [FRAC-1:0]   lh, hl, lh_c, hl_c;
            assign ll = a[L-1:0] * b[L-1:0];
            assign lh = a[L-1:0] * b[FRAC-1:L];
            assign hl = a[FRAC-1:L] * b[L-1:0];
            assign hh = a[FRAC-1:L] * b[FRAC-1:L];
            fp3_cut #(.W(4*FRAC), .ON(CUTS[1])) u_tiles (
                .clk_i(clk_i), .d_i({hh, ll, lh, hl}), .q_o({hh_c, ll_c, lh_c, hl_c}));

            wire [FRAC:0]     mid = {1'b0, lh_c} + {1'b0, hl_c};                  // << L
            // The spare bit below keeps yosys from merging both additions into a slower one.
            wire              spare_unused;
            wire [FRAC+1:0]   outer;                                                // << FRAC
            assign {outer, spare_unused} = {2'b00, hh_c, ll_c[2*L-1:FRAC-1]} + {hidden_c, 1'b0};
            wire [FRAC:0]     mid_c;
            wire [2*FRAC+1:0] outer_c;
            fp3_cut #(.W(3*FRAC+3), .ON(CUTS[2])) u_sums (
                .clk_i(clk_i), .d_i({mid, outer, ll_c[FRAC-1:0]}), .q_o({mid_c, outer_c}));
            assign p = {outer_c[2*FRAC+1:L-1] + {{H{1'b0}}, 1'b0, mid_c, 1'b0}, outer_c[L-2:0]};
        end else begin : g_one
            wire [2*FRAC-1:0] tile, tile_c;
            wire [2*FRAC+1:0] sum;
            assign tile = a[FRAC-1:0] * b[FRAC-1:0];
            fp3_cut #(.W(2*FRAC), .ON(CUTS[1])) u_tile (.clk_i(clk_i), .d_i(tile), .q_o(tile_c));
            assign sum = {{2'b00, tile_c[2*FRAC-1:FRAC]} + hidden_c, tile_c[FRAC-1:0]};
            fp3_cut #(.W(2*FRAC+2), .ON(CUTS[2])) u_sum (.clk_i(clk_i), .d_i(sum), .q_o(p));
        end
    endgenerate
    fp3_cut #(.W(2*FRAC+2), .ON(CUTS[3])) u_product (.clk_i(clk_i), .d_i(p), .q_o(p_o));
endmodule
`default_nettype wire
