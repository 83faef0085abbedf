// SPDX-License-Identifier: Apache-2.0
// fp3_ram_registered: block memory of an ECP5 with the register at its output.
//
// Purpose   Takes the place of rtl/lib/fp3_ram_registered.v: the second register is the one inside
//           the DP16KD, which shows its word 1 ns after the clock (grade 6), the bare memory after
//           5.8.
// Latency   2, as there.
// Size      A block has 512 words of 36 bits, 1024 of 18, .. or 16384 of 1; as many blocks as W
//           asks for. More words than that are two memories of half as many, and a multiplexer
//           behind their registers.
// Contents  Zero at power-up, which is what a DP16KD has by default; there is no reset.
// Hazard    A read of the word that is written in the same cycle gives anything (ram_registered of
//           rtl/lib checks that no module uses it).
//
//     ram_registered #(.ADDR_W(9), .W(32)) u (...);     // one block
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
    genvar i;
    generate
        if (ADDR_W > 14) begin : g_two
            wire [W-1:0] low, high;
            reg  [1:0]   upper_q;
            always @(posedge clk_i) if (read_i) upper_q <= {upper_q[0], read_addr_i[ADDR_W-1]};
            fp3_ram_registered #(.ADDR_W(ADDR_W-1), .W(W)) u_low (.clk_i(clk_i),
                .write_i(write_i && !write_addr_i[ADDR_W-1]), .write_addr_i(write_addr_i[ADDR_W-2:0]),
                .write_value_i(write_value_i),
                .read_i(read_i), .read_addr_i(read_addr_i[ADDR_W-2:0]), .read_value_o(low));
            fp3_ram_registered #(.ADDR_W(ADDR_W-1), .W(W)) u_high (.clk_i(clk_i),
                .write_i(write_i && write_addr_i[ADDR_W-1]), .write_addr_i(write_addr_i[ADDR_W-2:0]),
                .write_value_i(write_value_i),
                .read_i(read_i), .read_addr_i(read_addr_i[ADDR_W-2:0]), .read_value_o(high));
            assign read_value_o = upper_q[1] ? high : low;
        end else begin : g_blocks
            // A block's word, and the address bits below it. Where a word is more than a byte these
            // say at the write port which bytes are written: all.
            localparam WIDE   = ADDR_W <= 9 ? 36 : ADDR_W == 10 ? 18 : ADDR_W == 11 ? 9 : 1 << (14 - ADDR_W);
            localparam BELOW  = ADDR_W <= 9 ? 5 : 14 - ADDR_W;
            localparam BYTES  = ADDR_W <= 9 ? 15 : ADDR_W == 10 ? 3 : 0;
            localparam BLOCKS = (W + WIDE - 1) / WIDE;

            wire [13:0] write_at, read_at;
            assign write_at = (write_addr_i << BELOW) | BYTES;
            assign read_at  = read_addr_i << BELOW;

            wire [BLOCKS*WIDE-1:0] value, word;
            assign value        = {{BLOCKS*WIDE-W{1'b0}}, write_value_i};
            assign read_value_o = word[W-1:0];
            for (i = 0; i < BLOCKS; i = i + 1) begin : g_block
                // Port A writes, port B reads. Words of 36 bits take the data pins of both.
                wire [35:0] in = {{36-WIDE{1'b0}}, value[i*WIDE +: WIDE]};
                wire [17:0] out_a, out_b;
                if (WIDE == 36) begin : g_both
                    assign word[i*WIDE +: WIDE] = {out_b, out_a};
                end else begin : g_one
                    assign word[i*WIDE +: WIDE] = out_b[WIDE-1:0];
                end
                DP16KD #(
                    .DATA_WIDTH_A(WIDE), .DATA_WIDTH_B(WIDE), .REGMODE_A("OUTREG"), .REGMODE_B("OUTREG"),
                    .WRITEMODE_A("NORMAL"), .WRITEMODE_B("NORMAL"), .RESETMODE("SYNC"),
                    .CSDECODE_A("0b000"), .CSDECODE_B("0b000"), .GSR("DISABLED")
                ) u (
                    .CLKA(clk_i), .CEA(write_i), .OCEA(read_i), .WEA(1'b1), .RSTA(1'b0),
                    .CLKB(clk_i), .CEB(read_i), .OCEB(read_i), .WEB(1'b0), .RSTB(1'b0),
                    .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0), .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
                    .ADA0(write_at[0]), .ADA1(write_at[1]), .ADA2(write_at[2]), .ADA3(write_at[3]),
                    .ADA4(write_at[4]), .ADA5(write_at[5]), .ADA6(write_at[6]), .ADA7(write_at[7]),
                    .ADA8(write_at[8]), .ADA9(write_at[9]), .ADA10(write_at[10]), .ADA11(write_at[11]),
                    .ADA12(write_at[12]), .ADA13(write_at[13]),
                    .ADB0(read_at[0]), .ADB1(read_at[1]), .ADB2(read_at[2]), .ADB3(read_at[3]),
                    .ADB4(read_at[4]), .ADB5(read_at[5]), .ADB6(read_at[6]), .ADB7(read_at[7]),
                    .ADB8(read_at[8]), .ADB9(read_at[9]), .ADB10(read_at[10]), .ADB11(read_at[11]),
                    .ADB12(read_at[12]), .ADB13(read_at[13]),
                    .DIA0(in[0]), .DIA1(in[1]), .DIA2(in[2]), .DIA3(in[3]), .DIA4(in[4]), .DIA5(in[5]),
                    .DIA6(in[6]), .DIA7(in[7]), .DIA8(in[8]), .DIA9(in[9]), .DIA10(in[10]), .DIA11(in[11]),
                    .DIA12(in[12]), .DIA13(in[13]), .DIA14(in[14]), .DIA15(in[15]), .DIA16(in[16]),
                    .DIA17(in[17]), .DIB0(in[18]), .DIB1(in[19]), .DIB2(in[20]), .DIB3(in[21]), .DIB4(in[22]),
                    .DIB5(in[23]), .DIB6(in[24]), .DIB7(in[25]), .DIB8(in[26]), .DIB9(in[27]), .DIB10(in[28]),
                    .DIB11(in[29]), .DIB12(in[30]), .DIB13(in[31]), .DIB14(in[32]), .DIB15(in[33]),
                    .DIB16(in[34]), .DIB17(in[35]),
                    .DOA0(out_a[0]), .DOA1(out_a[1]), .DOA2(out_a[2]), .DOA3(out_a[3]), .DOA4(out_a[4]),
                    .DOA5(out_a[5]), .DOA6(out_a[6]), .DOA7(out_a[7]), .DOA8(out_a[8]), .DOA9(out_a[9]),
                    .DOA10(out_a[10]), .DOA11(out_a[11]), .DOA12(out_a[12]), .DOA13(out_a[13]),
                    .DOA14(out_a[14]), .DOA15(out_a[15]), .DOA16(out_a[16]), .DOA17(out_a[17]),
                    .DOB0(out_b[0]), .DOB1(out_b[1]), .DOB2(out_b[2]), .DOB3(out_b[3]), .DOB4(out_b[4]),
                    .DOB5(out_b[5]), .DOB6(out_b[6]), .DOB7(out_b[7]), .DOB8(out_b[8]), .DOB9(out_b[9]),
                    .DOB10(out_b[10]), .DOB11(out_b[11]), .DOB12(out_b[12]), .DOB13(out_b[13]),
                    .DOB14(out_b[14]), .DOB15(out_b[15]), .DOB16(out_b[16]), .DOB17(out_b[17]));
            end
        end
    endgenerate
endmodule
`default_nettype wire
