// SPDX-License-Identifier: Apache-2.0
// fp3_rom_registered: a table in block memory with a register behind it.
//
// Purpose   As ram_registered: a block memory is slow to show its word, so the word is registered
//           before anything is done with it.
// Latency   2: the word addressed in a cycle is on word_o two cycles later.
//
//     rom_registered #(.ADDR_W(9), .W(18), .WORDS(TABLE)) u (.clk_i(clk_i), .at_i(at), .word_o(word));   // TABLE[18*at +: 18]
`default_nettype none
module fp3_rom_registered #(
    parameter                      ADDR_W = 9,         // 2^ADDR_W words
    parameter                      W      = 18,        // of this width
    parameter [(W<<ADDR_W)-1:0]    WORDS  = 0          // the first one lowest
) (
    input  wire              clk_i,
    input  wire [ADDR_W-1:0] at_i,
    output wire [W-1:0]      word_o
);
    (* rom_style = "block", syn_romstyle = "block_rom" *) reg [W-1:0] words [0:(1<<ADDR_W)-1];
    reg [W-1:0] read_q, word_q;
    genvar      i;
    generate
        for (i = 0; i < (1 << ADDR_W); i = i + 1) begin : g_word
            initial words[i] = WORDS[W*i +: W];
        end
    endgenerate
    always @(posedge clk_i) begin
        read_q <= words[at_i];
        word_q <= read_q;
    end
    assign word_o = word_q;
endmodule
`default_nettype wire
