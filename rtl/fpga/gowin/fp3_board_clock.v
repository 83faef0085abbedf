// SPDX-License-Identifier: Apache-2.0
// fp3_board_clock: the processor's clock from a board's oscillator, by the PLL of a Gowin GW2A.
//
// Purpose   CLOCK_HZ out of PIN_HZ, exactly; the pin itself where they are the same. good_o is low
//           until the clock can be used; it is not synchronous to it.
// Ranges    Gowin's DS226, grade C8/I7: phase detector 3 to 500 MHz, oscillator 500 to 1250 MHz,
//           output 3.90625 to 625 MHz; divisors 1 to 64, of the output 2, 4, 8, 16, 32, .., 128.
//
//           phase detector = PIN_HZ / IN = CLOCK_HZ / FEEDBACK;  oscillator = CLOCK_HZ * OUT
`default_nettype none
module fp3_board_clock #(
    parameter PIN_HZ   = 27000000,
    parameter CLOCK_HZ = 27000000
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
            for (i = PIN_HZ / 3000000; i >= 1; i = i - 1)
                if (PIN_HZ % i == 0 && CLOCK_HZ % (PIN_HZ / i) == 0 && CLOCK_HZ / (PIN_HZ / i) <= 64) in_of = i;
        end
    endfunction
    function integer out_of(input integer unused);
        integer i;
        begin
            out_of = 0;
            for (i = 2; i <= 128; i = 2 * i)
                if (CLOCK_HZ <= 1250000000 / i && CLOCK_HZ * i >= 500000000) out_of = i;
        end
    endfunction
    localparam IN       = in_of(0);
    localparam FEEDBACK = IN == 0 ? 1 : CLOCK_HZ / (PIN_HZ / (IN == 0 ? 1 : IN));
    localparam OUT      = out_of(0);
    generate
        if (CLOCK_HZ == PIN_HZ) begin : g_pin
            assign {clk_o, good_o} = {clk_pin, 1'b1};
        end else if (IN == 0 || OUT == 0) begin : g_none
            the_PLL_of_a_GW2A_cannot_make_CLOCK_HZ_from_PIN_HZ u_error ();
        end else begin : g_pll
            // verilator lint_off PINCONNECTEMPTY
            rPLL #(
                .IDIV_SEL(IN - 1), .FBDIV_SEL(FEEDBACK - 1), .ODIV_SEL(OUT), .DEVICE("GW2A-18C")
            ) u_pll (
                .CLKIN(clk_pin), .CLKOUT(clk_o), .LOCK(good_o), .CLKOUTP(), .CLKOUTD(), .CLKOUTD3(),
                .RESET(1'b0), .RESET_P(1'b0), .CLKFB(1'b0), .FBDSEL(6'd0), .IDSEL(6'd0), .ODSEL(6'd0),
                .PSDA(4'd0), .DUTYDA(4'd0), .FDLY(4'd0));
            // verilator lint_on PINCONNECTEMPTY
        end
    endgenerate
endmodule
`default_nettype wire
