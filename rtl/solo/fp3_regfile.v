// SPDX-License-Identifier: Apache-2.0
// fp3_regfile: three reads and one write per cycle, of the registers of all contexts.
//
// Purpose   Holds every object's registers and, as one context more, the constants they share.
// Latency   1: the word addressed in a cycle is on value_o in the next.
// Promise   A word written in the cycle in which it is addressed is read as written.
// Contents  Arbitrary at power-up (lutram_1r1w, ram_1r1w); reset leaves them alone.
//
//     cycle      0     1     2
//     write_i    1     0     0        address 5, value x
//     a_addr_i   5     5     -
//     a_value_o  -     x     x
`default_nettype none
module fp3_regfile #(
    parameter ADDR_W = 6               // 2^ADDR_W words
) (
    input  wire              clk_i,
    input  wire              write_i,
    input  wire [ADDR_W-1:0] write_addr_i,
    input  wire [31:0]       write_value_i,
    input  wire [ADDR_W-1:0] a_addr_i,
    input  wire [ADDR_W-1:0] b_addr_i,
    input  wire [ADDR_W-1:0] c_addr_i,
    output wire [31:0]       a_value_o,
    output wire [31:0]       b_value_o,
    output wire [31:0]       c_value_o
);
    // One memory per read port: every FPGA's RAM can do one read and one write.
    fp3_ram_forward #(.ADDR_W(ADDR_W)) u_a (.clk_i(clk_i), .write_i(write_i),
        .write_addr_i(write_addr_i), .write_value_i(write_value_i),
        .read_addr_i(a_addr_i), .read_value_o(a_value_o));
    fp3_ram_forward #(.ADDR_W(ADDR_W)) u_b (.clk_i(clk_i), .write_i(write_i),
        .write_addr_i(write_addr_i), .write_value_i(write_value_i),
        .read_addr_i(b_addr_i), .read_value_o(b_value_o));
    fp3_ram_forward #(.ADDR_W(ADDR_W)) u_c (.clk_i(clk_i), .write_i(write_i),
        .write_addr_i(write_addr_i), .write_value_i(write_value_i),
        .read_addr_i(c_addr_i), .read_value_o(c_value_o));
endmodule
`default_nettype wire
