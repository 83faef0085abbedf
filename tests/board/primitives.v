// primitives: what the boards' tops use of the devices, as black boxes: Verilator's lint sees ports and widths.
`default_nettype none
// verilator lint_off DECLFILENAME
// verilator lint_off UNDRIVEN
// verilator lint_off UNUSEDPARAM
// verilator lint_off UNUSEDSIGNAL
module EHXPLLL #(
    parameter CLKI_DIV = 1, CLKFB_DIV = 1, FEEDBK_PATH = "CLKOP", CLKOP_ENABLE = "ENABLED", CLKOP_DIV = 8, CLKOP_CPHASE = 0,
              CLKOP_FPHASE = 0, CLKOS_ENABLE = "DISABLED", CLKOS_DIV = 8, CLKOS_CPHASE = 0, CLKOS_FPHASE = 0
) (
`ifdef FP3_PICTURES
    output wire CLKOS,
`endif
    input wire CLKI, CLKFB, RST, STDBY, PLLWAKESYNC, PHASESEL1, PHASESEL0, PHASEDIR, PHASESTEP, PHASELOADREG, ENCLKOP, ENCLKOS,
               ENCLKOS2, ENCLKOS3,
    output wire CLKOP, LOCK
);
endmodule
module ODDRX1F (
    input  wire SCLK, RST, D0, D1,
    output wire Q
);
endmodule
module LUT4 #(
    parameter [15:0] INIT = 0
) (
    input  wire A, B, C, D,
    output wire Z
);
endmodule
module PFUMX (
    input  wire ALUT, BLUT, C0,
    output wire Z
);
endmodule
module SB_PLL40_PAD #(
    parameter       FEEDBACK_PATH = "SIMPLE",
    parameter [3:0] DIVR = 0,
    parameter [6:0] DIVF = 0,
    parameter [2:0] DIVQ = 0, FILTER_RANGE = 0
) (
    input  wire PACKAGEPIN, RESETB, BYPASS, EXTFEEDBACK, LATCHINPUTVALUE, SDI, SCLK,
    input  wire [7:0] DYNAMICDELAY,
    output wire PLLOUTCORE, PLLOUTGLOBAL, LOCK, SDO
);
endmodule
module SB_MAC16 #(
    parameter [0:0] A_REG = 0, B_REG = 0, PIPELINE_16x16_MULT_REG2 = 0,
    parameter [1:0] TOPOUTPUT_SELECT = 0, BOTOUTPUT_SELECT = 0
) (
    input  wire CLK, CE, AHOLD, BHOLD, CHOLD, DHOLD, IRSTTOP, IRSTBOT, ORSTTOP, ORSTBOT, OLOADTOP, OLOADBOT, ADDSUBTOP, ADDSUBBOT,
                OHOLDTOP, OHOLDBOT, CI, ACCUMCI, SIGNEXTIN,
    input  wire [15:0] A, B, C, D,
    output wire [31:0] O,
    output wire CO, ACCUMCO, SIGNEXTOUT
);
endmodule
module rPLL #(
    parameter IDIV_SEL = 0, FBDIV_SEL = 0, ODIV_SEL = 8, DEVICE = ""
) (
    input  wire CLKIN, RESET, RESET_P, CLKFB,
    input  wire [5:0] FBDSEL, IDSEL, ODSEL,
    input  wire [3:0] PSDA, DUTYDA, FDLY,
    output wire CLKOUT, CLKOUTP, CLKOUTD, CLKOUTD3, LOCK
);
endmodule
`default_nettype wire
