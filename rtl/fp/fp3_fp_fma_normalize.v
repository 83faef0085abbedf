// SPDX-License-Identifier: Apache-2.0
// fp3_fp_fma_normalize: shifts the sum of fp_fma left until its first significant bit is at the
// top.
//
// Purpose   By sixteens, fours and ones. Each step looks at the bits in front of it, so that no
//           leading zeros are counted beforehand. limit_i, the exponent, is the longest shift: then
//           the result is subnormal. A negative sum stays as it is: its significant bits are the
//           zeros. Its first significant bit is then at the top or, of a power of two, would be one
//           place above.
// Latency   As many cycles as CUTS has ones. Places: 0 sixteens counted, 1 shifted by them and
//           fours counted, 2 shifted.
//
//     s_i 0..01011, negative_i 0, limit_i 99  ->  d_o 1011 0.., the distance is the zeros in front
`default_nettype none
module fp3_fp_fma_normalize #(
    parameter       W     = 77,        // bits of the sum
    parameter       K     = 26,        // bits kept: a significand and two more
    parameter       PLACE = 10,        // bits of the exponent, at least 8
    parameter       LATE  = 0,         // 1: fours are counted behind place 1
    parameter [2:0] CUTS  = 0
) (
    input  wire             clk_i,
    input  wire [W-1:0]     s_i,
    input  wire             negative_i,
    input  wire [PLACE-1:0] limit_i,   // not negative
    output wire [K-1:0]     d_o,
    output wire             more_o,    // the OR of all bits below
    output wire             negative_o,
    output wire [PLACE-1:0] limit_o,   // limit_i without the fours and ones
    output wire [3:0]       n_o        // these
);
    localparam A = K + 15, B = K + 3;  // bits kept of the sixteens, the fours
    localparam N = (W - 1) / 16;       // sixteens at most
    localparam V = 16 * N + A;

    // Of each four of bits, whether it has no significant one. A block of sixteen is passed if its
    // fours have none, and the exponent allows it.
    localparam G = 4 * N + 3;
    wire [V-1:0]     s = {s_i, {V-W{1'b0}}};
    wire             far  = |limit_i[PLACE-1:7];
    wire [7:0]       room = {8{far}} | ~(8'hff << limit_i[6:4]);   // the exponent allows more than k sixteens
    wire [7:0]       last = (8'd1 << limit_i[6:4]) & {8{!far}};     // or k, and no more
    wire [G-1:0]     flat;
    wire [7:0]       free, pass;       // pass: all blocks so far
    wire [7:0]       below;            // of the bits that are not kept
    genvar k;
    generate
        for (k = 0; k < G; k = k + 1) begin : g_four
            assign flat[k] = s[V-1-4*k -: 4] == {4{negative_i}};
        end
        for (k = 0; k < 8; k = k + 1) begin : g_block
            if (k < N) begin : g_free
                assign free[k] = &flat[4*k +: 4] && room[k];
            end else begin : g_last
                assign free[k] = 1'b0;
            end
            assign pass[k] = &free[k:0];
            if (k <= N && W - A > 16 * k) begin : g_below
                assign below[k] = |s[V-A-16*k-1:V-W];
            end else begin : g_nothing
                assign below[k] = 1'b0;
            end
        end
    endgenerate
    wire [2:0]   a = {pass[3], pass[5] || (pass[1] && !pass[3]),
                      pass[6] || (pass[4] && !pass[5]) || (pass[2] && !pass[3]) || (pass[0] && !pass[1])};
    wire [V-1:0]     s_1;
    wire [PLACE-1:0] limit_1;
    wire [2:0]       a_1;
    wire [G-1:0]     flat_1;
    wire [7:0]       last_1, below_1;
    wire             negative_1;
    fp3_cut #(.W(W+PLACE+G+20), .ON(CUTS[0])) u_counted (.clk_i(clk_i),
        .d_i({s_i, limit_i, flat, last, a, below, negative_i}),
        .q_o({s_1[V-1 -: W], limit_1, flat_1, last_1, a_1, below_1, negative_1}));
    assign s_1[V-W-1:0] = {V-W{1'b0}};

    wire [V-1:0]     moved = s_1 << {a_1, 4'd0};
    wire [A-1:0]     sixteens = moved[V-1 -: A];
    wire [PLACE-1:0] left  = {limit_1[PLACE-1:4] - {{PLACE-7{1'b0}}, a_1}, limit_1[3:0]};
    wire             tight = last_1[a_1];
    wire [G-1:0]     flat4 = flat_1 >> {a_1, 2'd0};
    wire             unused = &{pass[7], moved, s, flat4, room};

    wire [A-1:0]     d_2;
    wire [PLACE-1:0] left_2;
    wire             below_2, negative_2, tight_2;
    fp3_cut #(.W(A+PLACE+3), .ON(CUTS[1])) u_sixteens (.clk_i(clk_i),
        .d_i({sixteens, left, below_1[a_1], negative_1, tight}), .q_o({d_2, left_2, below_2, negative_2, tight_2}));

    wire [2:0] known;
    wire [1:0] limit, b, b_2;
    wire       known_tight;
    generate
        if (LATE != 0) begin : g_late
            fp3_cut #(.W(3), .ON(CUTS[1])) u_flat (.clk_i(clk_i), .d_i(flat4[2:0]), .q_o(known));
            assign {limit, known_tight, b_2} = {left_2[3:2], tight_2, b};
        end else begin : g_early
            assign {known, limit, known_tight} = {flat4[2:0], limit_1[3:2], tight};
            fp3_cut #(.W(2), .ON(CUTS[1])) u_fours (.clk_i(clk_i), .d_i(b), .q_o(b_2));
        end
    endgenerate
    wire pass4_1 = known[0] && (!known_tight || limit != 2'd0);
    wire pass4_2 = pass4_1 && known[1] && (!known_tight || limit[1]);
    wire pass4_3 = pass4_2 && known[2] && (!known_tight || limit == 2'd3);
    assign b = {pass4_2, pass4_3 || (pass4_1 && !pass4_2)};

    wire [B-1:0] fours;
    fp3_mux4 #(.W(B)) u_fours (.n_i(b_2), .q_o(fours),
        .d0_i(d_2[12 +: B]), .d1_i(d_2[8 +: B]), .d2_i(d_2[4 +: B]), .d3_i(d_2[0 +: B]));
    wire below_4 = below_2 || (|d_2[3:0] && b_2 != 2'd3) || (|d_2[7:4] && !b_2[1]) || (|d_2[11:8] && b_2 == 2'd0);
    wire tight_4 = tight_2 && left_2[3:2] == b_2;

    // The first three bits once more, where the tools see how late they are.
    wire [A-1:0] ahead = d_2 << {b_2, 2'd0};
    wire         unused_ahead = &ahead;
    wire [2:0] flat1 = {ahead[A-3] == negative_2, ahead[A-2] == negative_2, ahead[A-1] == negative_2};
    wire pass1_1 = flat1[0] && (!tight_4 || left_2[1:0] != 2'd0);
    wire pass1_2 = pass1_1 && flat1[1] && (!tight_4 || left_2[1]);
    wire pass1_3 = pass1_2 && flat1[2] && (!tight_4 || left_2[1:0] == 2'd3);
    wire [1:0]   c = {pass1_2, pass1_3 || (pass1_1 && !pass1_2)};
    wire [K-1:0] ones;
    fp3_mux4 #(.W(K)) u_ones (.n_i(c), .q_o(ones),
        .d0_i(fours[3 +: K]), .d1_i(fours[2 +: K]), .d2_i(fours[1 +: K]), .d3_i(fours[0 +: K]));
    wire more = below_4 || (fours[0] && !pass1_3) || (fours[1] && !pass1_2) || (fours[2] && !pass1_1);

    fp3_cut #(.W(K+PLACE+6), .ON(CUTS[2])) u_shifted (.clk_i(clk_i),
        .d_i({ones, more, negative_2, left_2, b_2, c}), .q_o({d_o, more_o, negative_o, limit_o, n_o}));
endmodule
`default_nettype wire
