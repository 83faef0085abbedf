// SPDX-License-Identifier: Apache-2.0
// fp3_delay_ram: `delay` in a distributed memory.
//
// Purpose   For wide words and long delays: `delay` takes a flip-flop for each bit and cycle, this
//           module one for each bit, and a memory.
// Latency   N cycles, 3 at least. In the first N cycles after a reset q_o is arbitrary.
//
//     delay_ram #(.W(32), .N(17)) u_word (.clk_i(clk_i), .rst_i(rst_i), .d_i(word), .q_o(word_17));
`default_nettype none
module fp3_delay_ram #(
    parameter W = 32,                  // width
    parameter N = 17                   // cycles
) (
    input  wire         clk_i,
    input  wire         rst_i,
    input  wire [W-1:0] d_i,
    output wire [W-1:0] q_o
);
    localparam ADDR_W = $clog2(N - 1);
    localparam [31:0] LAST_32 = N - 2;
    // A word is read in the cycle in which the next one takes its place, N - 1 cycles after it was
    // written.
    reg  [ADDR_W-1:0] at_q;
    reg  [W-1:0]      d_q;
    wire [W-1:0]      d;
    always @(posedge clk_i) begin
        if (rst_i || at_q == LAST_32[ADDR_W-1:0]) at_q <= {ADDR_W{1'b0}};
        else                                      at_q <= at_q + 1'b1;
        d_q <= d;
    end
    fp3_lutram_1r1w #(.ADDR_W(ADDR_W), .W(W)) u_words (.clk_i(clk_i),
        .write_i(1'b1), .write_addr_i(at_q), .write_value_i(d_i), .read_addr_i(at_q), .read_value_o(d));
    assign q_o = d_q;
endmodule
`default_nettype wire
