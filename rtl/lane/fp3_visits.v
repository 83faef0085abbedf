// SPDX-License-Identifier: Apache-2.0
// fp3_visits: which object each context has if objects can sleep: the list of a lane's objects, and
// which ones sleep.
//
// Purpose   A visit takes an object from the list's head and, if the object is awake at the visit's
//           end, puts it back at the tail, so sleeping objects cost nothing. Decides for every
//           instruction whether the object in its context executes it.
//
//           cycle  E      E+2        E+3       W-1         W           W+1        W+2
//           list:  taken  head read  row_e3_o  state read  executed_o  nonzero_i  state written,
//                                                                                 put back
//
// Latency   As shown: W is E + ENDED. Of a store's row, two cycles after st_context_i.
// Hazard    One context does not come twice within ENDED + 2 cycles. No run begins with an overfull
//           list: host_port checks this. The list's head is not read in the cycle in which it is
//           written. What is executed is executed for an object that is there and awake, or stored
//           in the last part of the visit in which it fell asleep.
`default_nettype none
module fp3_visits #(
    parameter CONTEXTS  = 24,
    parameter CONTEXT_W = 5,           // bits of a context's number, and of a row's
    parameter ROW_W     = 7,
    parameter ENDED     = 6            // cycles from E to W
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // E: a round begins, which takes as many objects as there are now; an object is taken
    input  wire                 round_i,
    input  wire                 take_i,
    // E+2
    input  wire                 take_e2_i,
    input  wire [CONTEXT_W-1:0] context_e2_i,
    output wire [ROW_W-1:0]     row_e3_o,       // E+3
    output wire [ROW_W-1:0]     row_late_o,     // W+1
    // W-1
    input  wire [CONTEXT_W-1:0] context_w1_i,
    // W: an instruction, and its comparison
    input  wire                 valid_i,
    input  wire                 begins_i,       // the first of a visit
    input  wire                 ends_i,         // the last
    input  wire                 in_last_i,      // in the last part, which objects that fell asleep execute
    input  wire                 lds_i,
    input  wire                 sleep_i,
    input  wire [CONTEXT_W-1:0] context_i,
    input  wire                 less_i,         // sleep found a small change
    output wire                 executed_o,
    output wire                 absent_o,       // trace: the context has no object
    output wire                 sleeps_o,       // the object falls asleep
    // W+1, W+2
    input  wire                 nonzero_i,      // lds found an object that sleeps
    output wire                 asleep_o,       // not awake after this instruction
    // The object in a context, for stores
    input  wire [CONTEXT_W-1:0] st_context_i,
    output wire [ROW_W-1:0]     st_row_o,       // two cycles later
    output wire                 st_absent_o,    // likewise: no object
    output wire                 st_asleep_o,    // it fell asleep in this visit
    // The host
    input  wire                 host_clear_i,   // the list is empty
    input  wire                 host_wake_i,    // one more: this row
    input  wire [ROW_W-1:0]     host_row_i,
    output wire [ROW_W:0]       count_o         // objects on the list; one beyond its room: the host wanted more
);
    // The list -----------------------------------------------------------------------------------
    reg  [ROW_W:0]   count_q, left_q;  // objects on the list; of these not yet taken in this round
    reg  [ROW_W-1:0] head_q;
    wire             present = left_q != {ROW_W+1{1'b0}};
    wire             take    = take_i && present;
    wire [ROW_W-1:0] next_row;         // E+2
    wire             beyond  = count_q[ROW_W] && count_q[0];
    reg              put_q;            // W+2
    reg  [ROW_W-1:0] put_row_q;

    always @(posedge clk_i)
        if (round_i)   left_q <= count_q;
        else if (take) left_q <= left_q - 1'b1;

    reg [ROW_W-1:0] tail_q;
    always @(posedge clk_i)
        if (rst_i || host_clear_i) begin
            count_q <= {ROW_W+1{1'b0}};
            head_q  <= {ROW_W{1'b0}};
            tail_q  <= {ROW_W{1'b0}};
        end else begin
            count_q <= count_q + {{ROW_W{1'b0}}, put_q || (host_wake_i && !beyond)} - {{ROW_W{1'b0}}, take};
            head_q  <= head_q + {{ROW_W-1{1'b0}}, take};
            tail_q  <= tail_q + {{ROW_W-1{1'b0}}, put_q || host_wake_i};
        end
    fp3_ram_registered #(.ADDR_W(ROW_W), .W(ROW_W)) u_list (.clk_i(clk_i),
        .write_i(put_q || host_wake_i), .write_addr_i(tail_q),
        .write_value_i(put_q ? put_row_q : host_row_i),
        .read_i(1'b1), .read_addr_i(head_q), .read_value_o(next_row));
`ifdef FP3_CHECK
    always @(posedge clk_i)
        if (!rst_i && take && beyond) begin
            $display("%m: a run of more objects than the list has room for"); $stop;
        end else if (!rst_i && take && (put_q || host_wake_i) && head_q == tail_q) begin
            $display("%m: word %0d of the list is read in the cycle in which it is written", head_q); $stop;
        end
`endif
    assign count_o = count_q;

    // The object in each context -----------------------------------------------------------------
    wire [ROW_W-1:0] row_e2, st_row;
    reg  [ROW_W-1:0] row_q, st_row_q;
    reg  [CONTEXT_W-1:0] st_context_q;
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(ROW_W)) u_row (.clk_i(clk_i),
        .write_i(take_e2_i), .write_addr_i(context_e2_i), .write_value_i(next_row),
        .read_addr_i(context_e2_i), .read_value_o(row_e2));
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(ROW_W)) u_st_row (.clk_i(clk_i),
        .write_i(take_e2_i), .write_addr_i(context_e2_i), .write_value_i(next_row),
        .read_addr_i(st_context_q), .read_value_o(st_row));
    always @(posedge clk_i) begin
        row_q        <= take_e2_i ? next_row : row_e2;
        st_context_q <= st_context_i;
        st_row_q     <= st_row;
    end
    assign row_e3_o = row_q;
    assign st_row_o = st_row_q;
    fp3_delay #(.W(ROW_W), .N(ENDED-2)) u_row_late (.clk_i(clk_i), .rst_i(1'b0), .d_i(row_q), .q_o(row_late_o));

    // Whether there is one, and whether it sleeps -----------------------------------------------
    reg                  state_write_q, state_absent_q, state_asleep_q;   // W+2
    reg  [CONTEXT_W-1:0] state_context_q;
    wire                 absent_w1, asleep_w1, st_absent, st_asleep;
    reg                  absent_q, asleep_q, st_absent_q, st_asleep_q;
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(2)) u_state (.clk_i(clk_i),
        .write_i(state_write_q), .write_addr_i(state_context_q),
        .write_value_i({state_absent_q, state_asleep_q}),
        .read_addr_i(context_w1_i), .read_value_o({absent_w1, asleep_w1}));
    fp3_lutram_1r1w #(.ADDR_W(CONTEXT_W), .W(2)) u_st_state (.clk_i(clk_i),
        .write_i(state_write_q), .write_addr_i(state_context_q),
        .write_value_i({state_absent_q, state_asleep_q}),
        .read_addr_i(st_context_q), .read_value_o({st_absent, st_asleep}));

    wire present_w0;
    fp3_delay #(.W(1), .N(ENDED)) u_present (.clk_i(clk_i), .rst_i(1'b0), .d_i(present), .q_o(present_w0));
    wire absent   = begins_i ? !present_w0 : absent_q;
    wire asleep   = !begins_i && asleep_q;
    wire executed = valid_i && !absent && !(asleep && !in_last_i);
    wire sleeps   = executed && sleep_i && less_i && !asleep;

    // Of a word that was just read, only whether it is zero is known in time, a cycle later.
    reg                  changes_q, ends_q, finds_q, new_absent_q, new_asleep_q;   // W+1
    reg  [CONTEXT_W-1:0] context_q;
    wire                 absent_d = new_absent_q || (finds_q && nonzero_i);
    always @(posedge clk_i) begin
        changes_q <= !rst_i && valid_i && (begins_i || lds_i || sleep_i);
        ends_q    <= !rst_i && valid_i && ends_i;
        finds_q   <= lds_i && executed;
        new_absent_q <= absent;
        new_asleep_q <= asleep || sleeps;
        context_q <= context_i;
    end

    always @(posedge clk_i) begin
        {absent_q, asleep_q} <= {absent_w1, asleep_w1};
        {st_absent_q, st_asleep_q} <= {st_absent, st_asleep};
        state_write_q        <= !rst_i && changes_q;
        state_context_q      <= context_q;
        state_absent_q       <= absent_d;
        state_asleep_q       <= new_asleep_q;
        put_q                <= !rst_i && ends_q && !absent_d && !new_asleep_q;
        put_row_q            <= row_late_o;
    end
    assign executed_o  = executed;
    assign absent_o    = absent;
    assign sleeps_o    = sleeps;
    assign asleep_o    = state_absent_q || state_asleep_q;
    assign {st_absent_o, st_asleep_o} = {st_absent_q, st_asleep_q};

`ifdef FP3_CHECK
    // The state of each context's object, kept without the delays of the memory.
    reg [(1<<CONTEXT_W)-1:0] there_q, slept_q;
    reg [3:0]                age [0:(1<<CONTEXT_W)-1];  // cycles since a context came
    wire there = begins_i ? present_w0 : there_q[context_i] && !(finds_q && nonzero_i && context_q == context_i);
    wire slept = !begins_i && slept_q[context_i];
    integer k;
    always @(posedge clk_i) begin
        if (finds_q && nonzero_i) there_q[context_q] <= 1'b0;
        if (valid_i) {there_q[context_i], slept_q[context_i]} <= {there, slept || sleeps};
        for (k = 0; k < CONTEXTS; k = k + 1)
            age[k] <= rst_i ? 4'd8 : valid_i && context_i == k[CONTEXT_W-1:0] ? 4'd1 : age[k] == 4'd8 ? 4'd8 : age[k] + 1'b1;
        if (!rst_i && valid_i && age[context_i] != 4'd8) begin
            $display("%m: context %0d comes again after %0d cycles", context_i, age[context_i]); $stop;
        end
        if (!rst_i && executed != (valid_i && there && (!slept || in_last_i))) begin
            $display("%m: context %0d, there %b, asleep %b, in the last part %b: executed %b", context_i, there, slept, in_last_i, executed);
            $stop;
        end
        if (!rst_i && (host_clear_i || host_wake_i) && (take || put_q)) begin
            $display("%m: the host changes a list in use"); $stop;
        end
    end
`endif
endmodule
`default_nettype wire
