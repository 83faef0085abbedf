// SPDX-License-Identifier: Apache-2.0
// fp3_pictures_top: what the pins of a board with DVI see: clocks, reset, fp3_pictures_board and a light.
//
// Purpose   The top of bitstreams with a picture, as fp3_board_top is of those without. The modules
//           pictures_clock and pictures_serial are of the device's family.
//
//           clk_pin ─► pictures_clock ─┬─► reset ─► pictures_board ◄─► uart_rxd, uart_txd
//                                      └─► pictures_serial ◄─┘ ──► gpdi_*
//
// Reset     It begins with the loss of the clock and ends four cycles after that is good.
`default_nettype none
module fp3_pictures_top #(
    parameter PIN_HZ    = 25000000,    // the oscillator, and the pixels
    parameter CLOCK_HZ  = 50000000,    // what the processor gets
    parameter BAUD      = 115200,
    parameter LIGHT_LOW = 0,           // 1: the light is on when its pin is low
    parameter ADDRESS_W = 18           // see fp3_pictures_board
) (
    input  wire clk_pin,
    input  wire uart_rxd,
    output wire uart_txd,
    output wire light,                 // on: the clock runs and the reset is over
    output wire gpdi_blue,             // each of them the positive pin of a pair
    output wire gpdi_green,
    output wire gpdi_red,
    output wire gpdi_clock
);
    localparam DIVISOR = (CLOCK_HZ + BAUD / 2) / BAUD;
    localparam TICKS   = CLOCK_HZ / PIN_HZ;

    wire        clk, bit_clk, good, irq_unused, word;
    wire [29:0] words;
    wire [3:0]  lines;
    reg  [3:0]  ready_q;
    wire        rst = !ready_q[3];
    always @(posedge clk or negedge good)
        if (!good) ready_q <= 4'd0;
        else       ready_q <= {ready_q[2:0], 1'b1};

    fp3_pictures_clock #(.PIN_HZ(PIN_HZ), .CLOCK_HZ(CLOCK_HZ)) u_clock (.clk_pin(clk_pin), .clk_o(clk), .bit_clk_o(bit_clk), .good_o(good));
    fp3_pictures_board #(.DIVISOR(DIVISOR), .ADDRESS_W(ADDRESS_W), .TICKS(TICKS)) u_board (
        .clk_i(clk), .rst_i(rst), .uart_rxd(uart_rxd), .uart_txd(uart_txd), .irq(irq_unused), .word_o(word), .words_o(words));
    // The clock's channel goes up and down once in a pixel.
    fp3_pictures_serial u_serial (.clk_i(clk), .rst_i(rst), .word_i(word), .words_i({10'b0000011111, words}), .bit_clk_i(bit_clk), .lines_o(lines));
    assign {gpdi_clock, gpdi_red, gpdi_green, gpdi_blue} = lines;
    assign light = rst ^ (LIGHT_LOW == 0);

    generate
        if (DIVISOR < 4) begin : g_divisor
            CLOCK_HZ_must_be_at_least_4_times_BAUD u_error ();
        end
    endgenerate
endmodule
`default_nettype wire
