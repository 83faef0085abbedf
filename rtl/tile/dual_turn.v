// dual_turn: the instruction that is under way to one unit, one context in each cycle.
//
// Purpose   Where sums and products have a turn each: the sweep of one of them, and what the lanes are told
//           of it. Nothing stops a sweep.
// Latency   The first context is said (valid_o) two cycles after load_i, its row three.
// Hazard    load_i only while busy_o is low or over_o high. base_i is the row of context 0.
//
//     cycle     0     1      2        3
//     load_i    1     0      0        0        mask 0011, base 48
//     busy_o    0     1      1        0
//     over_o    0     0      1        0
//     valid_o   0     0      1        1        context_o 0, 1; row_o 48 in cycle 3, 49 in cycle 4
`default_nettype none
module dual_turn #(
    parameter WHAT_W  = 1,
    parameter COUNT_W = 6,
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire                 load_i,
    input  wire [CONTEXTS-1:0]  mask_i,
    input  wire [COUNT_W-1:0]   count_i,
    input  wire [ROW_W-1:0]     base_i,
    input  wire [WHAT_W-1:0]    what_i,
    output wire                 busy_o,
    output wire                 over_o,         // the last context issues
    output wire                 valid_o,
    output wire [CONTEXT_W-1:0] context_o,
    output wire [WHAT_W-1:0]    what_o,
    output wire [ROW_W-1:0]     row_o           // a cycle later
);
    wire                 busy, last;
    wire [CONTEXTS-1:0]  current;
    sweep #(.CONTEXTS(CONTEXTS), .COUNT_W(COUNT_W)) u_sweep (.clk_i(clk_i), .rst_i(rst_i), .load_i(load_i),
        .mask_i(mask_i), .count_i(count_i), .next_i(busy), .busy_o(busy), .current_o(current), .last_o(last));

    function [CONTEXT_W-1:0] number(input [CONTEXTS-1:0] one);
        integer i;
        begin
            number = {CONTEXT_W{1'b0}};
            for (i = 0; i < CONTEXTS; i = i + 1)
                if (one[i]) number = number | i[CONTEXT_W-1:0];
        end
    endfunction
    reg                 valid_q;
    reg [CONTEXTS-1:0]  current_q;
    reg [WHAT_W-1:0]    what_q, what_now_q;
    reg [ROW_W-1:0]     base_q, base_now_q, row_q;
    wire [ROW_W+CONTEXT_W-1:0] context_wide = {{ROW_W{1'b0}}, context_o};
    always @(posedge clk_i) begin
        if (load_i) {what_q, base_q} <= {what_i, base_i};
        valid_q    <= busy && !rst_i;
        current_q  <= current;
        what_now_q <= what_q;
        base_now_q <= base_q;
        row_q      <= base_now_q + context_wide[ROW_W-1:0];
    end
    assign busy_o    = busy;
    assign over_o    = busy && last;
    assign valid_o   = valid_q;
    assign context_o = number(current_q);
    assign what_o    = what_now_q;
    assign row_o     = row_q;
    wire unused = |context_wide[ROW_W +: CONTEXT_W];
endmodule
`default_nettype wire
