// SPDX-License-Identifier: Apache-2.0
// fp3_board_clock: a board's clock in simulation: the pin, good at once. The families' own are in rtl/fpga/.
`default_nettype none
module fp3_board_clock #(
    parameter PIN_HZ   = 12000000,
    parameter CLOCK_HZ = 12000000
) (
    input  wire clk_pin,
    output wire clk_o,
    output wire good_o
);
    assign {clk_o, good_o} = {clk_pin, PIN_HZ == CLOCK_HZ};
endmodule
`default_nettype wire
