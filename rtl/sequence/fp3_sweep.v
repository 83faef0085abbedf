// SPDX-License-Identifier: Apache-2.0
// fp3_sweep: goes through the contexts of an instruction, one in each cycle.
//
// Purpose   The next set bit of a mask in every cycle, without a gap between two sweeps.
// Latency   current_o shows the first context in the cycle after load_i, the next one in the cycle
//           after next_i.
// Hazard    load_i only with sweep_end_o and next_i, or while busy_o is low. mask_i then has count_i
//           ones, at least one.
//
//     cycle      0     1     2     3
//     load_i     1     0     0     0        mask 1010, count 2
//     next_i     -     1     1     -
//     current_o  -     0010  1000  -        one bit
//     sweep_end_o -    0     1     -
`default_nettype none
module fp3_sweep #(
    parameter CONTEXTS = 24,
    parameter COUNT_W  = 5
) (
    input  wire                clk_i,
    input  wire                rst_i,
    input  wire                load_i,
    input  wire [CONTEXTS-1:0] mask_i,
    input  wire [COUNT_W-1:0]  count_i,
    input  wire                next_i,
    output wire                busy_o,
    output wire [CONTEXTS-1:0] current_o,
    output wire                sweep_end_o
);
    // The lowest bit is taken a cycle before it is shown: left_q is what comes after it.
    reg                 busy_q, end_q;
    reg  [COUNT_W-1:0]  count_q;           // not yet gone through
    reg  [CONTEXTS-1:0] current_q, left_q;
    wire [CONTEXTS-1:0] from = load_i ? mask_i : left_q;
    wire [CONTEXTS-1:0] left = from & (from - 1'b1);

    always @(posedge clk_i) begin
        if (rst_i)       busy_q <= 1'b0;
        else if (load_i) busy_q <= 1'b1;
        else if (next_i) busy_q <= !end_q;
        if (load_i || next_i) begin
            {current_q, left_q} <= {from & ~left, left};
            count_q             <= load_i ? count_i : count_q - 1'b1;
            end_q               <= load_i ? count_i == 1 : count_q == 2;
        end
    end
    assign sweep_end_o = end_q;
    assign busy_o      = busy_q;
    assign current_o   = current_q;

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i) begin
            if (load_i && busy_q && !(next_i && end_q)) begin
                $display("%m: a sweep is loaded in the middle of another one"); $stop;
            end
            if (load_i && !(|mask_i)) begin
                $display("%m: a sweep of no context"); $stop;
            end
            // Now every context must have been shown exactly once: nothing is left.
            if (busy_q && end_q != !(|left_q)) begin
                $display("%m: the mask has not count_i ones: at the end %b, left %b", end_q, left_q); $stop;
            end
        end
`endif
endmodule
`default_nettype wire
