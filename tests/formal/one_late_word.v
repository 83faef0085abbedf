// one_late_word: stands for lib/fp3_ram_registered.v in proofs. It keeps one word of all, whichever it is; what it gives for
// another one is anything. So what is proved of that word is proved of each.
`default_nettype none
module fp3_ram_registered #(
    parameter ADDR_W = 9,
    parameter W      = 32
) (
    input  wire              clk_i,
    input  wire              write_i,
    input  wire [ADDR_W-1:0] write_addr_i,
    input  wire [W-1:0]      write_value_i,
    input  wire              read_i,
    input  wire [ADDR_W-1:0] read_addr_i,
    output wire [W-1:0]      read_value_o
);
    (* anyconst *) wire [ADDR_W-1:0] which;
    (* anyseq *)   wire [W-1:0]      other;
    reg [W-1:0] kept_q, word_q, read_q;
    reg         it_q, late_q;

    always @(posedge clk_i) begin
        if (write_i && write_addr_i == which) kept_q <= write_value_i;
        if (read_i) {it_q, word_q, late_q, read_q} <= {read_addr_i == which, kept_q, it_q, word_q};
    end
    assign read_value_o = late_q ? read_q : other;
endmodule
`default_nettype wire
