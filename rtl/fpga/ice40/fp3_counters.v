// SPDX-License-Identifier: Apache-2.0
// fp3_counters: counts the cycles in which each of N events happens, with most bits in block
// memory.
//
// Purpose   Takes the place of rtl/host/fp3_counters.v where logic is scarce. A counter has its low
//           8 bits in flip-flops. The rest is a word of a memory; one adder goes round all words
//           and adds what the low bits have carried.
// Latency   As there.
// Promise   The count that is shown is that of the cycle of read_i, also while a carry waits for
//           its word: the adder adds it on the way out, too.
// Hazard    read_i is high for at most one cycle in two: a read takes the cycle of a word, which
//           comes next. A word's cycle comes sooner than its next carry as long as N is at most
//           2^INDEX_W and INDEX_W 6.
//
//     cycle         0        1
//     read_i        1        0
//     index_i       k        -        memory: word of k
//     value_o       -        of k     word + carry that waited in cycle 0, low bits of cycle 0
`default_nettype none
module fp3_counters #(
    parameter N       = 10,            // events
    parameter INDEX_W = 4,
    parameter W       = 48             // bits of each count, 41 to 64
) (
    input  wire               clk_i,
    input  wire               clear_i,
    input  wire [N-1:0]       event_i,
    input  wire               read_i,
    input  wire [INDEX_W-1:0] index_i,
    input  wire               high_i,
    output wire [31:0]        value_o
);
    localparam LOW = 8, REST = W - LOW;
    localparam SPREAD = 1 << INDEX_W;

    reg  [N-1:0]            event_q, wait_q, fresh_q;     // wait: a carry waits; fresh: the word stands for 0
    wire [N-1:0]            carry, added;
    wire [LOW*SPREAD-1:0]   lows;
    wire [SPREAD-1:0]       waits  = {{SPREAD-N{1'b0}}, wait_q};
    wire [SPREAD-1:0]       freshs = {{SPREAD-N{1'b0}}, fresh_q};
    always @(posedge clk_i) event_q <= clear_i ? {N{1'b0}} : event_i;

    reg  [INDEX_W-1:0] next_q, at_q;                      // the next word to be read, the word read
    reg                own_q, one_q, none_q;              // ours, not the host's; its carry; it stands for 0
    wire               write = own_q && one_q && !read_i && !clear_i;

    genvar k;
    generate
        for (k = 0; k < SPREAD; k = k + 1) begin : g_counter
            if (k < N) begin : g_some
                reg [LOW-1:0] low_q;
                wire [LOW:0]  next = {1'b0, low_q} + {{LOW{1'b0}}, event_q[k]};
                always @(posedge clk_i) low_q <= clear_i ? {LOW{1'b0}} : next[LOW-1:0];
                assign carry[k]            = next[LOW];
                assign added[k]            = write && at_q == k;
                assign lows[LOW*k +: LOW]  = low_q;
            end else begin : g_none
                assign lows[LOW*k +: LOW] = {LOW{1'b0}};
            end
        end
    endgenerate
    always @(posedge clk_i) begin
        wait_q  <= clear_i ? {N{1'b0}} : (wait_q & ~added) | carry;
        fresh_q <= clear_i ? {N{1'b1}} : fresh_q & ~added;
    end

    // The memory is never read where it is written: a read keeps the write from happening.
    (* ram_style = "block", no_rw_check *) reg [REST-1:0] memory [0:SPREAD-1];
    reg  [REST-1:0]    word_q;
    reg                high_q;
    reg  [LOW-1:0]     low_q;
    wire [INDEX_W-1:0] at    = read_i ? index_i : next_q;
    wire [REST-1:0]    sum   = (word_q & {REST{!none_q}}) + {{REST-1{1'b0}}, one_q};
    initial next_q = {INDEX_W{1'b0}};                     // any word does; a simulation needs one that is known
    always @(posedge clk_i) begin
        if (write) memory[at_q] <= sum;
        word_q <= memory[at];
        next_q <= read_i ? at_q : next_q + 1'b1;
        at_q   <= at;
        own_q  <= !read_i && !clear_i;
        one_q  <= waits[at];
        none_q <= freshs[at];
        high_q <= high_i;
        low_q  <= lows[LOW*index_i +: LOW];
    end
    assign value_o = high_q ? {{64-W{1'b0}}, sum[REST-1:32-LOW]} : {sum[31-LOW:0], low_q};

`ifdef FP3_CHECK
    reg read_q;
    always @(posedge clk_i) begin
        read_q <= read_i;
        if (read_q && read_i) begin
            $display("%m: two reads in a row"); $stop;
        end
        if (|(carry & wait_q & ~added) && !clear_i) begin
            $display("%m: a carry is lost"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
