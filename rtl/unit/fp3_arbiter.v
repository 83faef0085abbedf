// SPDX-License-Identifier: Apache-2.0
// fp3_arbiter: grants the adder, the multiplier, or both, to schedulers.
//
// Purpose   Each request names the units that it needs. The multiplier is the scarcer unit, so
//           requests for it come first: an addition takes the adder while another scheduler
//           multiplies, not from a request that needs both. Among equals, the scheduler whose sweep
//           ended last comes last: schedulers then stand at different instructions, which lets them
//           overlap.
// Latency   1: a request of one cycle is granted in the next, unless its sweep is over by then. So
//           a new sweep waits for a cycle, in which the units are another scheduler's. A request
//           that needs nothing is granted at once.
// Promise   At most one grant per unit and cycle, and no grant without a request. A request waits
//           only for a request that comes first and takes a unit that it needs. A request that was
//           refused PATIENCE times in a row comes before all others until its sweep ends. So with
//           sweeps of at most S requests, no request is refused more than PATIENCE + 1 + (N - 1) *
//           S times in a row: 152 times with N = 2 and 24 contexts. Proved for N = 2, 3 and 4:
//           tests/formal/arbiter_spec.v.
// Hazard    A request stays the same until it is granted, and its sweep goes on until sweep_end_i is
//           granted. Or it is dropped: then its scheduler asks for nothing in the next cycle, and
//           the number of refusals has no bound.
//
//     N = 2, 0 before 1:    adds_i 11, muls_i 11  ->  grant_o 01, in the next cycle
//                           adds_i 11, muls_i 10  ->  grant_o 10
//                           adds_i 01, muls_i 10  ->  grant_o 11
`default_nettype none
module fp3_arbiter #(
    parameter N        = 2,
    parameter PATIENCE = 127
) (
    input  wire         clk_i,
    input  wire         rst_i,
    input  wire [N-1:0] adds_i,
    input  wire [N-1:0] muls_i,
    input  wire [N-1:0] sweep_end_i,  // the last of its sweep
    output wire [N-1:0] grant_o
);
    localparam [7:0] PATIENCE_8 = PATIENCE;

    reg  [N*N-1:0] before_q;           // N*i + j: j comes before i
    reg  [8*N-1:0] waited_q;
    reg  [N-1:0]   grant_q;
    wire [N-1:0]   needs = adds_i | muls_i;
    wire [N-1:0]   over  = grant_q & needs & sweep_end_i;
    wire [N-1:0]   stays = needs & ~over;
    reg  [N-1:0]   urgent, grant, ahead;
    reg            adder_free, multiplier_free;
    integer        i, level, rank, m, n;

    function integer count(input [N-1:0] bits);
        integer b;
        begin
            count = 0;
            for (b = 0; b < N; b = b + 1) count = count + {31'd0, bits[b]};
        end
    endfunction

    always @* begin
        for (i = 0; i < N; i = i + 1) urgent[i] = waited_q[8*i +: 8] == PATIENCE_8;
        grant           = {N{1'b0}};
        adder_free      = 1'b1;
        multiplier_free = 1'b1;
        ahead           = {N{1'b0}};
        for (level = 0; level < 3; level = level + 1)
            for (rank = 0; rank < N; rank = rank + 1)
                for (i = 0; i < N; i = i + 1) begin
                    ahead = before_q[N*i +: N];
                    if (count(ahead) == rank && stays[i]
                            && (urgent[i] ? level == 0 : muls_i[i] ? level == 1 : level == 2)
                            && (adder_free || !adds_i[i]) && (multiplier_free || !muls_i[i])) begin
                        grant[i]        = 1'b1;
                        adder_free      = adder_free && !adds_i[i];
                        multiplier_free = multiplier_free && !muls_i[i];
                    end
                end
    end
    assign grant_o = grant_q | ~needs;

    always @(posedge clk_i) begin
        grant_q <= rst_i ? {N{1'b0}} : grant;
        for (m = 0; m < N; m = m + 1) begin
            if (rst_i || over[m])          waited_q[8*m +: 8] <= 8'd0;
            else if (needs[m] && !urgent[m])
                waited_q[8*m +: 8] <= grant_q[m] ? 8'd0 : waited_q[8*m +: 8] + 1'b1;
            for (n = 0; n < N; n = n + 1)
                if (rst_i)                     before_q[N*m + n] <= n < m;
                else if (over[m] && !over[n])  before_q[N*m + n] <= 1'b1;
                else if (over[n] && !over[m])  before_q[N*m + n] <= 1'b0;
        end
    end

`ifdef FP3_CHECK
    reg [N-1:0] adds_q, muls_q, sweep_end_q, stays_q, granted_q;   // of the cycle before
    integer     c;
    always @(posedge clk_i) begin
        {adds_q, muls_q, sweep_end_q, granted_q} <= {adds_i, muls_i, sweep_end_i, grant_q};
        stays_q <= rst_i ? {N{1'b0}} : stays;
        for (c = 0; c < N; c = c + 1)
            if (!rst_i && stays_q[c] && needs[c] && ({adds_i[c], muls_i[c]} != {adds_q[c], muls_q[c]}
                                                     || (!granted_q[c] && sweep_end_i[c] != sweep_end_q[c]))) begin
                $display("%m: the request of scheduler %0d changes before it is granted", c);
                $stop;
            end
    end
`endif
endmodule
`default_nettype wire
