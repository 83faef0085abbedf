// SPDX-License-Identifier: Apache-2.0
// fp3_pictures_serial: four words of ten bits onto four lines, by the DDR registers of an ECP5.
//
// Purpose   Two bits in each cycle of bit_clk_i, the lowest bit first.
//
//           words ─► words_q ─► shift (bit_clk_i) ─► ODDRX1F ─► lines
//
// Crossing  Words stand for five cycles of bit_clk_i. A toggle that comes with them passes two
//           flip-flops, so it is seen two to three cycles later; words are taken one to two cycles
//           after they came, four cycles after the toggle of the words before was seen. Cycles are
//           counted from the reset, and the first toggle is seen in cycle 0: words begin four cycles
//           of clk_i after it, which are whole words. The toggle sets the counter only where it is off by
//           more than one, so that what a flip-flop decides at an edge does not move the words.
`default_nettype none
module fp3_pictures_serial (
    input  wire        clk_i,
    input  wire        rst_i,
    input  wire        word_i,
    input  wire [39:0] words_i,
    input  wire        bit_clk_i,
    output wire [3:0]  lines_o
);
    reg [39:0] words_q;
    reg        toggle_q;
    always @(posedge clk_i) begin
        toggle_q <= !rst_i && toggle_q != word_i;
        if (word_i) words_q <= words_i;
    end

    reg [1:0]  rst_q;
    reg [2:0]  seen_q, cycle_q;
    wire       comes = seen_q[2] != seen_q[1];
    wire       off   = comes && (cycle_q == 3'd2 || cycle_q == 3'd3 || cycle_q > 3'd4);
    reg [39:0] shift_q;
    genvar i;
    always @(posedge bit_clk_i) begin
        rst_q   <= {rst_q[0], rst_i};
        seen_q  <= {seen_q[1:0], toggle_q};
        cycle_q <= rst_q[1] ? 3'd0 : off ? 3'd1 : cycle_q >= 3'd4 ? 3'd0 : cycle_q + 3'd1;
    end
    generate
        for (i = 0; i < 4; i = i + 1) begin : g_line
            always @(posedge bit_clk_i) shift_q[10*i +: 10] <= cycle_q == 3'd4 ? words_q[10*i +: 10] : {2'b00, shift_q[10*i+2 +: 8]};
            ODDRX1F u_line (.SCLK(bit_clk_i), .RST(1'b0), .D0(shift_q[10*i]), .D1(shift_q[10*i+1]), .Q(lines_o[i]));
        end
    endgenerate
endmodule
`default_nettype wire
