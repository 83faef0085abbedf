// board_bench: bytes to the serial line of fp3_pictures_board; prints those that come back, and the first words of DVI.
//
//     +in=FILE     bytes to send, in hexadecimal digits; behind each end of a packet there is time for an answer
//     b BYTE, w WORDS
`timescale 1ns/1ps
`default_nettype none
module board_bench;
    localparam DIVISOR = 4;
    reg         clk = 1'b0, rst = 1'b1, rxd = 1'b1;
    wire        txd, irq, word;
    wire [29:0] words;
    integer     file, got, i, words_told = 0;
    reg  [7:0]  byte_out, byte_in;
    reg  [1023:0] name;
    fp3_pictures_board #(.DIVISOR(DIVISOR), .ADDRESS_W(18)) u_board (.clk_i(clk), .rst_i(rst), .uart_rxd(rxd), .uart_txd(txd), .irq(irq),
        .word_o(word), .words_o(words));
    always #10 clk = !clk;

    always @(posedge clk)
        if (word && words_told < 3) begin
            words_told = words_told + 1;
            $display("w %b", words);
        end

    always begin : listen
        integer k;
        @(negedge txd) repeat (DIVISOR + DIVISOR / 2) @(negedge clk);
        for (k = 0; k < 8; k = k + 1) begin
            byte_in[k] = txd;
            repeat (DIVISOR) @(negedge clk);
        end
        $display("b %h", byte_in);
    end

    task send(input [9:0] bits);
        integer k;
        for (k = 0; k < 10; k = k + 1) begin
            rxd = bits[k];
            repeat (DIVISOR) @(negedge clk);
        end
    endtask

    initial begin
        repeat (4) @(negedge clk);
        rst = 1'b0;
        repeat (60) @(negedge clk);
        if (!$value$plusargs("in=%s", name)) $fatal(1, "no +in=");
        file = $fopen(name, "r");
        got  = $fscanf(file, "%h", byte_out);
        for (i = 0; got == 1; i = i + 1) begin
            send({1'b1, byte_out, 1'b0});
            // A packet ends: its answer comes before the next one.
            if (byte_out == 8'hc0) repeat (40 * 10 * DIVISOR) @(negedge clk);
            got = $fscanf(file, "%h", byte_out);
        end
        $finish;
    end
endmodule
`default_nettype wire
