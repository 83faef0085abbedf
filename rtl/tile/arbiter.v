// arbiter: which schedulers get the adder, the multiplier, or both, in this cycle.
//
// Purpose   Each request names the units that it needs. The multiplier is the scarcer one: requests
//           for it come first, so that an addition takes the adder when another scheduler
//           multiplies, and not from one that needs both. Within these, whose sweep has ended comes
//           last: schedulers then stand at different instructions, which is what lets them overlap.
// Latency   1: what is asked for in a cycle is granted in the next, if it is not over by then. A new
//           sweep so waits for a cycle, in which the units are another scheduler's. A request
//           that needs nothing is granted at once.
// Promise   Nobody waits for ever: a request that was refused PATIENCE times in a row comes before
//           all others until its sweep ends.
// Hazard    A request stays until its sweep's last one is granted (or everything is dropped).
//
//     N = 2, 0 before 1:    adds_i 11, muls_i 11  ->  grant_o 01, in the next cycle
//                           adds_i 11, muls_i 10  ->  grant_o 10
//                           adds_i 01, muls_i 10  ->  grant_o 11
`default_nettype none
module arbiter #(
    parameter N        = 2,
    parameter PATIENCE = 127
) (
    input  wire         clk_i,
    input  wire         rst_i,
    input  wire [N-1:0] adds_i,
    input  wire [N-1:0] muls_i,
    input  wire [N-1:0] lasts_i,       // the last of a sweep
    output wire [N-1:0] grant_o
);
    localparam [7:0] PATIENCE_8 = PATIENCE;

    reg  [N*N-1:0] before_q;           // N*i + j: j comes before i
    reg  [8*N-1:0] waited_q;
    wire [N-1:0]   needs = adds_i | muls_i;
    wire [N-1:0]   over  = grant_q & needs & lasts_i;
    wire [N-1:0]   stays = needs & ~over;
    reg  [N-1:0]   grant_q;
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
endmodule
`default_nettype wire
