// SPDX-License-Identifier: Apache-2.0
// fp3_ram_forward: a memory whose read sees the write of its own cycle, in the block memory of an
// iCE40.
//
// Purpose   Takes the place of rtl/lib/fp3_ram_forward.v: an iCE40 has no distributed memory, so
//           that few words would become flip-flops. A block memory shows any word in the cycle of
//           its write; then the written value is shown instead.
// Latency   1, as there.
// Contents  Arbitrary at power-up; there is no reset. Zero with FP3_ZEROS, which is for simulation
//           alone.
`default_nettype none
module fp3_ram_forward #(
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
    (* ram_style = "block", no_rw_check *) reg [W-1:0] memory [0:(1<<ADDR_W)-1];
    reg [W-1:0] read_q, write_value_q;
    reg         forward_q;

`ifdef FP3_ZEROS
    integer i;
    initial for (i = 0; i < (1 << ADDR_W); i = i + 1) memory[i] = {W{1'b0}};
`endif

    always @(posedge clk_i) begin
        if (write_i) memory[write_addr_i] <= write_value_i;
        read_q        <= memory[read_addr_i];
        write_value_q <= write_value_i;
        forward_q     <= write_i && write_addr_i == read_addr_i;
    end
    assign read_value_o = forward_q ? write_value_q : read_q;
endmodule
`default_nettype wire
