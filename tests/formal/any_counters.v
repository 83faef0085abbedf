// any_counters: stands for host/fp3_counters.v in proofs: counts anything.
`default_nettype none
module fp3_counters #(
    parameter N       = 1,
    parameter INDEX_W = 5
) (
    input  wire               clk_i,
    input  wire               clear_i,
    input  wire [N-1:0]       event_i,
    input  wire               read_i,
    input  wire [INDEX_W-1:0] index_i,
    input  wire               high_i,
    output wire [31:0]        value_o
);
    (* anyseq *) wire [31:0] count;
    assign value_o = count;
endmodule
`default_nettype wire
