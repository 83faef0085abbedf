// SPDX-License-Identifier: Apache-2.0
// fp3_lutram_1r1w: an inferred distributed memory with one write port and one combinational read
// port.
//
// Purpose   The memory for few words on a short path: the reader registers the word, so that only a
//           flip-flop's delay is in front of the logic behind.
// Latency   0. A read in the cycle of a write to the same word returns the old word.
// Contents  Arbitrary at power-up; there is no reset. Zero with FP3_ZEROS, which is for simulation
//           alone. Synthesis must not see the loop: not every device can load such a memory, and
//           some tools stop at 5,000 words.
`default_nettype none
// The hierarchy is kept because Yosys would otherwise move the reader's register in front of the
// memory, to the address, and the memory into the path behind it.
(* keep_hierarchy *)
module fp3_lutram_1r1w #(
    parameter ADDR_W = 6,              // 2^ADDR_W words
    parameter W      = 32              // of this width
) (
    input  wire              clk_i,
    input  wire              write_i,
    input  wire [ADDR_W-1:0] write_addr_i,
    input  wire [W-1:0]      write_value_i,
    input  wire [ADDR_W-1:0] read_addr_i,
    output wire [W-1:0]      read_value_o
);
    (* ram_style = "distributed", ramstyle = "MLAB", syn_ramstyle = "distributed" *) reg [W-1:0] memory [0:(1<<ADDR_W)-1];

`ifdef FP3_ZEROS
    integer i;
    initial for (i = 0; i < (1 << ADDR_W); i = i + 1) memory[i] = {W{1'b0}};
`endif

    always @(posedge clk_i) if (write_i) memory[write_addr_i] <= write_value_i;
    assign read_value_o = memory[read_addr_i];
endmodule
`default_nettype wire
