// SPDX-License-Identifier: Apache-2.0
// fp3_dual_pace: when the next sweep may begin, where a sweep of sums and one of products may be
// under way at once.
//
// Purpose   A sweep waits for its unit, and long enough after the sweep before that no context
//           reads a result before it is written. All sweeps go through the contexts in the same
//           order without a stop, so GAP cycles between their beginnings are enough.
//
//           n = 30, GAP = 13:    product  0 ........... 29 30 .......... 59
//                                    sum      13 ........... 42 43 ...
//
// Promise   Between two sweeps' beginnings at least GAP cycles pass; no sweep begins while its unit
//           is busy, and no sweep waits longer than these two rules require. Proved:
//           tests/formal/dual_pace_spec.v.
// Latency   count_o two cycles after valid_i, known_o and may_o five.
// Hazard    mask_i, adds_i, muls_i and legal_i stay while valid_i is high. take_i comes with may_o
//           and ends it: valid_i is low in the next cycle. The contexts of a mask are 0, 1, ..
//           without a hole. start_i comes with valid_i low, when nothing has issued for GAP cycles.
`default_nettype none
module fp3_dual_pace #(
    parameter CONTEXTS = 24,
    parameter GAP      = 13,
    parameter COUNT_W  = 6
) (
    input  wire                clk_i,
    input  wire                rst_i,
    input  wire                start_i,
    input  wire                valid_i,
    input  wire [CONTEXTS-1:0] mask_i,
    input  wire                adds_i,      // it needs the adder, or both units are taken at once
    input  wire                muls_i,      // ... the multiplier
    input  wire                legal_i,     // it may begin at all
    input  wire                take_i,
    output wire                known_o,
    output wire [COUNT_W-1:0]  count_o,
    output wire                may_o,
    input  wire                adder_i,     // free in the next cycle
    input  wire                multiplier_i
);
    localparam MIDDLE = CONTEXTS / 2;
    localparam [31:0] GAP_32 = GAP;
    localparam [COUNT_W-1:0] GAP_C = GAP_32[COUNT_W-1:0], ZERO = {COUNT_W{1'b0}};

    // A mask has no hole, so it has one last context: its number and 1 is their count, which takes
    // no sum of bits.
    wire [CONTEXTS-1:0] top  = mask_i & ~(mask_i >> 1);
    wire [CONTEXTS-1:0] low  = ~({CONTEXTS{1'b1}} << MIDDLE);
    function [COUNT_W-1:0] count(input [CONTEXTS-1:0] one);
        integer           i;
        reg [COUNT_W-1:0] n;
        begin
            {count, n} = {ZERO, ZERO};
            for (i = 0; i < CONTEXTS; i = i + 1) begin
                n     = n + 1'b1;
                count = count | (n & {COUNT_W{one[i]}});
            end
        end
    endfunction

    reg  [4:0]         age_q;               // ones move up; at the top all below is known
    reg  [COUNT_W-1:0] low_q, high_q, count_q;
    reg  [COUNT_W-1:0] since_q;             // cycles since the last sweep began, GAP at most
    wire [COUNT_W-1:0] since = take_i ? ZERO + 1'b1 : since_q == GAP_C ? GAP_C : since_q + 1'b1;
    // All but the units is told a cycle ahead: may_o reaches far.
    reg                ready_q, adds_q, muls_q;
    always @(posedge clk_i) begin
        age_q    <= valid_i && !rst_i ? {age_q[4] || age_q[3], age_q[2:0], 1'b1} : 5'd0;
        low_q    <= count(top & low);
        high_q   <= count(top & ~low);
        count_q  <= low_q | high_q;
        since_q  <= start_i ? GAP_C : since;
        ready_q  <= valid_i && !rst_i && legal_i && (age_q[4] || age_q[3]) && since_q >= GAP_C - 1'b1;
        {adds_q, muls_q} <= {adds_i, muls_i};
    end
    assign known_o = valid_i && age_q[4];
    assign count_o = count_q;
    assign may_o   = valid_i && ready_q && (!adds_q || adder_i) && (!muls_q || multiplier_i);

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i) begin
            if (valid_i && (mask_i & (mask_i + 1'b1)) != {CONTEXTS{1'b0}}) begin
                $display("%m: a hole in the contexts %b", mask_i); $stop;
            end
            if (take_i && !may_o) begin
                $display("%m: a sweep is taken before it may begin"); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
