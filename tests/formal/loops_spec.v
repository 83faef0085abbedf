// loops_spec: the promises of fp3_loops.v, for each program whose loops are not nested and in which no phase ends within a loop.
`default_nettype none
`include "front/decoded.vh"
`include "gen/settings.vh"
`include "lane/bundles.vh"
module loops_spec #(
    parameter LEMMAS = 1,
    parameter LATE   = 3,                                  // cycles from the last `raised_i` to the next round, at least
`include "config/config.vh"
) (
    input wire                       clk_i,
    input wire                       rst_i,
    input wire                       start_i, abort_i, open_i, round_end_i, raised_i,
    input wire [`FP3_SETTINGS_W-1:0] settings_i,
    input wire                       take_i, ends_i, more_i, still_i,
    input wire [`FP3_DECODED_W-1:0]  decoded_i,
    input wire [PROGRAM_W-1:0]       pc_i,
    input wire [LENGTH_W-1:0]        longest_i
);
    localparam WAIT = LANES + GROUPS + TIMING_LIST;        // cycles in which nothing issues, until all have told their longest list
    localparam WAIT_W = $clog2(WAIT + 1);
    localparam [WAIT_W-1:0] WAIT_R = WAIT;
    `FP3_DECODED_FIELDS
    `FP3_SETTINGS_FIELDS
    `FP3_AROUND_FIELDS
    assign `FP3_DECODED  = decoded_i;
    assign `FP3_SETTINGS = settings_i;

    wire                 drop, hold, jump, jump_on, jump_begins, partial, held, half;
    wire [PROGRAM_W-1:0] jump_pc;
    wire [AROUND_W-1:0]  around;
    assign `FP3_AROUND = around;
    fp3_loops #(.CONFIG(CONFIG), .TIMING_LIST(TIMING_LIST)) u_loops (.clk_i(clk_i), .rst_i(rst_i), .start_i(start_i), .abort_i(abort_i), .settings_i(settings_i),
        .open_i(open_i), .round_end_i(round_end_i), .raised_i(raised_i), .take_i(take_i), .decoded_i(decoded_i), .pc_i(pc_i), .ends_i(ends_i),
        .more_i(more_i), .drop_o(drop), .around_o(around), .hold_o(hold), .still_i(still_i), .longest_i(longest_i),
        .jump_o(jump), .jump_on_o(jump_on), .jump_begins_o(jump_begins), .jump_pc_o(jump_pc),
        .partial_o(partial), .held_o(held), .half_o(half));

    // A loop: its first word, its turns, and how far an entry's fields go
    reg                  started_q = 1'b0, run_q, round_q; // a run; a round of it has opened, and not ended
    reg                  loop_q, waits_q, told_q;          // in a loop; its length is not known; it was told a cycle ago
    reg [WAIT_W-1:0]     still_q;                          // cycles in a row in which nothing issues
    reg [LENGTH_W-1:0]   length_q, turn_q;
    reg [PROGRAM_W-1:0]  loop_pc_q;
    reg [STORE_W-1:0]    entry_q, load_q, end_q;           // where the entry is in the list, its next field, its end
    wire                 skips = loop_q && !waits_q && length_q == 0;
    wire                 final = turn_q + 1'b1 == length_q;
    wire                 told  = waits_q && still_i && still_q == WAIT_R;
    wire                 of_entry = ldl || stl;
    wire                 by_number = takes || stl;
    wire [STORE_W-1:0]   field = by_number ? entry_q + 1'b1 + b[REGISTER_W-1:0] : load_q;
    wire                 back = take_i && next && !skips && !final;
    // The phases: where this one begins, and the ones that are repeated
    reg [PROGRAM_W-1:0]  phase_q, first_q, there_q;
    reg [REGISTER_W-1:0] left_q;
    reg                  repeats_q, partial_q, half_q;
    reg                  held_q, chooses_q, raised_q;      // with KEEP
    reg                  jump_q, on_q, begins_q;
    reg [PROGRAM_W-1:0]  to_q;
    wire                 over  = take_i && (phase || ends_i) && !back;
    wire                 round = over && !more_i;
    wire                 again = returns && left_q != 0;
    wire [PROGRAM_W-1:0] behind = pc_i + 1'b1;
    wire [PROGRAM_W-1:0] ahead = again ? first_q : ends_i ? {PROGRAM_W{1'b0}} : KEEP != 0 && holds ? behind + d : behind;
    wire                 clear = rst_i || start_i || abort_i;
    always @(posedge clk_i) begin
        started_q <= 1'b1;
        run_q     <= !rst_i && !abort_i && (start_i || run_q);
        round_q   <= !clear && (open_i || (round_q && !round));
        {jump_q, on_q, begins_q} <= clear ? 3'd0 : {back || (over && (more_i || !ends_i)), back || more_i, over};
        to_q      <= back ? loop_pc_q : more_i ? phase_q : ahead;
        told_q    <= told && !clear;
        still_q   <= !clear && waits_q && still_i && !told ? still_q + 1'b1 : {WAIT_W{1'b0}};
        if (clear) begin
            {loop_q, waits_q, partial_q, repeats_q} <= 4'd0;
            phase_q <= {PROGRAM_W{1'b0}};
        end else begin
            if (take_i && each)               {loop_q, waits_q} <= 2'b11;
            else if (take_i && next && !back) loop_q <= 1'b0;
            if (told)                         waits_q <= 1'b0;
            if (round) begin
                phase_q   <= ahead;
                partial_q <= again || !ends_i;
                repeats_q <= repeats || (repeats_q && (!returns || again));
            end else if (chooses_q && (raised_q || raised_i)) phase_q <= there_q;
        end
        if (told) length_q <= longest_i;
        if (take_i && each) {loop_pc_q, turn_q, entry_q, load_q, end_q} <= {behind, {LENGTH_W{1'b0}}, {STORE_W{1'b0}}, {2{{{STORE_W-1{1'b0}}, 1'b1}}}};
        else if (back)      {turn_q, entry_q, load_q, end_q} <= {turn_q + 1'b1, end_q, {2{end_q + 1'b1}}};
        else if (take_i && of_entry && !skips) begin
            if (!by_number)     load_q <= load_q + 1'b1;
            if (field >= end_q) end_q  <= field + 1'b1;
        end
        if (round && repeats)                {first_q, left_q} <= {behind, d - 1'b1};
        else if (round && returns)           left_q <= left_q - 1'b1;
        if (rst_i || start_i || open_i)      {held_q, chooses_q, raised_q} <= 3'd0;
        else if (KEEP != 0) begin
            if (round && holds)              {held_q, chooses_q} <= {1'b1, !ends_i};
            raised_q <= raised_q || raised_i;
        end
        if (round)                           there_q <= behind;
        if (start_i)                         half_q <= setting_half;
        else if (round_end_i && !held_q)     half_q <= !half_q;
    end

    // What software and the sequencer do
    reg         took_q;                                    // a word that issues was taken a cycle ago
    reg [1:0]   since_q;                                   // cycles since an object has raised
    reg [`FP3_SETTINGS_W-1:0] settings_q;
    always @(posedge clk_i) begin
        took_q     <= take_i && !drop;
        since_q    <= raised_i || (round && holds) ? 2'd0 : since_q == LATE ? since_q : since_q + 1'b1;
        settings_q <= settings_i;
    end
    wire [2:0] kinds = {2'd0, each} + next + ldn + of_entry + phase;
    always @* begin
        assume (started_q || rst_i);
        assume (!start_i || !run_q);
        assume (!run_q || settings_i == settings_q);
        assume (!take_i || (run_q && round_q && legal && !hold && !took_q && !start_i));
        assume (!(ldl && stl) && kinds <= 3'd1);
        assume ({2'd0, repeats} + returns + holds <= {2'd0, phase} && (KEEP != 0 || !holds));
        assume (!stl || st);
        assume (!take_i || (loop_q ? !each && !phase && (!ends_i || next) : !next && !of_entry && !(each && ends_i)));
        assume (!returns || repeats_q);
        assume (!open_i || (run_q && !round_q && since_q == LATE && !raised_i));
        assume (!round_end_i || (!round && !start_i));
    end

    wire [63:0]           published = {setting_published_more, setting_published};
    wire [REGISTER_W-1:0] word = ldn ? b[REGISTER_W-1:0] : d;
    wire [5:0]            number = word;
    always @* if (started_q && run_q) begin
        // No word is taken until all lists are told, or fetch has gone elsewhere
        assert (hold == (waits_q || told_q || jump_q));
        if (take_i) begin
            // Whoever has an entry has its turn, and after the last one nobody has
            assert (drop == (skips || phase || (next && final)));
            if (!drop && (each || next)) assert (around_each == each && around_entry && around_turn == (each ? {LENGTH_W{1'b0}} : turn_q + 1'b1));
            if (!drop && next)           assert (around_turn < length_q && around_offset == end_q);
            if (!drop && each)           assert (around_offset == 0);
            if (!drop && of_entry)       assert (around_ldl && around_offset == field && !around_half);
            if (!drop && ldn)            assert (around_ldn);
            if (!drop && !each && !next) assert (!around_entry && !around_each && around_inside == loop_q);
            if (!drop && !each && !next && !ldn && !of_entry) assert (!around_ldn && !around_ldl);
            // Published words: a phase loads from one half and stores in the other
            if (!drop && !of_entry && !each && !next && (to_memory || ldn)) assert (around_offset == word && around_half == (published[number] && half_q != st));
            else if (!drop) assert (!around_half);
        end
        assert (jump == jump_q);
        if (jump) assert ({jump_on, jump_begins} == {on_q, begins_q} && (!on_q || jump_pc == to_q));
        if (open_i) assert (jump_pc == phase_q);
        assert (partial == partial_q && held == held_q);
    end
    always @* if (started_q && run_q) assert (half == half_q);

    (* hierconn *) wire                  \u_loops.inside_q , \u_loops.skips_q , \u_loops.waits_q , \u_loops.knows_q , \u_loops.entry_q , \u_loops.field_q ;
    (* hierconn *) wire                  \u_loops.final_q ;
    (* hierconn *) wire [WAIT_W-1:0]     \u_loops.wait_q ;
    (* hierconn *) wire [LENGTH_W-1:0]   \u_loops.turn_q , \u_loops.turns_q ;
    (* hierconn *) wire [STORE_W-1:0]    \u_loops.fields_q , \u_loops.load_q , \u_loops.end_q , \u_loops.offset_q ;
    (* hierconn *) wire [PROGRAM_W-1:0]  \u_loops.loop_q , \u_loops.phase_q , \u_loops.first_q , \u_loops.target_q ;
    (* hierconn *) wire [REGISTER_W-1:0] \u_loops.left_q ;
    (* hierconn *) wire                  \u_loops.g_hold.held_q , \u_loops.g_hold.chooses_q , \u_loops.g_hold.raised_q ;
    (* hierconn *) wire [PROGRAM_W-1:0]  \u_loops.g_hold.there_q ;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q && run_q) begin
                assert (\u_loops.waits_q == waits_q && \u_loops.knows_q == told_q && \u_loops.inside_q == loop_q);
                assert (\u_loops.skips_q == skips);
                assert (!waits_q || loop_q);
                assert (!(told_q && waits_q) && !(told_q && !loop_q));
                assert (still_q <= WAIT_R && (!waits_q || \u_loops.wait_q == WAIT_R - still_q));
                assert (!took_q || !waits_q || still_q == 0);
                if (loop_q) assert (\u_loops.loop_q == loop_pc_q && \u_loops.turn_q == turn_q);
                if (loop_q && !waits_q) assert (\u_loops.turns_q == length_q);
                if (loop_q && !waits_q && !told_q && !jump_q && !skips) assert (\u_loops.final_q == final && turn_q < length_q);
                if (loop_q && !waits_q && length_q != 0) assert (turn_q < length_q);
                if (loop_q && waits_q) assert (turn_q == 0);
                if (loop_q && \u_loops.entry_q ) assert (\u_loops.offset_q == entry_q && load_q == entry_q + 1'b1 && end_q == load_q);
                if (loop_q && !\u_loops.entry_q ) begin
                    assert (\u_loops.fields_q == entry_q + 1'b1 && \u_loops.load_q == load_q);
                    assert (end_q == (\u_loops.field_q && \u_loops.offset_q >= \u_loops.end_q ? \u_loops.offset_q + 1'b1 : \u_loops.end_q ));
                end
                assert (!(\u_loops.entry_q || \u_loops.field_q ) || took_q);
                if (repeats_q) assert (\u_loops.first_q == first_q && \u_loops.left_q == left_q);
                assert (round_q || !loop_q);
                if (round_q || !chooses_q || !raised_q || since_q > 1) assert (\u_loops.phase_q == phase_q);
                if (!round_q && (!chooses_q || !raised_q || since_q > 1)) assert (\u_loops.target_q == phase_q);
                assert (!(chooses_q || held_q) || (KEEP != 0 && !round_q));
            end
        end
        if (LEMMAS != 0 && KEEP != 0) begin : g_keep
            always @* if (started_q && run_q) begin
                assert (\u_loops.g_hold.held_q == held_q && \u_loops.g_hold.chooses_q == chooses_q && \u_loops.g_hold.raised_q == raised_q);
                if (chooses_q) assert (\u_loops.g_hold.there_q == there_q);
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
