// SPDX-License-Identifier: Apache-2.0
// fp3_rom_registered: a table in the block memory of an ECP5, with the register at its output.
//
// Purpose   Takes the place of rtl/lib/fp3_rom_registered.v: the second register is the one inside
//           the DP16KD, which shows its word 1 ns after the clock (grade 6), the bare memory after
//           5.8.
// Latency   2, as there.
// Size      A block has 512 words of 36 bits or 1024 of 18; as many blocks as W asks for.
//
//     rom_registered #(.ADDR_W(9), .W(53), .WORDS(TABLE)) u (...);     // two blocks
`default_nettype none
module fp3_rom_registered #(
    parameter                      ADDR_W = 9,         // 2^ADDR_W words, 9 or 10
    parameter                      W      = 18,        // of this width
    parameter [(W<<ADDR_W)-1:0]    WORDS  = 0          // the first one lowest
) (
    input  wire              clk_i,
    input  wire [ADDR_W-1:0] at_i,
    output wire [W-1:0]      word_o
);
    localparam WIDE   = ADDR_W == 9 ? 36 : 18;
    localparam HALVES = WIDE / 18;
    localparam BLOCKS = (W + WIDE - 1) / WIDE;
    generate
        if (ADDR_W < 9 || ADDR_W > 10) begin : g_size
            ADDR_W_must_be_9_or_10_with_the_memories_of_an_ECP5 u_error ();
        end
    endgenerate

    // A block is filled by 64 parameters: 16 times 18 bits, each of which takes 20. Half a word of
    // 36 bits follows the other.
    localparam ROW = W * 16 / HALVES;
    function [319:0] part(input integer block, input [ROW-1:0] words);
        integer      k;
        reg [W+71:0] word;             // more than is shifted out: 0 beyond the table's word
        begin
            part = 320'd0;
            for (k = 0; k < 16; k = k + 1) begin
                word = words[W*(k/HALVES) +: W];
                word = word >> (WIDE * block + 18 * (k % HALVES));
                part[20*k +: 18] = word[17:0];
            end
        end
    endfunction

    wire [13:0]            read_at = {at_i, {14-ADDR_W{1'b0}}};
    wire [BLOCKS*WIDE-1:0] word;
    assign word_o = word[W-1:0];
    genvar i;
    generate
        for (i = 0; i < BLOCKS; i = i + 1) begin : g_block
            // Port B reads. Words of 36 bits take the data pins of both ports.
            wire [17:0] out_a, out_b;
            if (WIDE == 36) begin : g_both
                assign word[i*WIDE +: WIDE] = {out_b, out_a};
            end else begin : g_one
                assign word[i*WIDE +: WIDE] = out_b;
            end
            DP16KD #(
                .DATA_WIDTH_A(WIDE), .DATA_WIDTH_B(WIDE), .REGMODE_A("OUTREG"), .REGMODE_B("OUTREG"),
                .WRITEMODE_A("NORMAL"), .WRITEMODE_B("NORMAL"), .RESETMODE("SYNC"),
                .CSDECODE_A("0b000"), .CSDECODE_B("0b000"), .GSR("DISABLED"),
                .INITVAL_00(part(i, WORDS[ROW*0 +: ROW])), .INITVAL_01(part(i, WORDS[ROW*1 +: ROW])),
                .INITVAL_02(part(i, WORDS[ROW*2 +: ROW])), .INITVAL_03(part(i, WORDS[ROW*3 +: ROW])),
                .INITVAL_04(part(i, WORDS[ROW*4 +: ROW])), .INITVAL_05(part(i, WORDS[ROW*5 +: ROW])),
                .INITVAL_06(part(i, WORDS[ROW*6 +: ROW])), .INITVAL_07(part(i, WORDS[ROW*7 +: ROW])),
                .INITVAL_08(part(i, WORDS[ROW*8 +: ROW])), .INITVAL_09(part(i, WORDS[ROW*9 +: ROW])),
                .INITVAL_0A(part(i, WORDS[ROW*10 +: ROW])), .INITVAL_0B(part(i, WORDS[ROW*11 +: ROW])),
                .INITVAL_0C(part(i, WORDS[ROW*12 +: ROW])), .INITVAL_0D(part(i, WORDS[ROW*13 +: ROW])),
                .INITVAL_0E(part(i, WORDS[ROW*14 +: ROW])), .INITVAL_0F(part(i, WORDS[ROW*15 +: ROW])),
                .INITVAL_10(part(i, WORDS[ROW*16 +: ROW])), .INITVAL_11(part(i, WORDS[ROW*17 +: ROW])),
                .INITVAL_12(part(i, WORDS[ROW*18 +: ROW])), .INITVAL_13(part(i, WORDS[ROW*19 +: ROW])),
                .INITVAL_14(part(i, WORDS[ROW*20 +: ROW])), .INITVAL_15(part(i, WORDS[ROW*21 +: ROW])),
                .INITVAL_16(part(i, WORDS[ROW*22 +: ROW])), .INITVAL_17(part(i, WORDS[ROW*23 +: ROW])),
                .INITVAL_18(part(i, WORDS[ROW*24 +: ROW])), .INITVAL_19(part(i, WORDS[ROW*25 +: ROW])),
                .INITVAL_1A(part(i, WORDS[ROW*26 +: ROW])), .INITVAL_1B(part(i, WORDS[ROW*27 +: ROW])),
                .INITVAL_1C(part(i, WORDS[ROW*28 +: ROW])), .INITVAL_1D(part(i, WORDS[ROW*29 +: ROW])),
                .INITVAL_1E(part(i, WORDS[ROW*30 +: ROW])), .INITVAL_1F(part(i, WORDS[ROW*31 +: ROW])),
                .INITVAL_20(part(i, WORDS[ROW*32 +: ROW])), .INITVAL_21(part(i, WORDS[ROW*33 +: ROW])),
                .INITVAL_22(part(i, WORDS[ROW*34 +: ROW])), .INITVAL_23(part(i, WORDS[ROW*35 +: ROW])),
                .INITVAL_24(part(i, WORDS[ROW*36 +: ROW])), .INITVAL_25(part(i, WORDS[ROW*37 +: ROW])),
                .INITVAL_26(part(i, WORDS[ROW*38 +: ROW])), .INITVAL_27(part(i, WORDS[ROW*39 +: ROW])),
                .INITVAL_28(part(i, WORDS[ROW*40 +: ROW])), .INITVAL_29(part(i, WORDS[ROW*41 +: ROW])),
                .INITVAL_2A(part(i, WORDS[ROW*42 +: ROW])), .INITVAL_2B(part(i, WORDS[ROW*43 +: ROW])),
                .INITVAL_2C(part(i, WORDS[ROW*44 +: ROW])), .INITVAL_2D(part(i, WORDS[ROW*45 +: ROW])),
                .INITVAL_2E(part(i, WORDS[ROW*46 +: ROW])), .INITVAL_2F(part(i, WORDS[ROW*47 +: ROW])),
                .INITVAL_30(part(i, WORDS[ROW*48 +: ROW])), .INITVAL_31(part(i, WORDS[ROW*49 +: ROW])),
                .INITVAL_32(part(i, WORDS[ROW*50 +: ROW])), .INITVAL_33(part(i, WORDS[ROW*51 +: ROW])),
                .INITVAL_34(part(i, WORDS[ROW*52 +: ROW])), .INITVAL_35(part(i, WORDS[ROW*53 +: ROW])),
                .INITVAL_36(part(i, WORDS[ROW*54 +: ROW])), .INITVAL_37(part(i, WORDS[ROW*55 +: ROW])),
                .INITVAL_38(part(i, WORDS[ROW*56 +: ROW])), .INITVAL_39(part(i, WORDS[ROW*57 +: ROW])),
                .INITVAL_3A(part(i, WORDS[ROW*58 +: ROW])), .INITVAL_3B(part(i, WORDS[ROW*59 +: ROW])),
                .INITVAL_3C(part(i, WORDS[ROW*60 +: ROW])), .INITVAL_3D(part(i, WORDS[ROW*61 +: ROW])),
                .INITVAL_3E(part(i, WORDS[ROW*62 +: ROW])), .INITVAL_3F(part(i, WORDS[ROW*63 +: ROW]))
            ) u (
                .CLKA(clk_i), .CEA(1'b0), .OCEA(1'b1), .WEA(1'b0), .RSTA(1'b0),
                .CLKB(clk_i), .CEB(1'b1), .OCEB(1'b1), .WEB(1'b0), .RSTB(1'b0),
                .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0), .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
                .ADA0(1'b0), .ADA1(1'b0), .ADA2(1'b0), .ADA3(1'b0), .ADA4(1'b0), .ADA5(1'b0), .ADA6(1'b0), .ADA7(1'b0),
                .ADA8(1'b0), .ADA9(1'b0), .ADA10(1'b0), .ADA11(1'b0), .ADA12(1'b0), .ADA13(1'b0),
                .ADB0(read_at[0]), .ADB1(read_at[1]), .ADB2(read_at[2]), .ADB3(read_at[3]), .ADB4(read_at[4]),
                .ADB5(read_at[5]),
                .ADB6(read_at[6]), .ADB7(read_at[7]), .ADB8(read_at[8]), .ADB9(read_at[9]), .ADB10(read_at[10]),
                .ADB11(read_at[11]),
                .ADB12(read_at[12]), .ADB13(read_at[13]),
                .DIA0(1'b0), .DIA1(1'b0), .DIA2(1'b0), .DIA3(1'b0), .DIA4(1'b0), .DIA5(1'b0), .DIA6(1'b0), .DIA7(1'b0),
                .DIA8(1'b0), .DIA9(1'b0), .DIA10(1'b0), .DIA11(1'b0), .DIA12(1'b0), .DIA13(1'b0), .DIA14(1'b0),
                .DIA15(1'b0),
                .DIA16(1'b0), .DIA17(1'b0),
                .DIB0(1'b0), .DIB1(1'b0), .DIB2(1'b0), .DIB3(1'b0), .DIB4(1'b0), .DIB5(1'b0), .DIB6(1'b0), .DIB7(1'b0),
                .DIB8(1'b0), .DIB9(1'b0), .DIB10(1'b0), .DIB11(1'b0), .DIB12(1'b0), .DIB13(1'b0), .DIB14(1'b0),
                .DIB15(1'b0),
                .DIB16(1'b0), .DIB17(1'b0),
                .DOA0(out_a[0]), .DOA1(out_a[1]), .DOA2(out_a[2]), .DOA3(out_a[3]), .DOA4(out_a[4]), .DOA5(out_a[5]),
                .DOA6(out_a[6]), .DOA7(out_a[7]), .DOA8(out_a[8]), .DOA9(out_a[9]), .DOA10(out_a[10]),
                .DOA11(out_a[11]),
                .DOA12(out_a[12]), .DOA13(out_a[13]), .DOA14(out_a[14]), .DOA15(out_a[15]), .DOA16(out_a[16]),
                .DOA17(out_a[17]),
                .DOB0(out_b[0]), .DOB1(out_b[1]), .DOB2(out_b[2]), .DOB3(out_b[3]), .DOB4(out_b[4]), .DOB5(out_b[5]),
                .DOB6(out_b[6]), .DOB7(out_b[7]), .DOB8(out_b[8]), .DOB9(out_b[9]), .DOB10(out_b[10]),
                .DOB11(out_b[11]),
                .DOB12(out_b[12]), .DOB13(out_b[13]), .DOB14(out_b[14]), .DOB15(out_b[15]), .DOB16(out_b[16]),
                .DOB17(out_b[17]));
        end
    endgenerate
endmodule
`default_nettype wire
