// SPDX-License-Identifier: Apache-2.0
// fp3_ram_forward: a memory whose read sees the write of its own cycle.
//
// Purpose   A read port of the register file, of whichever kind of memory suits its size.
// Latency   1: the word addressed in a cycle is on read_value_o in the next.
// Promise   A word written in the cycle in which it is addressed is read as written.
//
//     cycle         0     1     2
//     write_i       1     0     0        address 5, value x
//     read_addr_i   5     5     -
//     read_value_o  -     x     x
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
    wire forward = write_i && write_addr_i == read_addr_i;
    generate
        if (ADDR_W <= 7) begin : g_few
            wire [W-1:0] word;
            reg  [W-1:0] read_q;
            fp3_lutram_1r1w #(.ADDR_W(ADDR_W), .W(W)) u_ram (.clk_i(clk_i), .write_i(write_i),
                .write_addr_i(write_addr_i), .write_value_i(write_value_i),
                .read_addr_i(read_addr_i), .read_value_o(word));
            always @(posedge clk_i) read_q <= forward ? write_value_i : word;
            assign read_value_o = read_q;
        end else begin : g_many
            wire [W-1:0] word;
            reg  [W-1:0] write_value_q;
            reg          forward_q;
            fp3_ram_1r1w #(.ADDR_W(ADDR_W), .W(W)) u_ram (.clk_i(clk_i), .write_i(write_i),
                .write_addr_i(write_addr_i), .write_value_i(write_value_i),
                .read_i(1'b1), .read_addr_i(read_addr_i), .read_value_o(word));
            always @(posedge clk_i) begin
                forward_q     <= forward;
                write_value_q <= write_value_i;
            end
            assign read_value_o = forward_q ? write_value_q : word;
        end
    endgenerate
endmodule
`default_nettype wire
