// SPDX-License-Identifier: Apache-2.0
// fp3_pace: when the next sweep may begin, so that no context reads a result before it is written.
//
// Purpose   The pause rule, which replaces busy flags. If a sweep of m contexts follows a sweep of
//           n without an idle cycle, and one of the two sets contains the other, a context in both
//           sets issues again after min(n, m) cycles or more. This also holds if the second sweep
//           covers contexts 0 .. m - 1, as at the beginning of a batch: none of them comes earlier
//           than before. A pause adds the cycles that are missing to GAP.
//
//           A pause of 3, GAP = 5:    A0 A1  .  .  .  B0 B1      n = m = 2: B0 issues 5 cycles after A0
//
// Promise   Between two issues of one context at least GAP cycles pass, whichever sweeps and stalls
//           lie between them; and no sweep waits longer than that. Proved for the contexts and
//           latencies of every configuration: tests/formal/pace_spec.v.
// Latency   count_o two cycles after valid_i, known_o and may_o five.
// Hazard    mask_i stays while valid_i is high. take_i ends it: valid_i is low in the next cycle.
//           take_i comes with may_o if the mask has a context (a sweep begins), else with known_o
//           (nothing issues). Of two consecutive sweeps, one has all contexts of the other, or the
//           second has the lowest contexts; empty masks do not count. start_i comes with valid_i
//           low, when nothing has issued for GAP cycles.
//
//     cycle     0     1     2     3     4     5     6
//     valid_i   1     1     1     1     1     1     0        mask_i 0111
//     count_o   -     -     3     3     3     3     -
//     known_o   0     0     0     0     0     1     0
//     may_o     0     0     0     0     0     1     0        take_i = may_o; no sweep was under way
`default_nettype none
module fp3_pace #(
    parameter CONTEXTS = 24,
    parameter GAP      = 17,           // cycles from an issue to the next one of the same context
    parameter COUNT_W  = 6             // bits that count 0 .. GAP + CONTEXTS
) (
    input  wire                clk_i,
    input  wire                rst_i,
    input  wire                start_i,     // forget the sweeps before
    // The next sweep
    input  wire                valid_i,
    input  wire [CONTEXTS-1:0] mask_i,
    input  wire                take_i,
    output wire                known_o,     // the mask is counted, its pause is known
    output wire [COUNT_W-1:0]  count_o,
    output wire                may_o,       // the sweep may begin: its first issue is in the next cycle, or later
    // The sweep under way
    input  wire                busy_i,
    input  wire                over_i       // its last context issues in this cycle
);
    localparam MIDDLE = CONTEXTS / 2;
    localparam [31:0] GAP_32 = GAP;
    localparam [COUNT_W-1:0] GAP_C = GAP_32[COUNT_W-1:0], ZERO = {COUNT_W{1'b0}};

    function [COUNT_W-1:0] ones(input [CONTEXTS-1:0] mask);
        integer i;
        begin
            ones = ZERO;
            for (i = 0; i < CONTEXTS; i = i + 1) ones = ones + {{COUNT_W-1{1'b0}}, mask[i]};
        end
    endfunction

    // A sweep is long enough for one register in each step: count, compare, subtract, compare.
    reg  [4:0]         age_q;               // ones move up; at the top all below is known
    reg  [COUNT_W-1:0] low_q, high_q, count_q;
    reg  [COUNT_W-1:0] before_q;            // contexts of the sweep before
    reg  [COUNT_W-1:0] least_q;             // the smaller number of the two
    reg  [COUNT_W-1:0] pause_q;             // idle cycles that are needed
    reg  [COUNT_W-1:0] since_q;             // cycles since the last sweep, GAP at most
    reg                unpaused_q;          // none are needed
    reg                rested_q;            // there have been enough
    wire               enough = least_q >= GAP_C;
    always @(posedge clk_i) begin
        age_q      <= valid_i && !rst_i ? {age_q[4] || age_q[3], age_q[2:0], 1'b1} : 5'd0;
        low_q      <= ones(mask_i & ~({CONTEXTS{1'b1}} << MIDDLE));
        high_q     <= ones(mask_i >> MIDDLE);
        count_q    <= low_q + high_q;
        least_q    <= count_q < before_q ? count_q : before_q;
        unpaused_q <= enough;
        pause_q    <= enough ? ZERO : GAP_C - least_q;
        rested_q   <= (busy_i ? ZERO : since_q) + 1'b1 >= pause_q;

        // Without a start value it would be X under Icarus, and stay X: no context would ever
        // issue.
        if (start_i)     before_q <= {COUNT_W{1'b1}};
        else if (take_i) before_q <= count_q;
        if (busy_i)                since_q <= {{COUNT_W-1{1'b0}}, 1'b1};
        else if (start_i)          since_q <= GAP_C;
        else if (since_q != GAP_C) since_q <= since_q + 1'b1;
    end
    assign known_o = valid_i && age_q[4];
    assign count_o = count_q;
    assign may_o   = known_o && (busy_i ? over_i && unpaused_q : rested_q);

`ifdef FP3_CHECK
    // Assumptions about the surroundings. sequencer checks the promise that follows from them.
    reg                valid_q, take_q;
    reg [CONTEXTS-1:0] mask_q, swept_q;     // of the cycle before; of the sweep before
    reg [15:0]         idle_q;              // cycles without an issue
    wire               sweeps = take_i && |mask_i;
    always @(posedge clk_i) begin
        {valid_q, take_q, mask_q} <= {valid_i && !rst_i, take_i && !rst_i, mask_i};
        idle_q <= rst_i ? GAP_32[15:0] : busy_i ? 16'd0 : idle_q < GAP_32[15:0] ? idle_q + 1'b1 : idle_q;
        if (rst_i || start_i) swept_q <= {CONTEXTS{1'b0}};
        else if (sweeps)      swept_q <= mask_i;
        if (!rst_i) begin
            if (valid_q && valid_i && (take_q || mask_i != mask_q)) begin
                $display("%m: the mask changes while it is valid, or stays valid when it was taken"); $stop;
            end
            if (take_i && !(|mask_i ? may_o : known_o)) begin
                $display("%m: a sweep is taken before it may begin"); $stop;
            end
            if (sweeps && |swept_q && |(mask_i & ~swept_q) && |(swept_q & ~mask_i) && |(mask_i & (mask_i + 1'b1))) begin
                $display("%m: neither of the contexts %b and %b contains the other, nor are the latter the lowest", swept_q, mask_i); $stop;
            end
            if (start_i && (busy_i || valid_i || idle_q < GAP_32[15:0])) begin
                $display("%m: a start with a mask, or %0d cycles after an issue, %0d are needed", idle_q, GAP); $stop;
            end
        end
    end
`endif
endmodule
`default_nettype wire
