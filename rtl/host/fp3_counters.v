// SPDX-License-Identifier: Apache-2.0
// fp3_counters: counts the cycles in which each of N events happens.
//
// Purpose   Says where a run's cycles went. A count wraps at 2^W: with 48 bits, after a month at 10
//           ns.
// Latency   An event is counted two cycles later, so that no event has to reach a carry chain in
//           its own cycle. A word of a count is on value_o in the cycle after read_i.
// Device    rtl/fpga/ice40 has a smaller one of the same behaviour.
`default_nettype none
module fp3_counters #(
    parameter N       = 10,            // events
    parameter INDEX_W = 4,
    parameter W       = 48             // bits of each count, at most 64
) (
    input  wire               clk_i,
    input  wire               clear_i,
    input  wire [N-1:0]       event_i,
    input  wire               read_i,
    input  wire [INDEX_W-1:0] index_i,
    input  wire               high_i,  // the high word of the count
    output wire [31:0]        value_o
);
    localparam FOURS = (N + 3) / 4;
    reg  [N-1:0]         event_q;
    wire [256*FOURS-1:0] values;
    always @(posedge clk_i) event_q <= clear_i ? {N{1'b0}} : event_i;

    genvar k;
    generate
        for (k = 0; k < N; k = k + 1) begin : g_counter
            reg [W-1:0] count_q;
            always @(posedge clk_i)
                if (clear_i) count_q <= {W{1'b0}};
                else         count_q <= count_q + {{W-1{1'b0}}, event_q[k]};
            assign values[64*k +: 64] = {{64-W{1'b0}}, count_q};
        end
        if (N % 4 != 0) begin : g_rest
            assign values[64*N +: 64*(4*FOURS-N)] = {64*(4*FOURS-N){1'b0}};
        end
    endgenerate

    // A word of each four is taken in the cycle of read_i, one of these shown in the next: one mux
    // of all is too slow.
    reg [32*FOURS-1:0] taken_q;
    reg [INDEX_W-3:0]  which_q;
    integer            f;
    always @(posedge clk_i) begin
        for (f = 0; f < FOURS; f = f + 1) taken_q[32*f +: 32] <= values[256*f + 64*index_i[1:0] + 32*high_i +: 32];
        which_q <= index_i[INDEX_W-1:2];
    end
    assign value_o = taken_q[32*which_q +: 32];
    wire unused = read_i;
endmodule
`default_nettype wire
