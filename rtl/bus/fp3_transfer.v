// SPDX-License-Identifier: Apache-2.0
// fp3_transfer: moves words between memory and the processor, as a master of AXI4.
//
// Purpose   The host says a range of memory, a place in the processor (an address of the bus, as it
//           would write there itself) and how many words, and starts a transfer: a load from memory
//           or a store to it. docs/memory.md has the registers' use, isa/registers.toml the map.
//
//           load    memory ─ R ─► word ─────────► requests (turns, hub)
//           store   memory ◄─ W ─ responses ◄──── answers
//
//           A list is descriptors in memory, each of which is a transfer, or waits for the end of a
//           run, or goes back some times: so one command is many runs on objects that the store has no
//           room for. By how a run has ended the list may go on elsewhere. The place of a transfer may
//           be some words of each record: after each run of words others are left out.
//
// Latency   A load takes a cycle for each word beyond the memory's latency, a store likewise. Where
//           the place does not stream (constants, registers), a word takes as long as an access.
// Promise   Each word is moved once, in order; no byte outside of the range is written. After an
//           error of memory (SLVERR, DECERR) or of the processor nothing else is moved: bursts that
//           memory has taken come to their end, with words that are dropped, or that write no byte.
//           So a transfer ends if memory answers, and says where the error was. What a descriptor
//           has moved is there before the next one is read.
// Hazard    Words that are moved at the same time as the host accesses them are old or new. After an
//           error what memory or the processor has of the range is old or new word by word. A wait
//           for a bit that never falls ends by reset alone: a run that a list starts has to end. So
//           does a list that always goes back.
`default_nettype none
module fp3_transfer #(
    parameter WORDS_W = 24,            // bits of a number of words
    parameter READS_W = 4,             // 2^READS_W reads of the processor under way at most
    parameter OPEN_W  = 6
) (
    input  wire              clk_i,
    input  wire              rst_i,
    // Its registers: an access is answered in the next cycle
    input  wire              ask_i,
    input  wire              ask_write_i,
    input  wire [2:0]        ask_register_i,
    input  wire [31:0]       ask_wdata_i,
    output wire              told_o,
    output wire              told_write_o,
    output wire              told_error_o,
    output wire [31:0]       told_rdata_o,
    // Requests, and their answers
    output wire              req_valid_o,
    input  wire              req_ready_i,
    output wire              req_write_o,
    output wire [31:2]       req_place_o,
    output wire [31:0]       req_wdata_o,
    input  wire              answered_i,
    input  wire              answer_error_i,
    input  wire [31:0]       answer_rdata_i,
    input  wire [OPEN_W-1:0] open_i,             // requests under way, this answer's included
    // Memory
    output wire              awvalid_o,
    input  wire              awready_i,
    output wire              arvalid_o,
    input  wire              arready_i,
    output wire [31:2]       address_o,          // of both
    output wire [7:0]        length_o,           // likewise
    output wire              wvalid_o,
    input  wire              wready_i,
    output wire [31:0]       wdata_o,
    output wire              wstrobe_o,          // of all four bytes
    output wire              wlast_o,
    input  wire              bvalid_i,
    output wire              bready_o,
    input  wire              berror_i,
    input  wire              rvalid_i,
    output wire              rready_o,
    input  wire [31:0]       rdata_i,
    input  wire              rerror_i
);
`include "gen/registers.vh"
    localparam OWED_W = 10, BURSTS_W = 5, SAID_W = TRANSFER_CONTROL_SKIP_HI + 1;
    localparam [WORDS_W-1:0] DESCRIPTOR = 4;
    localparam [2:0] MEMORY = ADDR_TRANSFER_MEMORY[4:2], PLACE = ADDR_TRANSFER_PLACE[4:2], WORDS = ADDR_TRANSFER_WORDS[4:2],
                     CONTROL = ADDR_TRANSFER_CONTROL[4:2], OUTCOME = ADDR_TRANSFER_STATUS[4:2], ERROR = ADDR_TRANSFER_ERROR[4:2],
                     NEXT = ADDR_TRANSFER_NEXT[4:2];

    // Whether it is one thing to do
    function one_of(input [3:0] bits);
        one_of = bits != 4'd0 && (bits & (bits - 4'd1)) == 4'd0;
    endfunction

    // What is being done
    reg                busy_q, store_q, stay_q, done_q, memory_error_q, refused_q;
    reg  [31:2]        error_q;
    // Of a list
    reg                fetch_q;        // a descriptor comes, word by word
    reg  [1:0]         word_number_q;  // ... this one is next
    reg                wrong_q;        // ... one was not possible
    reg  [SAID_W-1:0]  said_q;         // ... what the last one says
    reg                rests_q;        // all that was begun is over; of a descriptor, strays_q is of it
    reg                more_q;         // when what is done is over, another descriptor comes
    reg  [31:2]        next_q;         // ... from here
    reg                fetches_q;      // next_q is where a descriptor begins, and moves behind it
    wire [31:2]        behind = next_q + {27'd0, fetches_q, 2'd0};
    reg                wait_q, waited_q; // a word of a place is waited for, and has come
    reg                otherwise_q;    // ... and if it is another one than was said, the list goes on elsewhere
    reg                elsewhere_q;    // ... as it does
    // A part of a list is made again
    reg                again_q;        // it is
    reg  [WORDS_W-1:0] again_left_q;   // ... how often after this time
    reg  [31:2]        again_at_q;     // ... where the descriptor ends that says so
    reg                strays_q;       // the descriptor that has come also says `again`, within that part
    // Of words: in memory, the next that is moved on W or R, and how many; in the processor, the next
    // that is asked for, and how many; the next that is answered.
    reg  [31:2]        memory_q, place_q, due_q;
    // Words of a place that follow one another, 0: 64, and how many are left out behind them; of a run,
    // how many are still asked for, and answered.
    reg  [5:0]         run_q, skip_q, run_left_q, due_left_q;
    reg  [WORDS_W-1:0] words_q, ask_left_q;
    reg  [OWED_W-1:0]  owed_q;         // words of bursts that memory has taken
    reg  [BURSTS_W:0]  bursts_q;       // bursts of a store without a response
    reg  [31:2]        oldest_q;       // the address of the first of these
    wire               failed = memory_error_q || refused_q;

    // The registers
    wire        control  = ask_write_i && ask_register_i == CONTROL;
    wire        list     = ask_wdata_i[TRANSFER_CONTROL_LIST_LO];
    wire        sets     = ask_write_i && (ask_register_i == MEMORY || ask_register_i == PLACE || ask_register_i == WORDS);
    wire        whole    = ask_register_i == WORDS ? ask_wdata_i[31:WORDS_W] == {32-WORDS_W{1'b0}} : ask_wdata_i[1:0] == 2'd0;
    wire        commands = one_of({ask_wdata_i[TRANSFER_CONTROL_LOAD_LO], ask_wdata_i[TRANSFER_CONTROL_STORE_LO],
                                   ask_wdata_i[TRANSFER_CONTROL_WAIT_LO], list}) && !ask_wdata_i[TRANSFER_CONTROL_AGAIN_LO]
                         && !ask_wdata_i[TRANSFER_CONTROL_OTHERWISE_LO];
    wire        legal    = ask_write_i ? !busy_q && (control ? commands : sets && whole)
                                       : ask_register_i != CONTROL && ask_register_i <= NEXT;
    wire        start    = ask_i && control && legal;
    wire        set      = ask_i && sets && legal;
    reg  [31:0] shown;
    reg         told_q, told_write_q, told_error_q;
    reg  [31:0] told_rdata_q;
    always @* begin
        shown = 32'd0;
        case (ask_register_i)
            MEMORY:  shown = {memory_q, 2'd0};
            PLACE:   shown = {place_q, 2'd0};
            WORDS:   shown = {{32-WORDS_W{1'b0}}, words_q};
            OUTCOME: begin
                shown[TRANSFER_STATUS_RUNNING_LO]      = busy_q;
                shown[TRANSFER_STATUS_DONE_LO]         = done_q;
                shown[TRANSFER_STATUS_MEMORY_ERROR_LO] = memory_error_q && !busy_q;
                shown[TRANSFER_STATUS_REFUSED_LO]      = refused_q && !busy_q;
            end
            ERROR:   shown = {error_q, 2'd0} & {32{failed}};
            NEXT:    shown = {behind, 2'd0};
            default: shown = 32'd0;
        endcase
    end
    always @(posedge clk_i) begin
        told_q       <= ask_i && !rst_i;
        told_write_q <= ask_write_i;
        told_error_q <= !legal;
        told_rdata_q <= legal && !ask_write_i ? shown : 32'd0;
    end
    assign {told_o, told_write_o, told_error_o, told_rdata_o} = {told_q, told_write_q, told_error_q, told_rdata_q};

    // What a descriptor may say; it is the word that comes last.
    wire        possible = one_of({rdata_i[TRANSFER_CONTROL_LOAD_LO], rdata_i[TRANSFER_CONTROL_STORE_LO], rdata_i[TRANSFER_CONTROL_WAIT_LO],
                                   rdata_i[TRANSFER_CONTROL_AGAIN_LO]}) && !rdata_i[TRANSFER_CONTROL_LIST_LO]
                         && (rdata_i[TRANSFER_CONTROL_WAIT_LO] || !rdata_i[TRANSFER_CONTROL_OTHERWISE_LO]);

    // What begins: a command of the host's, the next descriptor, or what a descriptor says
    wire       over;
    wire       impossible = wrong_q || strays_q;
    wire       more   = more_q || elsewhere_q;
    wire       next   = busy_q && over && !failed && !fetch_q && more;
    wire       does   = busy_q && over && !failed && fetch_q && !impossible;
    wire       go     = start || next || does;
    wire       fetch  = (start && list) || next;
    wire [SAID_W-1:0] said = does ? said_q : ask_wdata_i[SAID_W-1:0];
    // The part is made again.
    wire       repeats = does && said_q[TRANSFER_CONTROL_AGAIN_LO];
    wire [WORDS_W-1:0] again_left = again_q ? again_left_q : words_q;
    wire       back   = repeats && again_left != {WORDS_W{1'b0}};
    wire       waits_for = !fetch && said[TRANSFER_CONTROL_WAIT_LO];
    wire       none   = waits_for || repeats;              // no words
    wire [31:2] first = next && !elsewhere_q ? next_q : memory_q;
    wire [WORDS_W-1:0] count = fetch ? DESCRIPTOR : none ? {WORDS_W{1'b0}} : words_q;

    // Bursts
    wire       asks, taken, bursts_over;
    wire [7:0] length;
    wire       room = owed_q < 10'd256 && !bursts_q[BURSTS_W];
    fp3_bursts #(.WORDS_W(WORDS_W)) u_bursts (.clk_i(clk_i), .rst_i(rst_i),
        .start_i(go), .address_i(first), .words_i(count), .room_i(room), .stop_i(failed), .over_o(bursts_over),
        .valid_o(asks), .ready_i(store_q ? awready_i : arready_i), .address_o(address_o), .length_o(length));
    assign taken     = asks && (store_q ? awready_i : arready_i);
    assign awvalid_o = asks && store_q;
    assign arvalid_o = asks && !store_q;
    assign length_o  = length;

    // A load: a word from memory waits here for the processor, and a second one behind it, which was
    // on its way when the first was not taken.
    reg         full_q, second_q;
    reg  [31:0] word_q, second_word_q;
    wire        asked = req_valid_o && req_ready_i;
    assign rready_o = busy_q && !store_q && !second_q;
    wire        reads   = rvalid_i && rready_o;
    wire        fetched = reads && fetch_q;            // a word of a descriptor

    // A store: a word from the processor waits for memory.
    reg         sends_q, strobe_q, last_q;
    reg  [31:0] sent_q;
    wire        answers_room, answers_idle, waits;
    wire [31:0] waiting;
    wire        sends = store_q && owed_q != {OWED_W{1'b0}} && (waits || failed) && (!sends_q || wready_i);
    fp3_responses #(.W(32), .DEPTH_W(READS_W)) u_answers (.clk_i(clk_i), .rst_i(rst_i || !busy_q),
        .room_o(answers_room), .idle_o(answers_idle),
        .go_i(asked && store_q), .answered_i(answered_i && store_q), .value_i(answer_rdata_i),
        .valid_o(waits), .ready_i(sends), .value_o(waiting));
    assign {wvalid_o, wdata_o, wstrobe_o, wlast_o} = {sends_q, sent_q, strobe_q, last_q};

    wire asks_left = ask_left_q != {WORDS_W{1'b0}};
    assign req_valid_o = busy_q && !failed && (wait_q ? !waited_q && open_i == {OPEN_W{1'b0}} : store_q ? asks_left && answers_room : full_q);
    assign req_write_o = !store_q && !wait_q;
    assign req_place_o = place_q;
    assign req_wdata_o = word_q;

    // What has gone wrong, and where: the first word that did
    assign bready_o = 1'b1;
    wire   closes = bvalid_i && busy_q;
    wire   moves  = reads || sends;
    wire   bad    = (reads && rerror_i) || (closes && berror_i);
    wire   comes  = answered_i && wait_q && !answer_rdata_i[0];
    wire   other  = comes && answer_rdata_i != {{32-WORDS_W{1'b0}}, words_q};
    wire   denied = answered_i && (answer_error_i || (other && !otherwise_q));
    wire   rests  = bursts_over && owed_q == {OWED_W{1'b0}} && bursts_q == {BURSTS_W+1{1'b0}} && !full_q && !sends_q
                 && open_i == {OPEN_W{1'b0}};
    assign over   = rests_q && (failed || !wait_q || waited_q);

    // The next word of a place
    function [29:0] after(input [29:0] at, input [5:0] left_out);
        reg unused_carry;
        {after, unused_carry} = {at, 1'b1} + {24'd0, left_out, 1'b1};
    endfunction
    wire run_ends = run_left_q == 6'd1, due_ends = due_left_q == 6'd1;
    always @(posedge clk_i) begin
        if (rst_i) {busy_q, done_q, memory_error_q, refused_q, full_q, second_q, sends_q, fetch_q, more_q, again_q} <= 10'd0;
        else begin
            busy_q <= go || (busy_q && !over);
            if (go) {fetch_q, more_q} <= {fetch, fetch || back || (does && !said_q[TRANSFER_CONTROL_LAST_LO])};
            if (start || repeats) again_q <= back;
            if (start)                {done_q, memory_error_q, refused_q} <= 3'd0;
            else if (busy_q) begin
                done_q <= over && !failed && !fetch_q && !more;
                if (!failed) {memory_error_q, refused_q} <= {bad, (denied || (over && fetch_q && impossible)) && !bad};
            end
            full_q   <= !failed && (second_q || (full_q && !asked) || (reads && !fetch_q));
            second_q <= !failed && full_q && !asked && (second_q || (reads && !fetch_q));
            sends_q  <= sends || (sends_q && !wready_i);
        end
        if (go) begin
            store_q <= !fetch && said[TRANSFER_CONTROL_STORE_LO];
            stay_q  <= waits_for || said[TRANSFER_CONTROL_STAY_LO];
            {wait_q, waited_q, wrong_q, word_number_q} <= {waits_for, 4'd0};
            {otherwise_q, elsewhere_q} <= {said[TRANSFER_CONTROL_OTHERWISE_LO], 1'b0};
            {run_q, skip_q} <= {said[TRANSFER_CONTROL_RUN_HI:TRANSFER_CONTROL_RUN_LO], said[TRANSFER_CONTROL_SKIP_HI:TRANSFER_CONTROL_SKIP_LO]};
        end else begin
            waited_q <= waited_q || comes;
            elsewhere_q <= elsewhere_q || (other && otherwise_q);
            if (fetched) begin
                word_number_q <= word_number_q + 2'd1;
                said_q        <= rdata_i[SAID_W-1:0];
                case (word_number_q)
                    2'd2:    wrong_q <= wrong_q || |rdata_i[31:WORDS_W];
                    2'd3:    wrong_q <= wrong_q || !possible;
                    default: wrong_q <= wrong_q || |rdata_i[1:0];
                endcase
            end
        end
        if (!full_q || asked) word_q <= second_q ? second_word_q : rdata_i;
        if (!second_q)        second_word_q <= rdata_i;
        if (sends) {sent_q, strobe_q, last_q} <= {waiting, !failed, &memory_q[9:2] || words_q == {{WORDS_W-1{1'b0}}, 1'b1}};
        if (!failed) error_q <= bad ? (fetch_q ? next_q + {28'hfffffff, word_number_q} : store_q ? oldest_q : memory_q) : fetch_q ? place_q : due_q;
        rests_q  <= rests && busy_q && !go;
        strays_q <= said_q[TRANSFER_CONTROL_AGAIN_LO] && again_q && again_at_q != next_q;
        if (repeats) {again_left_q, again_at_q} <= {again_left - {{WORDS_W-1{1'b0}}, 1'b1}, next_q};

        if (set && ask_register_i == MEMORY) memory_q <= ask_wdata_i[31:2];
        else if (fetched && word_number_q == 2'd0) memory_q <= rdata_i[31:2];
        else if (moves && !fetch_q)          memory_q <= memory_q + 30'd1;
        if (set && ask_register_i == WORDS)  words_q <= ask_wdata_i[WORDS_W-1:0];
        else if (fetched && word_number_q == 2'd2) words_q <= rdata_i[WORDS_W-1:0];
        else if (moves && !fetch_q)          words_q <= words_q - {{WORDS_W-1{1'b0}}, 1'b1};
        if (set && ask_register_i == PLACE)  place_q <= ask_wdata_i[31:2];
        else if (fetched && word_number_q == 2'd1) place_q <= rdata_i[31:2];
        else if (asked && !stay_q)           place_q <= after(place_q, skip_q & {6{run_ends}});
        if (go)                              due_q <= place_q;
        else if (answered_i && !stay_q)      due_q <= after(due_q, skip_q & {6{due_ends}});
        if (go) {run_left_q, due_left_q} <= {2{said[TRANSFER_CONTROL_RUN_HI:TRANSFER_CONTROL_RUN_LO]}};
        else begin
            if (asked)      run_left_q <= run_ends ? run_q : run_left_q - 6'd1;
            if (answered_i) due_left_q <= due_ends ? run_q : due_left_q - 6'd1;
        end
        fetches_q <= go && fetch;
        if (go && fetch)                     next_q <= first;
        else if (back)                       next_q <= memory_q;
        else                                 next_q <= behind;
        if (go)                              ask_left_q <= repeats ? {WORDS_W{1'b0}} : words_q;
        else if (asked)                      ask_left_q <= ask_left_q - {{WORDS_W-1{1'b0}}, 1'b1};

        if (!busy_q)      owed_q <= {OWED_W{1'b0}};
        else              owed_q <= owed_q + (taken ? {{OWED_W-8{1'b0}}, length} + {{OWED_W-1{1'b0}}, 1'b1} : {OWED_W{1'b0}})
                                           - {{OWED_W-1{1'b0}}, moves};
        if (!busy_q)      bursts_q <= {BURSTS_W+1{1'b0}};
        else if ((taken && store_q) != closes) bursts_q <= closes ? bursts_q - 1'b1 : bursts_q + 1'b1;
        if (go)           oldest_q <= memory_q;
        else if (closes)  oldest_q <= {oldest_q[31:10] + 22'd1, 8'd0};
    end
    wire unused = answers_idle;
endmodule
`default_nettype wire
