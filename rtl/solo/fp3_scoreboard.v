// SPDX-License-Identifier: Apache-2.0
// fp3_scoreboard: one busy flag per register of each context, and the results in flight.
//
// Purpose   Says whether an instruction may issue: no register that it names is flagged (paper,
//           section 4), and the register file's write port is free in the cycle of its result.
//           Units have fixed latencies, so a result's cycle is known at issue. The slot that is
//           reserved then also carries the destination, so no tag travels through a unit.
//
//           slot     LATENCY ...    2    1    0
//                    ^ issue             |    a result is written in this cycle
//                                        a result is written in the next cycle: an operand that is
//                                        read now comes from the bypass
//
// Latency   0 for every answer. A flag rises in the cycle after issue_i. It falls so that the
//           earliest correct reader issues one cycle before the write (BYPASS), or one cycle after
//           it. A result that the next instruction can read (BYPASS, latency 1) is never flagged.
// Promise   No instruction is refused for another reason, so no instruction waits longer than the
//           results in flight. The flag of c_i counts only for an instruction that reads it. The
//           promises are proved for the latencies and options of every configuration:
//           tests/formal/scoreboard_spec.v.
// Hazard    issue_i only with blocked_o and taken_o low, and for one unit.
//
//     cycle   0             1                2                3         latency 2, BYPASS
//     issue   r1 = r2 + r3  r4 = r1 * r5     r4 = r1 * r5     -
//                           refused: r1      r1 from bypass   r1 is written
`default_nettype none
module fp3_scoreboard #(
    parameter REG_W       = 5,         // a register's number, its context's included
    parameter BYPASS      = 1,
    parameter CHAIN       = 1,         // to_chain_i is in use
    parameter ADD_LATENCY = 1,         // cycles from operands to result, each >= 1
    parameter MUL_LATENCY = 1
) (
    input  wire             clk_i,
    input  wire             rst_i,
    // The instruction at the issue stage
    input  wire             issue_i,
    input  wire             to_add_i,
    input  wire             to_mul_i,
    input  wire             to_chain_i,
    input  wire             reads_c_i,
    input  wire [REG_W-1:0] d_i,
    input  wire [REG_W-1:0] a_i,
    input  wire [REG_W-1:0] b_i,
    input  wire [REG_W-1:0] c_i,
    output wire             blocked_o,   // a register it names is flagged
    output wire             taken_o,     // the write port is taken in the cycle of its result
    output wire [1:0]       a_bypass_o,  // {from the multiplier, from the adder}
    output wire [1:0]       b_bypass_o,
    output wire [1:0]       c_bypass_o,
    // The result of this cycle
    output wire             write_o,
    output wire             write_mul_o, // from the multiplier, else from the adder
    output wire [REG_W-1:0] write_d_o,
    output wire             empty_o      // nothing in flight after this cycle, but for issue_i
);
    localparam CHAIN_LATENCY = MUL_LATENCY + ADD_LATENCY;
    localparam UNIT_LATENCY  = MUL_LATENCY > ADD_LATENCY ? MUL_LATENCY : ADD_LATENCY;
    localparam LONGEST       = CHAIN != 0 ? CHAIN_LATENCY : UNIT_LATENCY > 1 ? UNIT_LATENCY : 2;
    localparam FREE          = BYPASS != 0 ? 2 : 0;   // the slot that lowers a flag as it leaves

    // Slots 0 .. LONGEST, shifting down by one each cycle.
    reg  [LONGEST:0] valid_q;
    reg  [LONGEST:0] mul_q;
    reg  [REG_W-1:0] d_q [0:LONGEST];

    wire [LONGEST:0] slot = ({{LONGEST{1'b0}}, to_add_i}                 << ADD_LATENCY)
                          | ({{LONGEST{1'b0}}, to_mul_i}                 << MUL_LATENCY)
                          | ({{LONGEST{1'b0}}, to_chain_i && CHAIN != 0} << CHAIN_LATENCY);
    wire [LONGEST:0] insert = issue_i ? slot : {LONGEST+1{1'b0}};

    always @(posedge clk_i)
        if (rst_i) valid_q <= {LONGEST+1{1'b0}};
        else       valid_q <= (valid_q >> 1) | insert;

    integer k;
    always @(posedge clk_i)
        for (k = 0; k <= LONGEST; k = k + 1)
            if (insert[k]) begin
                mul_q[k] <= to_mul_i;
                d_q[k]   <= d_i;
            end else if (k < LONGEST) begin
                mul_q[k] <= mul_q[k+1];
                d_q[k]   <= d_q[k+1];
            end

    assign taken_o     = |(slot & (valid_q >> 1));
    // In reset the slots may still hold anything: memories have no reset.
    assign write_o     = valid_q[0] && !rst_i;
    assign write_mul_o = mul_q[0];
    assign write_d_o   = d_q[0];
    assign empty_o     = ~|(valid_q >> 1);

    // A result of the next cycle is bypassed to the units' operands.
    wire [1:0] due = BYPASS == 0 || !valid_q[1] ? 2'b00 : {mul_q[1], !mul_q[1]};
    assign a_bypass_o = a_i == d_q[1] ? due : 2'b00;
    assign b_bypass_o = b_i == d_q[1] ? due : 2'b00;
    assign c_bypass_o = c_i == d_q[1] ? due : 2'b00;

    // Busy flags. With BYPASS a result of latency 1 is there for the next instruction already.
    reg  [(1<<REG_W)-1:0] busy_q;
    wire                  flag   = BYPASS != 0 ? |(insert >> FREE) : issue_i;
    wire                  unflag = valid_q[FREE];
    wire [(1<<REG_W)-1:0] one    = {{(1<<REG_W)-1{1'b0}}, 1'b1};

    always @(posedge clk_i)
        if (rst_i) busy_q <= {(1<<REG_W){1'b0}};
        else       busy_q <= busy_q & ~(unflag ? one << d_q[FREE] : {(1<<REG_W){1'b0}})
                                    |  (flag   ? one << d_i       : {(1<<REG_W){1'b0}});

    assign blocked_o = busy_q[d_i] || busy_q[a_i] || busy_q[b_i] || (busy_q[c_i] && reads_c_i);

`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (issue_i && !rst_i && (blocked_o || taken_o
                                  || {2'b00, to_add_i} + {2'b00, to_mul_i} + {2'b00, to_chain_i} != 3'd1)) begin
            $display("%m: an instruction issues that is blocked, without a write slot, or not for one unit");
            $stop;
        end
`endif
`ifdef FORMAL
    // tests/formal/scoreboard_spec.v: its induction looks at all destinations.
    reg [(LONGEST+1)*REG_W-1:0] destinations;
    integer i;
    always @*
        for (i = 0; i <= LONGEST; i = i + 1) destinations[REG_W*i +: REG_W] = d_q[i];
`endif
endmodule
`default_nettype wire
