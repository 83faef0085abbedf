// SPDX-License-Identifier: Apache-2.0
// fp3_ram_1r1w: an inferred block memory with one write port and one synchronous read port.
//
// Purpose   The memory for many words: one form, so that each tool's inference is met once.
// Latency   1: the word addressed while read_i is high is on read_value_o in the next cycle,
//           and stays there until the next read. A read in the cycle of a write to the same word
//           returns the old word.
// Contents  Arbitrary at power-up; there is no reset. Zero with FP3_ZEROS, which is for simulation
//           alone.
`default_nettype none
module fp3_ram_1r1w #(
    parameter ADDR_W = 9,              // 2^ADDR_W words
    parameter W      = 32              // of this width
) (
    input  wire              clk_i,
    input  wire              write_i,
    input  wire [ADDR_W-1:0] write_addr_i,
    input  wire [W-1:0]      write_value_i,
    input  wire              read_i,
    input  wire [ADDR_W-1:0] read_addr_i,
    output wire [W-1:0]      read_value_o
);
    (* ram_style = "block", syn_ramstyle = "block_ram" *) reg [W-1:0] memory [0:(1<<ADDR_W)-1];
    reg [W-1:0] read_q;

`ifdef FP3_ZEROS
    integer i;
    initial for (i = 0; i < (1 << ADDR_W); i = i + 1) memory[i] = {W{1'b0}};
`endif

    always @(posedge clk_i) begin
        if (write_i) memory[write_addr_i] <= write_value_i;
        if (read_i)  read_q <= memory[read_addr_i];
    end
    assign read_value_o = read_q;
endmodule
`default_nettype wire
