// SPDX-License-Identifier: Apache-2.0
// fp3_board_top: what a board's pins see: clock, power-up reset, fp3_board and a light.
//
// Purpose   The top of every bitstream, and of the simulated board. Boards differ in their entries
//           in boards/boards.toml, in their constraint files, and in the module board_clock of
//           their family.
//
//           clk_pin ─► board_clock ─► reset ─► fp3_board ◄─► uart_rxd, uart_txd
//
// Reset     The flip-flops of ready_q are 0 when the FPGA has been configured; four cycles after
//           the clock is good the reset ends. There is no button: load the bitstream again.
// Hazard    ready_q needs initial values at power-up, which FPGAs have; an ASIC has not.
`default_nettype none
module fp3_board_top #(
    parameter PIN_HZ    = 12000000,    // the oscillator
    parameter CLOCK_HZ  = 12000000,    // what the processor gets
    parameter BAUD      = 115200,
    parameter LIGHT_LOW = 0,           // 1: the light is on when its pin is low
    parameter ADDRESS_W = 18           // see fp3_board
) (
    input  wire clk_pin,
    input  wire uart_rxd,
    output wire uart_txd,
    output wire light                  // on: the clock runs and the reset is over
);
    localparam DIVISOR = (CLOCK_HZ + BAUD / 2) / BAUD;

    wire      clk, good, irq_unused;
    reg [3:0] ready_q;
    wire      rst = !ready_q[3];
    initial   ready_q = 4'd0;
    always @(posedge clk) ready_q <= good ? {ready_q[2:0], 1'b1} : 4'd0;

    fp3_board_clock #(.PIN_HZ(PIN_HZ), .CLOCK_HZ(CLOCK_HZ)) u_clock (.clk_pin(clk_pin), .clk_o(clk), .good_o(good));
    fp3_board #(.DIVISOR(DIVISOR), .ADDRESS_W(ADDRESS_W)) u_board (
        .clk_i(clk), .rst_i(rst), .uart_rxd(uart_rxd), .uart_txd(uart_txd), .irq(irq_unused));
    assign light = rst ^ (LIGHT_LOW == 0);

    generate
        if (DIVISOR < 4) begin : g_divisor
            CLOCK_HZ_must_be_at_least_4_times_BAUD u_error ();
        end
    endgenerate
endmodule
`default_nettype wire
