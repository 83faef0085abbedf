// SPDX-License-Identifier: Apache-2.0
// fp3_board_clock: the processor's clock from a board's oscillator, by the PLL of an iCE40.
//
// Purpose   CLOCK_HZ out of PIN_HZ, exactly; the pin itself where they are the same. good_o is low
//           until the clock can be used; it is not synchronous to it.
// Ranges    Lattice's FPGA-TN-02052: phase detector 10 to 133 MHz, oscillator 533 to 1066 MHz,
//           output 16 to 275 MHz. The pin is not divided before the phase detector.
//
//           phase detector = PIN_HZ;  oscillator = PIN_HZ * FEEDBACK = CLOCK_HZ * 2^OUT
`default_nettype none
module fp3_board_clock #(
    parameter PIN_HZ   = 12000000,
    parameter CLOCK_HZ = 12000000
) (
    input  wire clk_pin,
    output wire clk_o,
    output wire good_o
);
    function integer out_of(input integer unused);        // 0: there is none
        integer i;
        begin
            out_of = 0;
            for (i = 1; i <= 6; i = i + 1)
                if (CLOCK_HZ <= 1066000000 >> i && (CLOCK_HZ << i) >= 533000000 && (CLOCK_HZ << i) % PIN_HZ == 0
                    && (CLOCK_HZ << i) / PIN_HZ <= 128) out_of = i;
        end
    endfunction
    localparam OUT      = out_of(0);
    localparam FEEDBACK = (CLOCK_HZ << OUT) / PIN_HZ;
    // The filter for the phase detector's frequency.
    localparam [2:0] FILTER = PIN_HZ < 17000000 ? 3'd1 : PIN_HZ < 26000000 ? 3'd2 : PIN_HZ < 44000000 ? 3'd3
                            : PIN_HZ < 66000000 ? 3'd4 : PIN_HZ < 101000000 ? 3'd5 : 3'd6;
    localparam [31:0] DIVF = FEEDBACK - 1, DIVQ = OUT;
    generate
        if (CLOCK_HZ == PIN_HZ) begin : g_pin
            assign {clk_o, good_o} = {clk_pin, 1'b1};
        end else if (OUT == 0 || PIN_HZ < 10000000 || PIN_HZ > 133000000) begin : g_none
            the_PLL_of_an_iCE40_cannot_make_CLOCK_HZ_from_PIN_HZ u_error ();
        end else begin : g_pll
            // verilator lint_off PINCONNECTEMPTY
            SB_PLL40_PAD #(
                .FEEDBACK_PATH("SIMPLE"), .DIVR(4'd0), .DIVF(DIVF[6:0]), .DIVQ(DIVQ[2:0]), .FILTER_RANGE(FILTER)
            ) u_pll (
                .PACKAGEPIN(clk_pin), .PLLOUTGLOBAL(clk_o), .PLLOUTCORE(), .LOCK(good_o), .RESETB(1'b1), .BYPASS(1'b0),
                .EXTFEEDBACK(1'b0), .DYNAMICDELAY(8'd0), .LATCHINPUTVALUE(1'b0), .SDO(), .SDI(1'b0), .SCLK(1'b0));
            // verilator lint_on PINCONNECTEMPTY
        end
    endgenerate
endmodule
`default_nettype wire
