// SPDX-License-Identifier: Apache-2.0
// fp3_narrow: rounds a binary32 number to the 16 bits of a word in the store.
//
// Purpose   STORAGE is 1: bfloat16, 2: binary16. Rounds to nearest, ties to even. With draws_i
//           rounds up at random, with the fraction cut off as probability: the first 16 bits cut
//           off and a random number are added, and the carry rounds. Every NaN becomes the
//           machine's NaN.
// Latency   2. random_i and draws_i come a cycle after word_i.
// Hazard    None: it takes a word in each cycle.
//
//     binary16    word_i      narrow_o over_o
//                 3f800000    3c00     0         1
//                 477ff000    7c00     1         65520: rounds to infinity
//                 33000001    0001     0         a bit more than half of the least number
`default_nettype none
module fp3_narrow #(
    parameter STORAGE = 1
) (
    input  wire        clk_i,
    input  wire [31:0] word_i,
    // A cycle later
    input  wire        draws_i,
    input  wire [15:0] random_i,
    // Two cycles later
    output wire [15:0] narrow_o,
    output wire        over_o          // a finite number became an infinity
);
    wire        is_nan = word_i[30:0] > 31'h7f800000;
    wire        is_out = word_i[30:23] == 8'hff;
    wire [14:0] kept;                  // of the magnitude, before it is rounded
    wire [15:0] rest;                  // the first bits that are cut off ...
    wire        more;                  // ... and the OR of the others
    generate
        if (STORAGE == 1) begin : g_bfloat16
            assign {kept, rest, more} = {word_i[30:0], 1'b0};
        end else begin : g_binary16
            // Below 2^-14 the last place stays where it is, and the fraction moves.
            localparam [7:0] LEAST = 8'd113, ABOVE = 8'd143;            // exponents of 2^-14, 2^16
            wire        is_small = word_i[30:23] < LEAST;
            wire [7:0]  distance = LEAST - word_i[30:23];
            wire [4:0]  shift    = |distance[7:5] ? 5'd31 : distance[4:0];
            wire [4:0]  exponent = {!word_i[27], word_i[26:23]};         // less 112
            wire [26:0] moved;
            wire        beyond;
            fp3_shift_right_sticky #(.W(27), .N(5)) u_moved (.d_i({1'b1, word_i[22:0], 3'b000}), .n_i(shift),
                .q_o(moved), .sticky_o(beyond));
            assign {kept, rest} = word_i[30:23] >= ABOVE ? {15'h7c00, 16'd0}
                                : is_small ? {4'd0, moved} : {exponent, word_i[22:0], 3'b000};
            assign more = is_small && beyond;
        end
    endgenerate

    reg         sign_q, is_nan_q, is_out_q, more_q;
    reg  [30:0] word_q;
    reg  [15:0] narrow_q;
    reg         over_q;
    localparam integer EXPONENT_W = STORAGE == 1 ? 8 : 5;
    localparam [15:0] NAN = STORAGE == 1 ? 16'h7fc0 : 16'h7e00;
    wire [15:0] added = draws_i ? random_i : {1'b0, 15'h7fff} + {15'd0, word_q[16] || more_q};
    wire [30:0] sum   = word_q + {15'd0, added};
    wire unused = &sum[15:0];
    always @(posedge clk_i) begin
        {sign_q, is_nan_q, is_out_q, more_q, word_q} <= {word_i[31], is_nan, is_out, more, kept, rest};
        narrow_q <= is_nan_q ? NAN : {sign_q, sum[30:16]};
        over_q <= !is_out_q && &sum[30 -: EXPONENT_W];
    end
    assign {narrow_o, over_o} = {narrow_q, over_q};
endmodule
`default_nettype wire
