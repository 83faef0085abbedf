// SPDX-License-Identifier: Apache-2.0
// fp3_fp_fma_align: shifts the addend of fp_fma right, from the top of the window to its place
// beside the product.
//
// Purpose   By ones and fours first, while the word is narrow, then by sixteens. lost_o is the OR
//           of the bits that are shifted out below the window.
// Latency   WAIT, and as many cycles as CUTS has ones: behind the shift; lost_o comes later than
//           d_o in that cycle.
//
//     z_i 24'hC00000, n_i 52  ->  d_o 76'hC00000, lost_o 0; n_i 75  ->  d_o 76'h1, lost_o 1       (P = 24, W = 76)
`default_nettype none
module fp3_fp_fma_align #(
    parameter P    = 24,               // bits of a significand
    parameter W    = 76,               // bits of the window
    parameter WAIT = 0,                // registers between fours and sixteens
    parameter CUTS = 0
) (
    input  wire         clk_i,
    input  wire [P-1:0] z_i,
    input  wire [6:0]   n_i,           // all ones: further than the window
    output wire [W-1:0] d_o,
    output wire         lost_o
);
    localparam F = P + 15;             // bits once it is shifted by ones and fours
    wire [P+2:0] ones;
    wire [F-1:0] fours_0, fours;
    wire [2:0]   n;                    // of sixteens
    fp3_mux4 #(.W(P+3)) u_ones (.n_i(n_i[1:0]), .q_o(ones),
        .d0_i({z_i, 3'd0}), .d1_i({1'd0, z_i, 2'd0}), .d2_i({2'd0, z_i, 1'd0}), .d3_i({3'd0, z_i}));
    fp3_mux4 #(.W(F)) u_fours (.n_i(n_i[3:2]), .q_o(fours_0),
        .d0_i({ones, 12'd0}), .d1_i({4'd0, ones, 8'd0}), .d2_i({8'd0, ones, 4'd0}), .d3_i({12'd0, ones}));
    fp3_delay #(.W(F+3), .N(WAIT)) u_wait (.clk_i(clk_i), .rst_i(1'b0), .d_i({fours_0, n_i[6:4]}), .q_o({fours, n}));

    localparam V = W > F ? W : F;
    wire [V-1:0] top   = {fours, {V-F{1'b0}}};
    wire [V-1:0] moved = top >> {n, 4'd0};
    wire         unused = &moved;
    wire [F-1:0] fours_1;
    wire [2:0]   n_1;
    fp3_cut #(.W(W+F+3), .ON(CUTS)) u_shifted (.clk_i(clk_i),
        .d_i({moved[V-1 -: W], fours, n}), .q_o({d_o, fours_1, n_1}));

    // Of each distance, whether a bit leaves.
    wire [7:0] lost;
    genvar k;
    generate
        for (k = 0; k < 8; k = k + 1) begin : g_lost
            localparam N = 16 * k + F - W;
            if (N >= F) begin : g_all
                assign lost[k] = |fours_1;
            end else if (N > 0) begin : g_some
                assign lost[k] = |fours_1[N-1:0];
            end else begin : g_none
                assign lost[k] = 1'b0;
            end
        end
    endgenerate
    assign lost_o = lost[n_1];
endmodule
`default_nettype wire
