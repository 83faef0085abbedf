// SPDX-License-Identifier: Apache-2.0
// fp3_mix: hashes 32 bits to 32 bits that look random.
//
// Purpose   The hash of draws (sw/machine/storage.h has the same): each bit of the result depends
//           on every bit of the number, and different numbers have different results. Shifts and
//           sums alone: no multiplier. Source: Thomas Wang, "Integer Hash Function", the 32-bit mix
//           function.
// Latency   4.
// Hazard    None: it takes a number in each cycle.
//
//     cycle    0              4
//              number_i = 0   mixed_o = 7bf1e93f
`default_nettype none
module fp3_mix (
    input  wire        clk_i,
    input  wire [31:0] number_i,
    output wire [31:0] mixed_o
);
    reg  [31:0] first_q, second_q, third_q, fourth_q;
    reg  [31:0] second_late_q;         // the third sum and this one make second * 2057
    wire [31:0] first  = first_q ^ (first_q >> 12);
    wire [31:0] second = second_q ^ (second_q >> 4);
    always @(posedge clk_i) begin
        first_q       <= ~number_i + (number_i << 15);
        second_q      <= first + (first << 2);
        third_q       <= second + (second << 3);
        second_late_q <= second;
        fourth_q      <= third_q + (second_late_q << 11);
    end
    assign mixed_o = fourth_q ^ (fourth_q >> 16);
endmodule
`default_nettype wire
