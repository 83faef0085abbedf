// SPDX-License-Identifier: Apache-2.0
// fp3_board_clock: the processor's clock from a board's oscillator, by the PLL of an ECP5.
//
// Purpose   CLOCK_HZ out of PIN_HZ, exactly; the pin itself where they are the same. good_o is low
//           until the clock can be used; it is not synchronous to it.
// Ranges    Lattice's data sheet FPGA-DS-02012: phase detector 3.125 to 400 MHz, oscillator 400 to
//           800 MHz, divisors 1 to 128 (feedback 1 to 80).
//
//           phase detector = PIN_HZ / IN = CLOCK_HZ / FEEDBACK;  oscillator = CLOCK_HZ * OUT
`default_nettype none
module fp3_board_clock #(
    parameter PIN_HZ   = 25000000,
    parameter CLOCK_HZ = 25000000
) (
    input  wire clk_pin,
    output wire clk_o,
    output wire good_o
);
    // The least divisor of the input that gives a whole one of the feedback; 0: there is none.
    function integer in_of(input integer unused);
        integer i;
        begin
            in_of = 0;
            for (i = PIN_HZ / 3125000; i >= 1; i = i - 1)
                if (PIN_HZ % i == 0 && CLOCK_HZ % (PIN_HZ / i) == 0 && CLOCK_HZ / (PIN_HZ / i) <= 80) in_of = i;
        end
    endfunction
    localparam IN       = in_of(0);
    localparam FEEDBACK = IN == 0 ? 1 : CLOCK_HZ / (PIN_HZ / (IN == 0 ? 1 : IN));
    // The oscillator near the middle of its range, 600 MHz.
    localparam OUT      = (CLOCK_HZ > 300000000 ? 800000000 : 600000000) / CLOCK_HZ;
    generate
        if (CLOCK_HZ == PIN_HZ) begin : g_pin
            assign {clk_o, good_o} = {clk_pin, 1'b1};
        end else if (IN == 0 || OUT < 1 || OUT > 128 || CLOCK_HZ * OUT < 400000000) begin : g_none
            the_PLL_of_an_ECP5_cannot_make_CLOCK_HZ_from_PIN_HZ u_error ();
        end else begin : g_pll
            wire clkop;
            (* ICP_CURRENT = "12", LPF_RESISTOR = "8" *)
            EHXPLLL #(
                .CLKI_DIV(IN), .CLKFB_DIV(FEEDBACK), .FEEDBK_PATH("CLKOP"),
                .CLKOP_ENABLE("ENABLED"), .CLKOP_DIV(OUT), .CLKOP_CPHASE(OUT - 1), .CLKOP_FPHASE(0)
            ) u_pll (
                .CLKI(clk_pin), .CLKFB(clkop), .CLKOP(clkop), .LOCK(good_o),
                .RST(1'b0), .STDBY(1'b0), .PLLWAKESYNC(1'b0), .PHASESEL1(1'b0), .PHASESEL0(1'b0), .PHASEDIR(1'b0),
                .PHASESTEP(1'b0), .PHASELOADREG(1'b0), .ENCLKOP(1'b0), .ENCLKOS(1'b0), .ENCLKOS2(1'b0),
                .ENCLKOS3(1'b0));
            assign clk_o = clkop;
        end
    endgenerate
endmodule
`default_nettype wire
