// SPDX-License-Identifier: Apache-2.0
// fp3_pictures_clock: the clocks of the processor and of the bits of DVI, by the PLL of an ECP5.
//
// Purpose   A pixel has a period of the pin; a bit's clock has five of them, for two bits each, and the
//           processor's clock CLOCK_HZ / PIN_HZ. All edges of the pin's clock are edges of both.
// Ranges    As board_clock: the oscillator of the PLL is 400 to 800 MHz.
`default_nettype none
module fp3_pictures_clock #(
    parameter PIN_HZ   = 25000000,
    parameter CLOCK_HZ = 50000000
) (
    input  wire clk_pin,
    output wire clk_o,
    output wire bit_clk_o,
    output wire good_o
);
    localparam BIT_HZ = 5 * PIN_HZ;
    // The oscillator is a multiple of both clocks: 4 times BIT_HZ, and 20 pins' periods.
    localparam OUT    = 4, SLOW = 20 * PIN_HZ / CLOCK_HZ;
    generate
        if (CLOCK_HZ % PIN_HZ != 0 || 20 * PIN_HZ % CLOCK_HZ != 0 || OUT * BIT_HZ < 400000000 || OUT * BIT_HZ > 800000000) begin : g_none
            the_PLL_of_an_ECP5_cannot_make_CLOCK_HZ_from_PIN_HZ u_error ();
        end else begin : g_pll
            wire clkop, clkos;
            (* ICP_CURRENT = "12", LPF_RESISTOR = "8" *)
            EHXPLLL #(
                .CLKI_DIV(1), .CLKFB_DIV(5), .FEEDBK_PATH("CLKOP"),
                .CLKOP_ENABLE("ENABLED"), .CLKOP_DIV(OUT), .CLKOP_CPHASE(OUT - 1), .CLKOP_FPHASE(0),
                .CLKOS_ENABLE("ENABLED"), .CLKOS_DIV(SLOW), .CLKOS_CPHASE(SLOW - 1), .CLKOS_FPHASE(0)
            ) u_pll (
                .CLKI(clk_pin), .CLKFB(clkop), .CLKOP(clkop), .CLKOS(clkos), .LOCK(good_o),
                .RST(1'b0), .STDBY(1'b0), .PLLWAKESYNC(1'b0), .PHASESEL1(1'b0), .PHASESEL0(1'b0), .PHASEDIR(1'b0),
                .PHASESTEP(1'b0), .PHASELOADREG(1'b0), .ENCLKOP(1'b0), .ENCLKOS(1'b0), .ENCLKOS2(1'b0),
                .ENCLKOS3(1'b0));
            assign {bit_clk_o, clk_o} = {clkop, clkos};
        end
    endgenerate
endmodule
`default_nettype wire
