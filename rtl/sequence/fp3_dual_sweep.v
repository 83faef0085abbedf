// SPDX-License-Identifier: Apache-2.0
// fp3_dual_sweep: the instruction that is under way to one unit, one context in each cycle.
//
// Purpose   With DUAL, the sweep of sums or the sweep of products, and its orders to the lanes.
//           Nothing stops a sweep.
// Latency   valid_o shows the first context two cycles after load_i, row_o its row three cycles
//           after.
// Hazard    load_i only while free_o is high. base_i is the row of context 0.
//
//     cycle     0     1      2        3
//     load_i    1     0      0        0        count 2, base 48
//     busy_o    0     1      1        0
//     free_o    1     0      1        1        from the cycle of the last context on
//     valid_o   0     0      1        1        context_o 0, 1; row_o 48 in cycle 3, 49 in cycle 4
`default_nettype none
module fp3_dual_sweep #(
    parameter WHAT_W    = 1,
    parameter COUNT_W   = 6,
    parameter CONTEXT_W = 5,           // bits of a context's number, and of a row's
    parameter ROW_W     = 7
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire                 load_i,
    input  wire [COUNT_W-1:0]   count_i,        // contexts 0, 1 .. count_i - 1; at least one
    input  wire [ROW_W-1:0]     base_i,
    input  wire [WHAT_W-1:0]    what_i,
    output wire                 busy_o,
    output wire                 free_o,         // the next sweep may be loaded
    output wire                 valid_o,
    output wire [CONTEXT_W-1:0] context_o,
    output wire [WHAT_W-1:0]    what_o,
    output wire [ROW_W-1:0]     row_o           // a cycle later
);
    reg                 busy_q, free_q;
    reg [CONTEXT_W-1:0] context_q;
    reg [COUNT_W-1:0]   left_q;                  // from this context on
    always @(posedge clk_i) begin
        if (rst_i)       {busy_q, free_q} <= 2'b01;
        else if (load_i) {busy_q, free_q} <= {1'b1, count_i == 1};
        else             {busy_q, free_q} <= {busy_q && !free_q, free_q || left_q == 2};
        context_q <= load_i ? {CONTEXT_W{1'b0}} : context_q + 1'b1;
        left_q    <= load_i ? count_i : left_q - 1'b1;
    end

    reg                 valid_q;
    reg [CONTEXT_W-1:0] context_now_q;
    reg [WHAT_W-1:0]    what_q, what_now_q;
    reg [ROW_W-1:0]     base_q, base_now_q, row_q;
    wire [ROW_W+CONTEXT_W-1:0] context_wide = {{ROW_W{1'b0}}, context_o};
    always @(posedge clk_i) begin
        if (load_i) {what_q, base_q} <= {what_i, base_i};
        valid_q       <= busy_q && !rst_i;
        context_now_q <= context_q;
        what_now_q <= what_q;
        base_now_q <= base_q;
        row_q      <= base_now_q + context_wide[ROW_W-1:0];
    end
    assign busy_o    = busy_q;
    assign free_o    = free_q;
    assign valid_o   = valid_q;
    assign context_o = context_now_q;
    assign what_o    = what_now_q;
    assign row_o     = row_q;
    wire unused = |context_wide[ROW_W +: CONTEXT_W];
endmodule
`default_nettype wire
