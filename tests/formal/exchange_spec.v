// exchange_spec: the promises of fp3_exchange.v, for every list of copies and all published words. One copy is followed, whichever.
`default_nettype none
`include "gen/settings.vh"
`include "lane/bundles.vh"
module exchange_spec #(
    parameter LEMMAS = 1,
`include "config/config.vh"
) (
    input wire                       clk_i,
    input wire                       rst_i,
    input wire                       write_i, half_i, copy_i, abort_i,
    input wire [STORE_W-1:0]         write_addr_i,
    input wire [31:0]                write_value_i,
    input wire [`FP3_SETTINGS_W-1:0] settings_i
);
`include "gen/registers.vh"
`include "host/lane_host.vh"
    localparam WAY     = TIMING_END + 1 + GROUPS;          // cycles from a word's read to its write
    localparam INDEX_W = STORE_W - 1, FROM_W = LANE_W + ROW_W;
    `FP3_SETTINGS_FIELDS
    `FP3_REACH_FIELDS
    `FP3_AROUND_FIELDS
    `FP3_ACCESS_FIELDS
    assign `FP3_SETTINGS = settings_i;

    wire                     copied, busy;
    wire [`FP3_REACH_W-1:0]  reach;
    wire [`FP3_ACCESS_W-1:0] access;
    assign `FP3_REACH  = reach;
    assign `FP3_AROUND = reach_around;
    assign `FP3_ACCESS = access;
    fp3_exchange #(.CONFIG(CONFIG), .TIMING_END(TIMING_END)) u_exchange (.clk_i(clk_i), .rst_i(rst_i),
        .write_i(write_i), .write_addr_i(write_addr_i), .write_value_i(write_value_i), .settings_i(settings_i), .half_i(half_i),
        .copy_i(copy_i), .abort_i(abort_i), .copied_o(copied), .busy_o(busy), .reach_o(reach), .access_o(access));

    // The list: of one copy, whichever
    (* hierconn *) wire [INDEX_W-1:0] \u_exchange.u_froms.which , \u_exchange.u_tos.which ;
    (* hierconn *) wire [FROM_W-1:0]  \u_exchange.u_froms.kept_q ;
    (* hierconn *) wire [FROM_W:0]    \u_exchange.u_tos.kept_q ;
    wire [INDEX_W-1:0] at = \u_exchange.u_froms.which ;
    wire [INDEX_W:0]   n  = setting_copies[STORE_W:1];
    wire [31:0]        here = write_value_i;
    reg  [FROM_W-1:0]  from_q, to_q;
    reg                every_q;
    always @(posedge clk_i) if (write_i && write_addr_i[STORE_W-1:1] == at) begin
        if (write_addr_i[0]) {every_q, to_q} <= {here[COPIES_EVERY_LO], here[COPIES_LANE_LO +: LANE_W], here[COPIES_ROW_LO +: ROW_W]};
        else                 from_q          <= {here[COPIES_LANE_LO +: LANE_W], here[COPIES_ROW_LO +: ROW_W]};
    end

    // What is still to be copied: each published word of each copy, in order; and what is on its way
    reg                          started_q = 1'b0, copies_q;
    reg  [63:0]                  left_q;
    reg  [INDEX_W-1:0]           next_q;
    reg  [WAY-1:0]               way_q;
    reg  [INDEX_W-1:0]           index_q [0:WAY-1];
    reg  [REGISTER_W-1:0]        word_q [0:WAY-1];
    reg  [2:0]                   idle_q;                   // cycles without a copy, up to 4
    wire                         none = n == 0;
    wire                         last = next_q + 1'b1 == n;
    wire                         clear = rst_i || abort_i;
    integer                      k;
    always @(posedge clk_i) begin
        started_q <= 1'b1;
        copies_q  <= !clear && (copy_i || (copies_q && !copied));
        if (copy_i)                   {left_q, next_q} <= {setting_published_more, setting_published, {INDEX_W{1'b0}}};
        else if (reach_copy && !last) next_q           <= next_q + 1'b1;
        else if (reach_copy)          {left_q, next_q} <= {left_q & (left_q - 1'b1), {INDEX_W{1'b0}}};
        way_q <= clear ? {WAY{1'b0}} : {way_q[WAY-2:0], reach_copy};
        for (k = 0; k < WAY; k = k + 1) begin
            index_q[k] <= k == 0 ? next_q : index_q[k == 0 ? 0 : k-1];
            word_q[k]  <= k == 0 ? around_offset[REGISTER_W-1:0] : word_q[k == 0 ? 0 : k-1];
        end
        idle_q <= clear || !copies_q || reach_copy || left_q == 0 || none ? 3'd0 : idle_q + 1'b1;
    end
    reg  [`FP3_SETTINGS_W-1:0] settings_q;
    reg                        half_q, clear_q;
    always @(posedge clk_i) {settings_q, half_q, clear_q} <= {settings_i, half_i, clear};
    always @* begin
        assume (started_q || rst_i);
        assume (started_q || {every_q, to_q, from_q} == {\u_exchange.u_tos.kept_q , \u_exchange.u_froms.kept_q });      // at power-up
        assume (\u_exchange.u_froms.which == \u_exchange.u_tos.which );
        assume (!copy_i || (!busy && !copied && !copies_q && !rst_i && !abort_i));
        assume (!(copies_q || busy) || ({settings_i, half_i} == {settings_q, half_q} && !write_i));
        assume (!copy_i || !write_i);
        assume (n <= (1 << INDEX_W) && setting_copies[31:STORE_W+1] == 0);
        assume (REGISTERS == 64 || ({setting_published_more, setting_published} >> REGISTERS) == 64'd0);
    end

    function [63:0] one(input [REGISTER_W-1:0] word);
        one = 64'd1 << word;
    endfunction
    wire [63:0]        lowest = left_q & (~left_q + 64'd1);
    wire [STORE_W-1:0] address = ({to_q[ROW_W-1:0], 3'd0} << setting_record) | word_q[WAY-1] | {half_i, {STORE_W-1{1'b0}}};
    always @* if (started_q) begin
        // Each copy of each word once, in order: the lane that has it ...
        assert (!reach_valid && !reach_load);
        if (reach_copy) begin
            assert (copies_q && busy && !none && left_q != 0);
            assert (one(around_offset[REGISTER_W-1:0]) == lowest && around_half == half_i);
            assert (!around_each && !around_entry && !around_ldn && !around_ldl && !around_inside);
            if (next_q == at) assert ({around_turn[LANE_W-1:0], reach_row} == from_q && around_turn < (1 << LANE_W));
        end
        // ... and the one that gets it, as the word comes, and nothing else
        assert (access_valid == way_q[WAY-1] && access_write == access_valid && !access_whole);
        if (access_valid) begin
            assert (busy);
            if (index_q[WAY-1] == at) begin
                assert (access_space == (every_q ? HOST_EVERY : HOST_OBJECT) && access_address == address);
                if (!every_q) assert (access_lane == to_q[FROM_W-1:ROW_W]);
            end
        end
        // Over when all are made, and soon
        if (copied) assert (copies_q && (left_q == 0 || none) && way_q == 0);
        if (!copied && !reach_copy) assert (copies_q == busy);
        assert (idle_q <= 3'd4);
    end

    localparam [2:0] IDLE = 3'd0, LOW = 3'd1, PICK = 3'd2, WALK = 3'd3, DRAIN = 3'd4;
    localparam DRAIN_W = $clog2(WAY + 1);
    (* hierconn *) wire [2:0]                \u_exchange.state_q ;
    (* hierconn *) wire [63:0]               \u_exchange.left_q , \u_exchange.low_q ;
    (* hierconn *) wire                      \u_exchange.any_q , \u_exchange.copied_q ;
    (* hierconn *) wire [REGISTER_W-1:0]     \u_exchange.register_q ;
    (* hierconn *) wire [INDEX_W-1:0]        \u_exchange.index_q , \u_exchange.end_index_q , \u_exchange.to_index_q ;
    (* hierconn *) wire [DRAIN_W-1:0]        \u_exchange.drain_q ;
    (* hierconn *) wire [1:0]                \u_exchange.u_from.genblk1.g_many.d_q , \u_exchange.u_to.genblk1.g_many.d_q ;
    (* hierconn *) wire [WAY-1:0]            \u_exchange.u_to_reads.genblk1.g_many.d_q ;
    (* hierconn *) wire [2*REGISTER_W-1:0]   \u_exchange.u_from_register.genblk1.g_many.d_q ;
    (* hierconn *) wire [WAY*REGISTER_W-1:0] \u_exchange.u_to_register.genblk1.g_many.d_q ;
    (* hierconn *) wire                      \u_exchange.u_froms.it_q , \u_exchange.u_froms.late_q , \u_exchange.u_tos.it_q , \u_exchange.u_tos.late_q ;
    (* hierconn *) wire [FROM_W-1:0]         \u_exchange.u_froms.word_q , \u_exchange.u_froms.read_q ;
    (* hierconn *) wire [FROM_W:0]           \u_exchange.u_tos.word_q , \u_exchange.u_tos.read_q ;
    wire [2:0]  state = \u_exchange.state_q ;
    wire [1:0]  from  = \u_exchange.u_from.genblk1.g_many.d_q ;
    wire [1:0]  flying = {1'b0, from[0]} + from[1];
    wire [INDEX_W:0] ahead = next_q + flying;
    wire [63:0] rest  = left_q & (left_q - 1'b1);
    integer     j;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            always @* if (started_q) begin
                assert (\u_exchange.copied_q ? copies_q && state == IDLE : copies_q == (state != IDLE));
                assert (state <= DRAIN);
                assert (\u_exchange.u_froms.kept_q == from_q && \u_exchange.u_tos.kept_q == {every_q, to_q});
                if (state == IDLE || clear_q) assert (from == 0);
                if (clear_q) assert (!copies_q && way_q == 0);
                if (copies_q && none) assert (from == 0 && way_q == 0);
                if (copies_q) begin
                    if (!none) assert (\u_exchange.end_index_q == n[INDEX_W-1:0] - 1'b1 || state == LOW);
                    assert (none || next_q < n);
                    if (state == WALK) begin
                        assert (!none && one(\u_exchange.register_q ) == lowest && left_q != 0 && \u_exchange.left_q == rest);
                        assert (\u_exchange.index_q == ahead && ahead < n);
                    end
                    if (state == LOW || state == PICK || state == DRAIN) begin
                        if (flying == 0) assert (next_q == 0 && (\u_exchange.left_q == left_q || (none && state == DRAIN)));
                        else assert (ahead == n && !none && left_q != 0 && \u_exchange.left_q == rest);
                    end
                    if (state == PICK) begin
                        assert (\u_exchange.low_q == (\u_exchange.left_q & (~\u_exchange.left_q + 64'd1)));
                        assert (\u_exchange.any_q == (\u_exchange.left_q != 0 && !none) && \u_exchange.index_q == 0 && !from[0]);
                    end
                    if (state == DRAIN) assert ((\u_exchange.left_q == 0 || none) && from == 0 && \u_exchange.drain_q <= WAY
                                             && (way_q & ((1 << WAY - \u_exchange.drain_q ) - 1)) == 0);
                    if (from == 2'b01 || (state == WALK && from == 0)) assert (next_q == 0);
                    if (state == WALK) assert (from != 2'b10);
                    if (state == LOW) assert (from != 2'b10);
                    if (state == IDLE) assert ((left_q == 0 || none) && way_q == 0);
                    for (j = 0; j < 2; j = j + 1)
                        if (from[j]) assert (one(\u_exchange.u_from_register.genblk1.g_many.d_q [REGISTER_W*j +: REGISTER_W]) == lowest && left_q != 0);
                end
                if (from[0]) assert (\u_exchange.u_froms.it_q == (next_q + from[1] == at) && (!\u_exchange.u_froms.it_q || \u_exchange.u_froms.word_q == from_q));
                if (from[1]) assert (\u_exchange.u_froms.late_q == (next_q == at) && (!\u_exchange.u_froms.late_q || \u_exchange.u_froms.read_q == from_q));
                // On the way
                assert (\u_exchange.u_to_reads.genblk1.g_many.d_q [1:0] == from);
                for (j = 2; j < WAY; j = j + 1) assert (\u_exchange.u_to_reads.genblk1.g_many.d_q [j] == way_q[j-2]);
                assert (\u_exchange.u_to.genblk1.g_many.d_q == way_q[WAY-1:WAY-2]);
                for (j = 0; j < WAY; j = j + 1) if (way_q[j]) assert (\u_exchange.u_to_register.genblk1.g_many.d_q [REGISTER_W*j +: REGISTER_W] == word_q[j]);
                for (j = 1; j < WAY; j = j + 1) if (way_q[j-1]) assert (index_q[j-1] == (way_q[j] ? index_q[j] + 1'b1 : 0));
                if (from[1]) assert (next_q == (way_q[0] ? index_q[0] + 1'b1 : 0));
                if (!clear_q) assert (\u_exchange.to_index_q == (way_q[WAY-2] ? index_q[WAY-2] + 1'b1 : {INDEX_W{1'b0}}));
                if (way_q[WAY-2]) assert (\u_exchange.u_tos.it_q == (index_q[WAY-2] == at) && (!\u_exchange.u_tos.it_q || \u_exchange.u_tos.word_q == {every_q, to_q}));
                if (way_q[WAY-1]) assert (\u_exchange.u_tos.late_q == (index_q[WAY-1] == at) && (!\u_exchange.u_tos.late_q || \u_exchange.u_tos.read_q == {every_q, to_q}));
                if (way_q != 0) assert (busy);
                // How long it may be quiet
                if (copies_q && !from[1]) assert (idle_q <= (from[0] ? 3'd3 : state == LOW ? 3'd0 : state == PICK ? 3'd1 : state == WALK ? 3'd2 : 3'd0));
            end
        end
    endgenerate
endmodule
`default_nettype wire
`include "config/undefine.vh"
