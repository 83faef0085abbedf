// transfer_spec: the promises of fp3_transfer.v, for a host that asks for its registers in any cycle, a memory that keeps to the rules of
// AXI and a processor that answers what it was asked, as late as they like.
//
// The spec counts what is on its way, and follows one word of a transfer, whichever (k): it goes to its place or its address, once, with the
// data it came with. It sees when the module says that a part of its work is over (`over`), and asserts that it is.
`default_nettype none
module transfer_spec #(
    parameter WORDS_W = 24,
    parameter READS_W = 1,
    parameter LEMMAS  = 1
) (
    input wire        clk_i,
    input wire        rst_i,
    input wire        ask_i, ask_write_i,
    input wire [2:0]  ask_register_i,
    input wire [31:0] ask_wdata_i,
    input wire        req_ready_i, answered_i, answer_error_i,
    input wire [31:0] answer_rdata_i,
    input wire [5:0]  others_i,        // the host's requests under way
    input wire        awready_i, arready_i, wready_i, bvalid_i, berror_i, rvalid_i, rerror_i,
    input wire [31:0] rdata_i
);
    localparam OPEN_W = 6, C = WORDS_W;
    localparam BOUND = 5;              // cycles in which nothing happens though nobody is waited for
    localparam [C-1:0] ONE = 1;
    localparam [2:0] MEMORY = 0, PLACE = 1, WORDS = 2, CONTROL = 3, OUTCOME = 4, ERROR = 5, NEXT = 6;

    wire              told, told_write, told_error, req_valid, req_write, awvalid, arvalid, wvalid, strobe, wlast, bready, rready;
    wire [31:0]       told_rdata, req_wdata, wdata;
    wire [31:2]       req_place, address;
    wire [7:0]        length;
    reg  [OPEN_W-1:0] open_q;          // of ours
    wire [OPEN_W-1:0] open = open_q != 0 ? open_q : others_i;
    fp3_transfer #(.WORDS_W(WORDS_W), .READS_W(READS_W), .OPEN_W(OPEN_W)) u_transfer (.clk_i(clk_i), .rst_i(rst_i),
        .ask_i(ask_i), .ask_write_i(ask_write_i), .ask_register_i(ask_register_i), .ask_wdata_i(ask_wdata_i),
        .told_o(told), .told_write_o(told_write), .told_error_o(told_error), .told_rdata_o(told_rdata),
        .req_valid_o(req_valid), .req_ready_i(req_ready_i), .req_write_o(req_write), .req_place_o(req_place), .req_wdata_o(req_wdata),
        .answered_i(answered_i), .answer_error_i(answer_error_i), .answer_rdata_i(answer_rdata_i), .open_i(open),
        .awvalid_o(awvalid), .awready_i(awready_i), .arvalid_o(arvalid), .arready_i(arready_i), .address_o(address), .length_o(length),
        .wvalid_o(wvalid), .wready_i(wready_i), .wdata_o(wdata), .wstrobe_o(strobe), .wlast_o(wlast),
        .bvalid_i(bvalid_i), .bready_o(bready), .berror_i(berror_i),
        .rvalid_i(rvalid_i), .rready_o(rready), .rdata_i(rdata_i), .rerror_i(rerror_i));
    (* hierconn *) wire \u_transfer.over ;
    wire over_said = \u_transfer.over ;

    wire         aw = awvalid && awready_i, ar = arvalid && arready_i, w = wvalid && wready_i, b = bvalid_i && bready, r = rvalid_i && rready;
    wire         taken = req_valid && req_ready_i, burst = aw || ar;
    wire [C-1:0] beats = length + 1'b1;

    // What is done: one transfer, a wait, or a descriptor that comes. Of a list there may be more.
    reg          busy_q, fetch_q, store_q, wait_q, stay_q, more_q;
    reg          done_q, memory_error_q, refused_q;
    reg  [31:2]  error_q;
    wire         failed = memory_error_q || refused_q;
    wire         load   = !fetch_q && !store_q && !wait_q;
    // The registers, as the host or a descriptor set them, on the way; the host has set them
    reg  [31:2]  memory_q, place_q, next_q;
    reg  [C-1:0] words_q;
    reg          memory_set_q, place_set_q, words_set_q, next_set_q;
    // Of the part: where it begins, and how many words; of these asked of memory, moved there, asked of the processor, answered by it
    reg  [31:2]  base_q;
    reg  [C-1:0] size_q, bursts_of_q, moved_q, asked_q, answered_q;
    reg  [31:2]  from_q, last_q, answer_place_q;           // the next burst, the last word of the burst before, the next answer
    reg  [C-1:0] left_q;                                   // words that no burst has asked for
    reg  [C-1:0] burst_q, closed_q, response_q;            // bursts: asked for, with their last word sent, with a response
    reg  [9:0]   due_q;                                    // words of bursts that memory has taken
    reg          came_q;                                   // the word that a wait is for
    reg          may_q, other_q;                           // ... may be another one than was said, and is: the list goes on at memory_q
    // A descriptor
    reg  [21:0]  said_q;
    reg          wrong_q;
    // Going back: a part is made again, how often after this, and where its descriptor ends; words of a record, and those left out
    reg          again_q;
    reg  [C-1:0] again_left_q;
    reg  [31:2]  again_at_q;
    reg  [5:0]   run_q, skip_q, run_left_q, due_left_q;
    wire         strays = said_q[6] && again_q && again_at_q != next_q;

    // One word
    (* anyconst *) wire [C-1:0] k;
    reg          there_q, bad_q, inside_q;                 // it has come, and is refused; a burst has it
    reg  [31:0]  kept_q;
    reg  [C-1:0] end_q;                                    // the last word of that burst

    function one_of(input [4:0] bits);
        one_of = bits == 5'd1 || bits == 5'd2 || bits == 5'd4 || bits == 5'd8 || bits == 5'd16;
    endfunction
    wire [3:0] commands = {ask_wdata_i[4:3], ask_wdata_i[1:0]};
    wire [31:C] beyond  = ask_wdata_i[31:C];
    wire legal  = ask_write_i ? !busy_q && (ask_register_i == CONTROL ? one_of({1'b0, commands}) && !ask_wdata_i[6] && !ask_wdata_i[7]
                                : ask_register_i == WORDS ? beyond == 0 : ask_register_i <= PLACE && ask_wdata_i[1:0] == 2'd0)
                              : ask_register_i != CONTROL && ask_register_i <= NEXT;
    wire start  = ask_i && ask_write_i && legal && ask_register_i == CONTROL;
    wire lists  = ask_wdata_i[4];
    wire set    = ask_i && ask_write_i && legal && ask_register_i != CONTROL;
    // The part is over: another descriptor, what a descriptor says, or all
    wire over   = busy_q && over_said;
    wire wrong  = over && fetch_q && (wrong_q || strays) && !failed;
    wire more   = more_q || other_q;
    wire next   = over && !failed && !fetch_q && more;
    wire does   = over && !failed && fetch_q && !wrong_q && !strays;
    wire repeats = does && said_q[6];
    wire [C-1:0] again_left = again_q ? again_left_q : words_q;
    wire back   = repeats && again_left != 0;
    wire begins = start || next || does;
    wire fetches = (start && lists) || next;
    wire [21:0] said  = does ? said_q : ask_wdata_i[21:0];
    wire [31:2] first = next && !other_q ? next_q : memory_q;
    wire [C-1:0] count = fetches ? 4 : said[3] || repeats ? {C{1'b0}} : words_q;

    // Where burst n of the part begins
    function [31:2] start_of(input [31:2] base, input [C-1:0] n);
        start_of = n == 0 ? base : {base[31:10] + n[21:0], 8'd0};
    endfunction
    wire bad    = busy_q && ((r && rerror_i) || (b && berror_i));
    wire ends   = answered_i && wait_q && !answer_rdata_i[0];
    wire other  = ends && answer_rdata_i != {{32-C{1'b0}}, words_q};
    wire denied = busy_q && answered_i && (answer_error_i || (other && !may_q));

    reg started_q = 1'b0, reset_q, failed_2_q;
    reg burst_held_q, w_held_q, store_held_q;
    reg [37:0] burst_what_q;
    reg [33:0] w_what_q;
    reg        asked_before_q, asked_write_q, asked_legal_q;
    reg [2:0]  stall_q;
    wire awaited = awvalid || arvalid || wvalid || req_valid || (due_q != 0 && !store_q) || closed_q != response_q || open != 0;
    always @(posedge clk_i) begin
        {started_q, reset_q} <= {1'b1, rst_i};
        failed_2_q   <= failed && busy_q && !rst_i;
        burst_held_q <= (awvalid && !awready_i) || (arvalid && !arready_i);
        w_held_q     <= wvalid && !wready_i;
        store_held_q <= awvalid;
        burst_what_q <= {address, length};
        w_what_q     <= {wdata, strobe, wlast};
        asked_before_q <= ask_i && !rst_i;
        {asked_write_q, asked_legal_q} <= {ask_write_i, legal};
        stall_q      <= rst_i || !busy_q || awaited ? 3'd0 : stall_q + 1'b1;
        if (rst_i) begin
            {busy_q, fetch_q, more_q, done_q, memory_error_q, refused_q, again_q} <= 7'd0;
            {memory_set_q, place_set_q, words_set_q, next_set_q} <= 4'd0;
            open_q <= {OPEN_W{1'b0}};
            due_q  <= 10'd0;
            {bursts_of_q, moved_q, asked_q, answered_q, burst_q, closed_q, response_q, left_q} <= {8*C{1'b0}};
        end else begin
            open_q <= open_q + taken - answered_i;
            due_q  <= due_q + (burst ? {2'd0, length} + 1'b1 : 10'd0) - (r || w);
            if (start) {busy_q, done_q, memory_error_q, refused_q} <= 4'b1000;
            else if (busy_q) begin
                busy_q <= !over || begins;
                done_q <= over && !failed && !fetch_q && !more;
                if (!failed) {memory_error_q, refused_q} <= {bad, (denied || wrong) && !bad};
            end
            if (begins) begin
                {fetch_q, store_q, wait_q, stay_q} <= {fetches, !fetches && said[1], !fetches && said[3], !fetches && (said[2] || said[3])};
                more_q <= fetches || back || (does && !said_q[5]);
                {run_q, skip_q, run_left_q, due_left_q} <= {said[13:8], said[21:16], {2{said[13:8]}}};
                if (start || repeats) again_q <= back;
                if (repeats) {again_left_q, again_at_q} <= {again_left - ONE, next_q};
                if (back) next_q <= memory_q;
                {base_q, from_q, size_q, left_q, answer_place_q} <= {first, first, count, count, place_q};
                {bursts_of_q, moved_q, asked_q, answered_q, burst_q, closed_q, response_q} <= {7*C{1'b0}};
                {there_q, inside_q, came_q, wrong_q, bad_q} <= 5'd0;
                {may_q, other_q} <= {does && said_q[7], 1'b0};
                if (fetches) {next_q, next_set_q} <= {first + 30'd4, 1'b1};
            end else begin
                if (burst) begin
                    {from_q, left_q, bursts_of_q, burst_q} <= {from_q + {{30-C{1'b0}}, beats}, left_q - beats, bursts_of_q + beats, burst_q + ONE};
                    last_q <= from_q + {22'd0, length};
                    if (k >= bursts_of_q && k - bursts_of_q < beats) {inside_q, end_q} <= {1'b1, bursts_of_q + {{C-8{1'b0}}, length}};
                end
                if (w && wlast) closed_q <= closed_q + ONE;
                if (b)          response_q <= response_q + ONE;
                if (r || w)     moved_q <= moved_q + ONE;
                if (taken)      {asked_q, run_left_q} <= {asked_q + ONE, run_left_q == 6'd1 ? run_q : run_left_q - 6'd1};
                if (answered_i) begin
                    answered_q <= answered_q + ONE;
                    due_left_q <= due_left_q == 6'd1 ? run_q : due_left_q - 6'd1;
                    if (!stay_q) answer_place_q <= answer_place_q + 30'd1 + (due_left_q == 6'd1 ? skip_q : 6'd0);
                    came_q <= came_q || ends;
                    other_q <= other_q || (other && may_q);
                end
                if (load && r && moved_q == k)                    {there_q, kept_q, bad_q} <= {1'b1, rdata_i, rerror_i};
                if (store_q && answered_i && answered_q == k)     {there_q, kept_q, bad_q} <= {1'b1, answer_rdata_i, answer_error_i};
                if (r && fetch_q) begin
                    said_q <= rdata_i[21:0];
                    case (moved_q[1:0])
                        2'd2:    wrong_q <= wrong_q || rdata_i[31:C] != 0;
                        2'd3:    wrong_q <= wrong_q || !one_of({rdata_i[6], rdata_i[4:3], rdata_i[1:0]}) || rdata_i[4] || (rdata_i[7] && !rdata_i[3]);
                        default: wrong_q <= wrong_q || rdata_i[1:0] != 0;
                    endcase
                end
            end
            if (!failed) error_q <= bad ? (fetch_q ? base_q + {28'd0, moved_q[1:0]} : store_q ? start_of(base_q, response_q) : memory_q)
                                        : fetch_q ? place_q : answer_place_q;
            // The registers
            if (set && ask_register_i == MEMORY)              {memory_q, memory_set_q} <= {ask_wdata_i[31:2], 1'b1};
            else if (r && fetch_q && moved_q[1:0] == 2'd0)    {memory_q, memory_set_q} <= {rdata_i[31:2], 1'b1};
            else if ((r || w) && !fetch_q)                    memory_q <= memory_q + 30'd1;
            if (set && ask_register_i == PLACE)               {place_q, place_set_q} <= {ask_wdata_i[31:2], 1'b1};
            else if (r && fetch_q && moved_q[1:0] == 2'd1)    {place_q, place_set_q} <= {rdata_i[31:2], 1'b1};
            else if (taken && !stay_q)                        place_q <= place_q + 30'd1 + (run_left_q == 6'd1 ? skip_q : 6'd0);
            if (set && ask_register_i == WORDS)               {words_q, words_set_q} <= {ask_wdata_i[C-1:0], 1'b1};
            else if (r && fetch_q && moved_q[1:0] == 2'd2)    {words_q, words_set_q} <= {rdata_i[C-1:0], 1'b1};
            else if ((r || w) && !fetch_q)                    words_q <= words_q - ONE;
        end
    end
    wire follows = started_q && !reset_q;

    // What the host, the processor and memory do -------------------------------------------------------
    always @* begin
        assume (started_q || rst_i);
        assume (!start || (memory_set_q && (lists || (place_set_q && words_set_q))));
        assume (!answered_i || (started_q && open_q != 0));
        assume (!req_ready_i || (open != {OPEN_W{1'b1}} && (open_q != 0 || others_i == 0)));      // its turn
        assume (!rvalid_i || (started_q && due_q != 0 && !store_q));
        assume (!bvalid_i || (started_q && closed_q != response_q));
    end

    // The promises -------------------------------------------------------------------------------------
    reg        checks_q;                                   // what is shown is the expected word
    reg [31:0] shown_q;
    always @(posedge clk_i) begin
        checks_q <= 1'b0;
        shown_q  <= 32'd0;
        case (ask_register_i)
            MEMORY:  {checks_q, shown_q} <= {!busy_q && memory_set_q, memory_q, 2'd0};
            PLACE:   {checks_q, shown_q} <= {!busy_q && place_set_q, place_q, 2'd0};
            WORDS:   {checks_q, shown_q} <= {!busy_q && words_set_q, {32-C{1'b0}}, words_q};
            OUTCOME: {checks_q, shown_q} <= {1'b1, 28'd0, refused_q && !busy_q, memory_error_q && !busy_q, done_q && !busy_q, busy_q};
            ERROR:   {checks_q, shown_q} <= {!busy_q, failed ? {error_q, 2'd0} : 32'd0};
            NEXT:    {checks_q, shown_q} <= {next_set_q, next_q, 2'd0};
            default: {checks_q, shown_q} <= {1'b1, 32'd0};
        endcase
    end
    always @* if (follows) begin
        // The host's accesses
        assert (told == asked_before_q);
        if (told) assert (told_write == asked_write_q && told_error == !asked_legal_q);
        if (told && !told_write && !told_error && checks_q) assert (told_rdata == shown_q);
        if (told && (told_write || told_error)) assert (told_rdata == 32'd0);
        // Nothing but for what was asked for; each word once, and in order
        assert (busy_q || !(awvalid || arvalid || wvalid || req_valid || due_q != 0 || closed_q != response_q || open_q != 0));
        assert (!(awvalid && arvalid));
        if (awvalid) assert (store_q);
        if (arvalid) assert (!store_q && !wait_q);
        if (awvalid || arvalid) begin
            assert (address == from_q && address == start_of(base_q, burst_q) && beats <= left_q);
            assert ({1'b0, address[9:2]} + {1'b0, length} <= 9'd255);
            assert ({1'b0, address[9:2]} + {1'b0, length} == 9'd255 || beats == left_q);
            assert (!failed_2_q || burst_held_q);                 // none after an error
        end
        if (burst_held_q) assert ((awvalid || arvalid) && awvalid == store_held_q && {address, length} == burst_what_q);
        if (w_held_q)     assert (wvalid && {wdata, strobe, wlast} == w_what_q);
        if (wvalid) begin
            assert (store_q && due_q != 0 && moved_q < size_q);   // a burst for it is taken
            if (moved_q == k) assert (inside_q && wlast == (k == end_q));
            if (moved_q == k && strobe) assert (there_q && !bad_q && wdata == kept_q);
            if (strobe) assert (!failed_2_q || w_held_q);         // no word after an error
            if (!strobe) assert (failed);
        end
        if (req_valid) begin
            assert (!failed && !fetch_q && req_place == place_q);
            assert (req_write == load && (wait_q || asked_q < size_q));
            if (load && asked_q == k) assert (there_q && !bad_q && req_wdata == kept_q);
            if (wait_q) assert (open == 0 && !came_q);
        end
        assert (bready);
        if (due_q != 0 && !store_q && !rready) assert (load && (moved_q - asked_q == 2 || failed) && !failed_2_q);    // two words wait
        // A part is over
        if (over) begin
            assert (due_q == 0 && burst_q == response_q || (due_q == 0 && !store_q));
            assert (open_q == 0 && !awvalid && !arvalid && !wvalid && !req_valid);
            if (!failed) begin
                assert (left_q == 0 && (wait_q || moved_q == size_q));
                if (load || store_q) assert (asked_q == size_q && answered_q == size_q);
                if (wait_q) assert (came_q);
            end
        end
        // No hang: if nobody is waited for, something happens
        assert (stall_q <= BOUND);
        // What is on its way is bounded
        assert (moved_q <= size_q && bursts_of_q <= size_q && (wait_q || asked_q <= size_q) && due_q <= 10'd512);
    end
    always @* if (started_q && reset_q) assert (!awvalid && !arvalid && !wvalid && !req_valid && !told);

    // The registers of the module ----------------------------------------------------------------------
    localparam N = 1 << READS_W;
    (* hierconn *) wire \u_transfer.busy_q , \u_transfer.fetch_q , \u_transfer.store_q , \u_transfer.wait_q , \u_transfer.stay_q , \u_transfer.more_q ;
    (* hierconn *) wire \u_transfer.done_q , \u_transfer.memory_error_q , \u_transfer.refused_q , \u_transfer.wrong_q , \u_transfer.waited_q ;
    (* hierconn *) wire \u_transfer.otherwise_q , \u_transfer.elsewhere_q ;
    (* hierconn *) wire \u_transfer.full_q , \u_transfer.second_q , \u_transfer.sends_q , \u_transfer.strobe_q , \u_transfer.last_q ;
    (* hierconn *) wire [1:0]   \u_transfer.word_number_q ;
    (* hierconn *) wire [5:0]   \u_transfer.bursts_q , \u_transfer.run_q , \u_transfer.skip_q , \u_transfer.run_left_q , \u_transfer.due_left_q ;
    (* hierconn *) wire [21:0]  \u_transfer.said_q ;
    (* hierconn *) wire         \u_transfer.fetches_q , \u_transfer.rests_q , \u_transfer.strays_q , \u_transfer.again_q ;
    (* hierconn *) wire [31:2]  \u_transfer.again_at_q , \u_transfer.due_q ;
    (* hierconn *) wire [C-1:0] \u_transfer.again_left_q ;
    (* hierconn *) wire [9:0]   \u_transfer.owed_q ;
    (* hierconn *) wire [31:2]  \u_transfer.error_q , \u_transfer.next_q , \u_transfer.memory_q , \u_transfer.place_q , \u_transfer.oldest_q ;
    (* hierconn *) wire [31:2]  \u_transfer.u_bursts.address_q ;
    (* hierconn *) wire [C-1:0] \u_transfer.words_q , \u_transfer.ask_left_q , \u_transfer.u_bursts.left_q ;
    (* hierconn *) wire [31:0]  \u_transfer.word_q , \u_transfer.second_word_q , \u_transfer.sent_q ;
    (* hierconn *) wire         \u_transfer.u_answers.room_q , \u_transfer.u_bursts.valid_q ;
    (* hierconn *) wire [7:0]   \u_transfer.u_bursts.length_q ;
    (* hierconn *) wire [READS_W:0] \u_transfer.u_answers.gone_q , \u_transfer.u_answers.filled_q , \u_transfer.u_answers.taken_q ;
    (* hierconn *) wire [32*N-1:0]  \u_transfer.u_answers.values ;
    wire               sends = \u_transfer.sends_q , full = \u_transfer.full_q , second = \u_transfer.second_q ;
    wire [C-1:0]       sent  = moved_q + sends;            // words that have left the answers
    wire [READS_W:0]   kept    = \u_transfer.u_answers.gone_q - \u_transfer.u_answers.taken_q ;
    wire [READS_W:0]   filled  = \u_transfer.u_answers.filled_q - \u_transfer.u_answers.taken_q ;
    wire [READS_W:0]   flying  = \u_transfer.u_answers.gone_q - \u_transfer.u_answers.filled_q ;
    wire [READS_W-1:0] spot    = \u_transfer.u_answers.taken_q [READS_W-1:0] + (k[READS_W-1:0] - sent[READS_W-1:0]);
    wire [31:0]        value   = \u_transfer.u_answers.values >> 32 * spot;
    wire [7:0]         low_k   = base_q[9:2] + k[7:0];
    // Cycles that are left until something happens, this one included
    wire         bare = \u_transfer.u_bursts.left_q != 0 || full;
    wire [2:0]   rest = !over_said ? (failed ? (bare ? 3'd3 : 3'd2) : fetch_q && moved_q == 4 ? 3'd5 : bare ? 3'd1 : 3'd3)
                                   : failed || (fetch_q && (wrong_q || strays)) ? 3'd1 : fetch_q ? 3'd4 : more ? 3'd2 : 3'd1;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                if (busy_q && !awaited) assert (stall_q + rest <= BOUND);
                assert (\u_transfer.busy_q == busy_q && \u_transfer.fetch_q == fetch_q && \u_transfer.more_q == more_q);
                assert (\u_transfer.done_q == done_q && \u_transfer.memory_error_q == memory_error_q && \u_transfer.refused_q == refused_q);
                assert (!done_q || (!busy_q && !failed));
                if (busy_q) assert (\u_transfer.again_q == again_q);
                if (busy_q && again_q) assert (\u_transfer.again_left_q == again_left_q && \u_transfer.again_at_q == again_at_q && next_set_q);
                assert (!(memory_error_q && refused_q));
                if (memory_set_q) assert (\u_transfer.memory_q == (sends ? memory_q + 30'd1 : memory_q));
                if (place_set_q)  assert (\u_transfer.place_q == place_q);
                if (words_set_q)  assert (\u_transfer.words_q == (sends ? words_q - ONE : words_q));
                if (next_set_q)   assert (\u_transfer.next_q + {27'd0, \u_transfer.fetches_q , 2'd0} == next_q);
                if (failed)       assert (\u_transfer.error_q == error_q);
                assert (!fetch_q || (next_set_q && next_q == base_q + 30'd4) || !busy_q);
                if (!busy_q) begin
                    assert (!full && !second && !sends && !awvalid && !arvalid && due_q == 0 && open_q == 0 && closed_q == response_q);
                    assert (\u_transfer.u_bursts.left_q == 0 && (\u_transfer.owed_q == 0 || reset_q));
                end
                if (reset_q) assert (!busy_q && !failed && filled == 0 && bursts_of_q == 0 && moved_q == 0 && asked_q == 0);
                if (busy_q) begin
                    if (\u_transfer.fetches_q ) assert (fetch_q && moved_q == 0 && \u_transfer.owed_q == 0 && !\u_transfer.rests_q );
                    assert (memory_set_q && (fetch_q || (place_set_q && words_set_q)));
                    assert (\u_transfer.store_q == store_q && \u_transfer.wait_q == wait_q && (fetch_q || \u_transfer.stay_q == stay_q));
                    assert (!(fetch_q && (store_q || wait_q)) && !(store_q && wait_q) && (!more_q || next_set_q));
                    assert (\u_transfer.waited_q == came_q || !wait_q);
                    assert (\u_transfer.otherwise_q == may_q || !wait_q);
                    assert (\u_transfer.elsewhere_q == other_q && (!other_q || (wait_q && came_q && may_q)));
                    // Bursts
                    if (\u_transfer.u_bursts.left_q != 0) assert (\u_transfer.u_bursts.left_q == left_q && \u_transfer.u_bursts.address_q == from_q);
                    assert (\u_transfer.u_bursts.left_q == left_q || failed);
                    assert (bursts_of_q <= size_q && left_q == size_q - bursts_of_q);
                    if (left_q != 0) assert (from_q == start_of(base_q, burst_q) && from_q[9:2] == base_q[9:2] + bursts_of_q[7:0]);
                    assert (burst_q <= bursts_of_q);
                    if (awvalid || arvalid) assert (\u_transfer.u_bursts.left_q != 0 && due_q - sends <= 10'd255 && (!store_q || burst_q - response_q < 32));
                    assert (moved_q <= bursts_of_q && bursts_of_q - moved_q == due_q);
                    if (!store_q) assert (burst_q[21:0] <= 22'h3fffff && !sends && closed_q == 0 && response_q == 0 && \u_transfer.bursts_q == 0);
                    if (fetch_q) assert (size_q == 4 && \u_transfer.word_number_q == moved_q[1:0] && !full && asked_q == 0 && answered_q == 0 && open_q == 0);
                    if (fetch_q && moved_q != 0) assert (\u_transfer.wrong_q == wrong_q && \u_transfer.said_q == said_q);
                    if (fetch_q && moved_q == 0) assert (!\u_transfer.wrong_q && !wrong_q);
                    if (fetch_q && moved_q == 4 && !wrong_q) assert (one_of({said_q[6], said_q[4:3], said_q[1:0]}) && !said_q[4] && (said_q[3] || !said_q[7]));
                    if (fetch_q && moved_q > 1) assert (place_set_q);
                    if (fetch_q && moved_q > 2) assert (words_set_q);
                    if (wait_q) assert (size_q == 0 && open_q <= 1 && !full && stay_q);
                    if (wait_q && open_q != 0) assert (!came_q);
                    // The processor
                    if (!fetch_q) assert (\u_transfer.due_q == answer_place_q && \u_transfer.run_q == run_q && \u_transfer.skip_q == skip_q
                                          && \u_transfer.run_left_q == run_left_q && \u_transfer.due_left_q == due_left_q);
                    if (\u_transfer.rests_q ) begin
                        assert (left_q == 0 || failed);
                        assert (!awvalid && !arvalid && \u_transfer.u_bursts.left_q == 0 && due_q == 0 && burst_q - response_q == (store_q ? 0 : burst_q) && !full && !sends);
                        if (fetch_q) assert (moved_q != 0 || failed);
                        if (!failed && !wait_q) assert (moved_q == size_q && (fetch_q || (asked_q == size_q && answered_q == size_q)));
                        if (fetch_q && !failed) assert (\u_transfer.strays_q == strays);
                        if (!wait_q || came_q) assert (open_q == 0);
                    end
                    if (load || store_q) assert (asked_q <= size_q && answered_q <= asked_q && asked_q - answered_q == open_q && \u_transfer.ask_left_q == size_q - asked_q);
                    // A load
                    assert (\u_transfer.owed_q == (store_q ? due_q - sends : due_q));
                    if (load) assert (asked_q <= moved_q && (failed || moved_q == asked_q + full + second));
                    if (load) assert (there_q == (moved_q > k));
                    if (load && there_q && bad_q) assert (failed);
                    assert (!second || full);
                    if (load && full && !failed && asked_q == k) assert (\u_transfer.word_q == kept_q);
                    if (load && second && !failed && asked_q + ONE == k) assert (\u_transfer.second_word_q == kept_q);
                    // A store
                    if (store_q) begin
                        assert (!full && \u_transfer.bursts_q == burst_q - response_q && burst_q - response_q <= 32 && response_q <= closed_q && closed_q <= burst_q);
                        assert (!sends || due_q != 0);
                        assert (words_q == size_q - moved_q && memory_q[9:2] == base_q[9:2] + moved_q[7:0]);
                        if (moved_q < size_q) assert (memory_q[31:10] == base_q[31:10] + closed_q[21:0] && (closed_q == 0 || closed_q <= moved_q));
                        if (due_q == 0) assert (closed_q == burst_q);
                        if (due_q == 0 && left_q != 0) assert (memory_q == from_q);
                        if (due_q != 0) assert (last_q == memory_q + {20'd0, due_q} - 30'd1 && last_q[31:10] + 22'd1 == base_q[31:10] + burst_q[21:0]);
                        if (due_q != 0) assert (last_q[9:2] == 8'hff || left_q == 0);
                        assert (\u_transfer.oldest_q == start_of(base_q, response_q));
                        assert (inside_q == (bursts_of_q > k));
                        if (inside_q) assert (end_q >= k && end_q < size_q && (k == end_q) == (low_k == 8'hff || k == size_q - ONE));
                        if (sends) assert (\u_transfer.last_q == (memory_q[9:2] == 8'hff || words_q == ONE));
                        assert (there_q == (answered_q > k));
                        if (there_q && bad_q) assert (failed);
                        if (!failed) begin
                            assert (sent <= answered_q && filled == answered_q - sent && flying == open_q && kept <= N && filled <= kept);
                            assert (!\u_transfer.u_answers.room_q || kept < N);
                            if (there_q && k >= sent) assert (value == kept_q);
                        end
                        if (sends && \u_transfer.strobe_q ) assert (moved_q < answered_q);
                        if (sends && \u_transfer.strobe_q && moved_q == k) assert (\u_transfer.sent_q == kept_q && !bad_q);
                        if (sends && !\u_transfer.strobe_q ) assert (failed);
                    end else if (!failed)
                        assert (kept == 0 && filled == 0);
                end
            end
        end
    endgenerate
endmodule
`default_nettype wire
