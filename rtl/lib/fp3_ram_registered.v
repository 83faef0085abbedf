// SPDX-License-Identifier: Apache-2.0
// fp3_ram_registered: an inferred block memory with a register behind its read port.
//
// Purpose   The memory for many words at a high clock: a block memory is slow to show its word,
//           so the word is registered before anything is done with it.
// Latency   2: the word addressed in a cycle is on read_value_o two cycles later. With read_i low
//           both registers keep what they have.
// Contents  Arbitrary at power-up; there is no reset. Zero with FP3_ZEROS, which is for simulation
//           alone.
// Hazard    A read of the word that is written in the same cycle is not used: a device may give
//           anything. Here it gives the old word, and with FP3_CHECK its inverse, so that a use
//           changes results.
//
//     cycle         0     1     2     3
//     write_i       1     0     0     0       address 5, value x
//     read_addr_i   -     5     -     -
//     read_value_o  -     -     -     x
`default_nettype none
module fp3_ram_registered #(
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
    (* ram_style = "block", no_rw_check, ramstyle = "no_rw_check", syn_ramstyle = "block_ram" *) reg [W-1:0] memory [0:(1<<ADDR_W)-1];
    reg [W-1:0] word_q, read_q;

`ifdef FP3_ZEROS
    integer i;
    initial for (i = 0; i < (1 << ADDR_W); i = i + 1) memory[i] = {W{1'b0}};
`endif

`ifdef FP3_CHECK
    wire [W-1:0] word = memory[read_addr_i] ^ {W{write_i && write_addr_i == read_addr_i}};
`else
    wire [W-1:0] word = memory[read_addr_i];
`endif
    always @(posedge clk_i) begin
        if (write_i) memory[write_addr_i] <= write_value_i;
        if (read_i) begin
            word_q <= word;
            read_q <= word_q;
        end
    end
    assign read_value_o = read_q;
endmodule
`default_nettype wire
