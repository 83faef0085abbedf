// ecp5_primitives: what rtl/fpga/ecp5 uses of an ECP5's block memory, multiplier, carry chain and LUTs.
//
// Purpose   Lets a simulator run these files, and what yosys makes of the inferred modules. Written from the vendor's descriptions of the sysDSP and
//           sysMEM blocks: function and registers, no delays; what is not used ends the simulation.
// Hazard    FP3_NETLIST: with the pins that yosys connects, and rtl/fpga/ecp5 does not.
//           A read that meets a write of its word gives x, and so do the bits that nothing drives.
`default_nettype none
module MULT18X18D (
    input wire A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17, B0, B1, B2, B3, B4,
        B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
`ifdef FP3_NETLIST
    input wire C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17,
`endif
    input wire CLK0, CE0, RST0, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
    output wire P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17, P18, P19, P20, P21,
        P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);
    parameter REG_INPUTA_CLK = "NONE", REG_INPUTB_CLK = "NONE", REG_PIPELINE_CLK = "NONE",
              REG_OUTPUT_CLK = "NONE", CLK0_DIV = "ENABLED", SOURCEB_MODE = "B_SHIFT", RESETMODE = "SYNC",
              GSR = "ENABLED";

    wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
    wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
    reg  [17:0] a_q, b_q;
    reg  [35:0] product_q;
    wire [17:0] left = REG_INPUTA_CLK == "CLK0" ? a_q : a, right = REG_INPUTB_CLK == "CLK0" ? b_q : b;
    wire [35:0] product = {{18{SIGNEDA && left[17]}}, left} * {{18{SIGNEDB && right[17]}}, right};
    always @(posedge CLK0)
        if (RST0)     {a_q, b_q, product_q} <= 72'd0;
        else if (CE0) {a_q, b_q, product_q} <= {a, b, product};
    assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17,
        P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0}
        = REG_OUTPUT_CLK == "CLK0" ? product_q : product;

    initial
        if (REG_PIPELINE_CLK != "NONE" || SOURCEB_MODE != "B_SHIFT" || CLK0_DIV != "ENABLED"
                || SIGNEDA !== SIGNEDB || {SOURCEA, SOURCEB} !== 2'd0)
            $fatal(1, "%m: not modelled");
endmodule

// Port A writes and port B reads, both with the same clock. A block has 1024 times 18 bits. The low bits
// of an address choose within such a word; where a port is 18 or 36 bits wide they are, at the writing
// port, one enable for each nine bits. Words of 36 bits take the data pins of both ports: A has the low half.
module DP16KD (
    input wire CLKA, CEA, OCEA, WEA, RSTA, CSA0, CSA1, CSA2,
    input wire CLKB, CEB, OCEB, WEB, RSTB, CSB0, CSB1, CSB2,
    input wire ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
    input wire ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
    input wire DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14,
        DIA15, DIA16, DIA17,
    input wire DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14,
        DIB15, DIB16, DIB17,
    output wire DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14,
        DOA15, DOA16, DOA17,
    output wire DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14,
        DOB15, DOB16, DOB17
);
    parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18, REGMODE_A = "NOREG", REGMODE_B = "NOREG",
              WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL", RESETMODE = "SYNC", GSR = "ENABLED",
              CSDECODE_A = "0b000", CSDECODE_B = "0b000", CLKAMUX = "CLKA", CLKBMUX = "CLKB",
              ASYNC_RESET_RELEASE = "SYNC";
    parameter [319:0]
        INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0, INITVAL_04 = 0, INITVAL_05 = 0, INITVAL_06 = 0, INITVAL_07 = 0,
        INITVAL_08 = 0, INITVAL_09 = 0, INITVAL_0A = 0, INITVAL_0B = 0, INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0, INITVAL_0F = 0,
        INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0, INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0, INITVAL_17 = 0,
        INITVAL_18 = 0, INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0, INITVAL_1C = 0, INITVAL_1D = 0, INITVAL_1E = 0, INITVAL_1F = 0,
        INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0, INITVAL_23 = 0, INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0, INITVAL_27 = 0,
        INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0, INITVAL_2C = 0, INITVAL_2D = 0, INITVAL_2E = 0, INITVAL_2F = 0,
        INITVAL_30 = 0, INITVAL_31 = 0, INITVAL_32 = 0, INITVAL_33 = 0, INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0, INITVAL_37 = 0,
        INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0, INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0, INITVAL_3F = 0;
    localparam WIDE = DATA_WIDTH_A;

    // In nines. Narrower words share one, which then has eight bits in use.
    localparam BYTES = WIDE < 9 ? 1 : WIDE / 9;
    reg  [8:0]  memory [0:2047];
    wire [13:0] write_at = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
    wire [13:0] read_at = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
    wire [35:0] in = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3,
        DIB2, DIB1, DIB0, DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6,
        DIA5, DIA4, DIA3, DIA2, DIA1, DIA0};
    reg  [35:0] word_q, out_q;
    reg  [8:0]  mask;
    reg         enabled;               // a byte is written
    integer     i;

    function [10:0] place(input [13:0] at);
        place = at[13:3] & ~(BYTES - 11'd1);
    endfunction

    // Each parameter has 16 times 18 bits, each of which takes 20.
    task load(input integer row, input [319:0] bits);
        integer k;
        for (k = 0; k < 16; k = k + 1) {memory[32*row + 2*k + 1], memory[32*row + 2*k]} = bits[20*k +: 18];
    endtask
    initial begin
        load(0, INITVAL_00); load(1, INITVAL_01); load(2, INITVAL_02); load(3, INITVAL_03);
        load(4, INITVAL_04); load(5, INITVAL_05); load(6, INITVAL_06); load(7, INITVAL_07);
        load(8, INITVAL_08); load(9, INITVAL_09); load(10, INITVAL_0A); load(11, INITVAL_0B);
        load(12, INITVAL_0C); load(13, INITVAL_0D); load(14, INITVAL_0E); load(15, INITVAL_0F);
        load(16, INITVAL_10); load(17, INITVAL_11); load(18, INITVAL_12); load(19, INITVAL_13);
        load(20, INITVAL_14); load(21, INITVAL_15); load(22, INITVAL_16); load(23, INITVAL_17);
        load(24, INITVAL_18); load(25, INITVAL_19); load(26, INITVAL_1A); load(27, INITVAL_1B);
        load(28, INITVAL_1C); load(29, INITVAL_1D); load(30, INITVAL_1E); load(31, INITVAL_1F);
        load(32, INITVAL_20); load(33, INITVAL_21); load(34, INITVAL_22); load(35, INITVAL_23);
        load(36, INITVAL_24); load(37, INITVAL_25); load(38, INITVAL_26); load(39, INITVAL_27);
        load(40, INITVAL_28); load(41, INITVAL_29); load(42, INITVAL_2A); load(43, INITVAL_2B);
        load(44, INITVAL_2C); load(45, INITVAL_2D); load(46, INITVAL_2E); load(47, INITVAL_2F);
        load(48, INITVAL_30); load(49, INITVAL_31); load(50, INITVAL_32); load(51, INITVAL_33);
        load(52, INITVAL_34); load(53, INITVAL_35); load(54, INITVAL_36); load(55, INITVAL_37);
        load(56, INITVAL_38); load(57, INITVAL_39); load(58, INITVAL_3A); load(59, INITVAL_3B);
        load(60, INITVAL_3C); load(61, INITVAL_3D); load(62, INITVAL_3E); load(63, INITVAL_3F);
    end
    always @(posedge CLKA) begin
        if (CEB && !WEB && {CSB2, CSB1, CSB0} == 3'd0) begin
            word_q <= 36'dx;
            for (i = 0; i < BYTES; i = i + 1)
                word_q[9*i +: 9] <= memory[place(read_at) + i] >> (WIDE < 9 ? read_at[2:0] : 0);
        end
        if (CEA && WEA && {CSA2, CSA1, CSA0} == 3'd0) begin
            mask = WIDE < 9 ? ((1 << WIDE) - 1) << write_at[2:0] : 9'h1ff;
            for (i = 0; i < BYTES; i = i + 1)
                if (WIDE < 18 || write_at[i])
                    memory[place(write_at) + i] <= (memory[place(write_at) + i] & ~mask)
                        | (in[9*i +: 9] << (WIDE < 9 ? write_at[2:0] : 0) & mask);
            enabled = WIDE < 18 || |(write_at & ((1 << BYTES) - 1));
            if (CEB && enabled && place(read_at) == place(write_at) && (WIDE >= 9 || read_at == write_at)) word_q <= 36'dx;
        end
        if (OCEB) out_q <= word_q;
    end
    wire [35:0] out = REGMODE_B == "OUTREG" ? out_q : word_q;
    assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3,
        DOB2, DOB1, DOB0}
        = WIDE == 36 ? out[35:18] : out[17:0];
    assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3,
        DOA2, DOA1, DOA0}
        = WIDE == 36 ? out[17:0] : 18'dx;

    always @(posedge CLKA)
        if (CLKB !== CLKA || (REGMODE_A == "OUTREG" && OCEA !== OCEB)) $fatal(1, "%m: two clocks, or two enables of the output");
    initial
        if (DATA_WIDTH_A != DATA_WIDTH_B || REGMODE_A != REGMODE_B || WRITEMODE_A != "NORMAL" || WEB !== 1'b0
                || RSTA !== 1'b0 || RSTB !== 1'b0 || CSDECODE_A != "0b000" || CSDECODE_B != "0b000")
            $fatal(1, "%m: not modelled");
endmodule

// Two bits of an adder: a LUT of four inputs makes the sum without carry, and where that is 0 its two
// lowest inputs make the carry.
module CCU2C (
    input  wire CIN, A0, B0, C0, D0, A1, B1, C1, D1,
    output wire S0, S1, COUT
);
    parameter [15:0] INIT0 = 16'd0, INIT1 = 16'd0;
    parameter INJECT1_0 = "YES", INJECT1_1 = "YES";

    wire half0 = INIT0[{D0, C0, B0, A0}], half1 = INIT1[{D1, C1, B1, A1}];
    wire carry = half0 ? CIN : INIT0[{2'b00, B0, A0}];
    assign COUT = half1 ? carry : INIT1[{2'b00, B1, A1}];
    assign S0   = half0 ^ CIN;
    assign S1   = half1 ^ carry;

    initial if (INJECT1_0 != "NO" || INJECT1_1 != "NO") $fatal(1, "%m: not modelled");
endmodule

// yosys has models of these.
`ifndef FP3_NETLIST
module LUT4 (
    input  wire A, B, C, D,
    output wire Z
);
    parameter [15:0] INIT = 16'd0;
    assign Z = INIT[{D, C, B, A}];
endmodule

module PFUMX (
    input  wire ALUT, BLUT, C0,
    output wire Z
);
    assign Z = C0 ? ALUT : BLUT;
endmodule
`endif
`default_nettype wire
