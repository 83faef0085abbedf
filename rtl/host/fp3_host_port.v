// SPDX-License-Identifier: Apache-2.0
// fp3_host_port: the host's registers, its counters, and its windows onto the memories.
//
// Purpose   Loads programs, constants and objects, starts and stops runs, and shows their outcome.
//           Each scheduler has a host_port. isa/registers.toml is the map of registers, with their
//           access; settings of a run are kept here and passed on as a bundle.
// Latency   A request is decoded (host_decode), checked, and executed, a cycle each. A write is
//           answered when it is executed, a read of a register or counter two cycles later, any
//           other read MEMORY_LATENCY + 1 cycles later: MEMORY_LATENCY cycles from access_o to the
//           word on rdata_i (isa/timing.toml).
// Promise   Every request is answered. A request to an address without a register, with an access
//           that the register does not have, or with a value out of its range is answered with an
//           error and changes nothing.
// Hazard    A request may come in every cycle. But a request to a register, a counter or a constant
//           comes alone: all requests before it have been answered, the next one comes at least
//           four cycles after its answer, and its address and data stay as they are until then.
//           With start_o, step < last <= size in the settings, a visit is a step where words are
//           published, and no list is overfull: hub keeps a start back until the lanes have
//           reported it.
//
//     cycle           0     1     2     3     4    ..  3+M   M = MEMORY_LATENCY
//     req_valid_i     1     0     0     0     0
//     answer_wrote    0     0     1     0     0              a write
//     access_o        0     0     1     0     0              of a memory; rdata_i is its word in 2+M
//     answer_read     0     0     0     0     1         0    a register or counter
//     answer_read     0     0     0     0     0         1    a memory
`default_nettype none
`include "host/answer.vh"
`include "gen/settings.vh"
`include "gen/events.vh"
module fp3_host_port #(
`include "config/config.vh"
) (
    input  wire                   clk_i,
    input  wire                   rst_i,
    // Requests and answers
    input  wire                   req_valid_i,
    input  wire                   req_write_i,
    input  wire [23:0]            req_addr_i,
    input  wire [31:0]            req_wdata_i,
    output wire [`FP3_ANSWER_W-1:0]   answer_o,
    output wire                   irq_o,
    // The scheduler's run
    output wire                   start_o,
    output wire                   stop_o,
    output wire [`FP3_SETTINGS_W-1:0] settings_o,             // stable from start_o to the end of the run
    output wire [1:0]             part_o,                 // likewise; PART, 0 without OVERLAP
    input  wire                   running_i,
    input  wire                   illegal_i,
    input  wire [PROGRAM_W-1:0]   illegal_pc_i,
    input  wire                   half_i,                 // of the store: it has the published words
    input  wire                   overfull_i,             // a lane's list was to get more than it has room for
    input  wire                   no_room_i,              // a list that is made has no room: the run will end
    input  wire                   raised_i,               // an object has raised
    input  wire [4:0]             flags_i,                // raised in this cycle
    input  wire [`FP3_EVENTS_W-1:0]   events_i,
    // Its memories
    output wire                   program_write_o,
    output wire [PROGRAM_W-1:0]   program_addr_o,
    output wire                   access_o,
    output wire                   write_o,
    output wire [2:0]             space_o,                // see lane_host.vh
    output wire [19:0]            addr_o,
    output wire [31:0]            wdata_o,
    input  wire [31:0]            rdata_i
);
`include "gen/registers.vh"
`include "gen/host_map.vh"
`include "host/lane_host.vh"
    localparam [31:0] STORE_32 = STORE_WORDS;

    // Decode a request, check it, execute it. A request that is alone stays until it is answered.
    reg         check_q, write_q, ok_q;
    reg         writes_q, ours_q, fetches_q, access_q, load_q;      // executed: a write, a read of ours, any other; a memory, a program
    reg         shows_q;                                  // a cycle later
    reg  [4:0]  register_q;
    reg  [31:0] wdata_q, memory_wdata_q;
    reg  [2:0]  space_q;
    reg  [19:0] address_q;
    wire        in_registers, in_counters, in_program, in_memory;
    wire [2:0]  space;
    wire [19:0] address;
    wire [5:0]  counter;
    wire        ours = in_registers || in_counters;
    wire        ok;                                       // this access has a meaning now
    fp3_host_decode #(.CONFIG(CONFIG)) u_decode (
        .clk_i(clk_i), .write_i(req_write_i), .addr_i(req_addr_i),
        .registers_o(in_registers), .counters_o(in_counters), .program_o(in_program), .memory_o(in_memory),
        .counter_o(counter), .space_o(space), .address_o(address));
    always @(posedge clk_i) begin
        if (rst_i) {check_q, writes_q, ours_q, shows_q, fetches_q, access_q, load_q} <= 7'd0;
        else begin
            check_q   <= req_valid_i;
            writes_q  <= check_q && write_q;
            ours_q    <= check_q && !write_q && ours;
            shows_q   <= ours_q;
            fetches_q <= check_q && !write_q && !ours;
            access_q  <= check_q && ok && in_memory;
            load_q    <= check_q && ok && in_program;
        end
        ok_q <= ok;
        {write_q, register_q, wdata_q}       <= {req_write_i, req_addr_i[6:2], req_wdata_i};
        {space_q, address_q, memory_wdata_q} <= {space, address, wdata_q};
    end

    // The settings of a run, and its outcome
    wire [`FP3_SETTINGS_W-1:0] settings;
    `FP3_SETTINGS_FIELDS
    assign `FP3_SETTINGS  = settings;
    assign settings_o = settings;
    reg                 done_q, illegal_q, stopped_q, no_room_q, was_running_q;
    reg [PROGRAM_W-1:0] fault_q;
    reg [4:0]           flags_q;
    reg                 irq_enable_q, ended_q;
    reg                 irq_enable_failed_q, failed_q;
    wire                raised;                           // an object has raised in the run

    // Is the access to a register legal? The address is checked first, the state of the run a cycle
    // later, which keeps the path short.
    reg  runnable;
    reg  has_q;                                           // there is such an access
    reg  starts_q, sets_q;                                // it is a write: a start; a setting
    reg  [RANGES-1:0] ranged_q, fits_q;                   // of a setting with this range; the value is in this range
    wire [4:0] register = req_addr_i[6:2];
    wire starts = req_write_i && register == ADDR_CONTROL[6:2] && req_wdata_i[CONTROL_START_LO];
    reg  publishes_q, steps_once_q;                       // of the run to come: neighbours read words; a visit is a step
    wire stops  = req_write_i && register == ADDR_CONTROL[6:2] && req_wdata_i[CONTROL_STOP_LO];
    always @(posedge clk_i) begin
        has_q    <= req_write_i ? WRITABLE[register] && !(starts && stops) : READABLE[register];
        starts_q <= starts;
        sets_q   <= req_write_i && IS_SETTING[register];
        publishes_q  <= {setting_published_more, setting_published} != 64'd0;
        steps_once_q <= setting_visit == 32'd1;
        runnable <= setting_step < setting_last && setting_last <= setting_size && !overfull_i && (!publishes_q || steps_once_q);
    end
    genvar r;
    generate
        for (r = 0; r < RANGES; r = r + 1) begin : g_range
            localparam [31:0] LEAST = RANGE_LEAST[32*r +: 32], MOST = RANGE_MOST[32*r +: 32], OF = RANGE_OF[32*r +: 32] & IS_SETTING;
            localparam W = $clog2(MOST + 1);
            always @(posedge clk_i) begin
                ranged_q[r] <= req_write_i && OF[register];
                // Where all words of W bits are in the range there is nothing to compare.
                // verilator lint_off CMPCONST
                fits_q[r]   <= (req_wdata_i >> W) == 32'd0 && req_wdata_i[W-1:0] - LEAST[W-1:0] <= MOST[W-1:0] - LEAST[W-1:0];
                // verilator lint_on CMPCONST
            end
        end
    endgenerate

    // A list takes objects that the lane has rows for, a power of two. A list of numbers is only
    // emptied.
    wire [31:0] rows   = STORE_32 >> ({1'b0, setting_record} + SETTING_LEAST[8*ADDR_RECORD +: 3]);
    wire        in_row = (req_wdata_i & ~(rows - 32'd1)) == 32'd0;
    reg         is_row, is_count;
    always @(posedge clk_i) begin
        is_row   <= in_row;
        is_count <= SLEEP != 0 ? req_wdata_i == 32'd0 : in_row || req_wdata_i == rows;
    end
    wire wants_stop = wdata_q[CONTROL_STOP_LO];
    wire wants_start = wdata_q[CONTROL_START_LO];

    // The outcome is known in the cycle after the end; until then the run counts as running.
    wire busy = running_i || was_running_q;

    wire register_ok = has_q && !(running_i && (starts_q || sets_q)) && !(starts_q && !runnable) && !(|(ranged_q & ~fits_q));
    wire beyond = (space == HOST_AWAKE && !is_count) || (space == HOST_WAKE && !is_row);
    wire aside;                                           // it is of the part that the run leaves out
    assign ok = in_registers ? register_ok
              : in_counters  ? !write_q
              : (!running_i || aside) && ((in_memory && !(write_q && beyond)) || (in_program && write_q));

    // The values of readable registers: configuration, settings, outcome. One mux of all would be
    // the processor's longest path, so one register of each group is selected, and a group in the
    // next cycle.
    localparam GROUP_SIZE = 8, READ_GROUPS = REGISTER_COUNT / GROUP_SIZE;
    wire [32*REGISTER_COUNT-1:0] kept;                    // the settings as the host wrote them
    reg  [32*REGISTER_COUNT-1:0] words;
    always @* begin
        words = SHOWN | kept;
        words[8*ADDR_STATUS + STATUS_RUNNING_LO +: 1]   = busy;
        words[8*ADDR_STATUS + STATUS_DONE_LO +: 1]      = done_q && !busy;
        words[8*ADDR_STATUS + STATUS_ILLEGAL_LO +: 1]   = illegal_q && !busy;
        words[8*ADDR_STATUS + STATUS_STOPPED_LO +: 1]   = stopped_q && !busy;
        words[8*ADDR_STATUS + STATUS_NO_ROOM_LO +: 1]   = no_room_q && !busy;
        if (KEEP != 0) words[8*ADDR_STATUS + STATUS_RAISED_LO +: 1] = raised && !busy;
        words[8*ADDR_FAULT +: PROGRAM_W]                = fault_q;
        words[8*ADDR_FLAGS +: 5]                        = flags_q;
        if (NEIGHBOURS != 0) words[8*ADDR_HALF + HALF_UPPER_LO +: 1] = half_i;
        words[8*ADDR_INTERRUPT + INTERRUPT_ENABLE_LO +: 1] = irq_enable_q;
        words[8*ADDR_INTERRUPT + INTERRUPT_ENDED_LO +: 1]  = ended_q;
        words[8*ADDR_INTERRUPT + INTERRUPT_ENABLE_FAILED_LO +: 1] = irq_enable_failed_q;
        words[8*ADDR_INTERRUPT + INTERRUPT_FAILED_LO +: 1]        = failed_q;
    end

    // A decoded request is executed in the next cycle. Only a run's end can come in between, so the
    // request is still legal. A read stays a cycle longer.
    reg  [32*READ_GROUPS-1:0] groups_q;
    reg  [COUNTER_W-1:0]      counter_q;
    reg                       counters_high_q;
    integer                   g;
    always @(posedge clk_i) begin
        for (g = 0; g < READ_GROUPS; g = g + 1) groups_q[32*g +: 32] <= words[32*GROUP_SIZE*g + 32*register_q[2:0] +: 32];
        {counter_q, counters_high_q} <= {counter[COUNTER_W-1:0], register_q[0]};
    end
    wire unused = &counter;            // the map has room for more than there are
    wire [31:0] count;
    wire [31:0] shown = in_counters ? count : groups_q[32*register_q[4:3] +: 32];

    // The answers
    wire        fetched, fetched_ok;
    reg         read_q, read_error_q;
    reg  [31:0] rdata_q;
    fp3_delay #(.W(1), .N(MEMORY_LATENCY)) u_fetched (.clk_i(clk_i), .rst_i(rst_i), .d_i(fetches_q), .q_o(fetched));
    fp3_delay #(.W(1), .N(MEMORY_LATENCY)) u_fetched_ok (.clk_i(clk_i), .rst_i(1'b0), .d_i(ok_q), .q_o(fetched_ok));
    always @(posedge clk_i) begin
        read_q       <= (shows_q || fetched) && !rst_i;
        read_error_q <= (shows_q && !ok_q) || (fetched && !fetched_ok);
        rdata_q      <= (shown & {32{shows_q && ok_q}}) | (rdata_i & {32{fetched && fetched_ok}});
    end
    `FP3_ANSWER_FIELDS
    assign answer_wrote       = writes_q;
    assign answer_write_error = writes_q && !ok_q;
    assign {answer_read, answer_read_error, answer_rdata} = {read_q, read_error_q, rdata_q};
    assign answer_o = `FP3_ANSWER;

    // Which register a write is for is found while it is checked; whether it may be written enables
    // the register then.
    wire writes = check_q && write_q && in_registers && !rst_i;
    reg  to_control_q, to_interrupt_q;
    always @(posedge clk_i) begin
        to_control_q   <= writes && register_q == ADDR_CONTROL[6:2];
        to_interrupt_q <= writes && register_q == ADDR_INTERRUPT[6:2];
    end
    genvar n;
    generate
        for (n = 0; n < REGISTER_COUNT; n = n + 1) begin : g_register
            localparam integer W = SETTING_BITS[32*n +: 32], AT = SETTING_AT[32*n +: 32];
            if (IS_SETTING[n]) begin : g_setting
                reg         to_q;
                reg [W-1:0] value_q;
                always @(posedge clk_i) begin
                    to_q <= writes && register_q == n;
                    if (rst_i)             value_q <= SETTING_RESET[32*n +: W];
                    else if (to_q && ok_q) value_q <= wdata_q[W-1:0] - SETTING_LEAST[32*n +: W];
                end
                assign settings[AT +: W]  = value_q;
                assign kept[32*n +: 32]   = {{32-W{1'b0}}, value_q} + SETTING_LEAST[32*n +: 32];
            end else begin : g_none
                assign kept[32*n +: 32] = 32'd0;
                if (W != 0) begin : g_zero
                    assign settings[AT +: W] = {W{1'b0}};
                end
            end
        end
    endgenerate
    wire start        = to_control_q && ok_q && wants_start;
    wire to_interrupt = to_interrupt_q && ok_q;
    reg  start_q, clear_q;             // a start reaches far: it begins in the next cycle
    reg  no_steps_q;
    always @(posedge clk_i) begin
        no_steps_q <= setting_steps == 32'd0;
        start_q    <= start && !no_steps_q && !rst_i;
        clear_q    <= start;
    end
    assign start_o = start_q;
    assign stop_o  = to_control_q && ok_q && wants_stop && running_i;

    // The part of the store that the run works on
    generate
        if (OVERLAP != 0) begin : g_part
            reg part_q, upper_q;
            always @(posedge clk_i)
                if (start) {part_q, upper_q} <= {wdata_q[CONTROL_PART_LO], wdata_q[CONTROL_UPPER_LO]};
            assign part_o = {part_q, upper_q};
            assign aside  = in_memory && space == HOST_OBJECT && part_q && address[STORE_W-2] != upper_q;
        end else begin : g_whole
            assign {part_o, aside} = 3'd0;
        end
    endgenerate

    always @(posedge clk_i)
        if (rst_i) begin
            {done_q, illegal_q, stopped_q, no_room_q, was_running_q, flags_q, irq_enable_q, ended_q} <= 12'd0;
            fault_q <= {PROGRAM_W{1'b0}};
        end else begin
            was_running_q <= running_i;
            if (start) begin
                {illegal_q, stopped_q, no_room_q, flags_q} <= 8'd0;
                fault_q <= {PROGRAM_W{1'b0}};
                {done_q, ended_q} <= {2{no_steps_q}};
            end else begin
                // The first reason to end is the one that counts.
                if (stop_o && !illegal_i && !illegal_q && !no_room_q) stopped_q <= 1'b1;
                if (illegal_i && !stopped_q && !no_room_q) {illegal_q, fault_q} <= {1'b1, illegal_pc_i};
                if (KEEP != 0 && no_room_i && !illegal_q && !stopped_q && !illegal_i && !stop_o) no_room_q <= 1'b1;
                flags_q <= flags_q | flags_i;
                if (was_running_q && !running_i) {ended_q, done_q} <= {1'b1, !illegal_q && !stopped_q && !no_room_q};
                else if (to_interrupt && wdata_q[INTERRUPT_ENDED_LO]) ended_q <= 1'b0;
            end
            if (to_interrupt) irq_enable_q <= wdata_q[INTERRUPT_ENABLE_LO];
        end

    generate
        if (KEEP != 0) begin : g_raised
            reg raised_q;
            always @(posedge clk_i) raised_q <= !rst_i && !start && (raised_q || raised_i);
            assign raised = raised_q;
        end else begin : g_never_raised
            assign raised = 1'b0;
            wire unused_raised = raised_i;
        end
    endgenerate

    // Interrupts a sleeping host at an overflow or an invalid operation, before the run ends.
    always @(posedge clk_i)
        if (rst_i) {irq_enable_failed_q, failed_q} <= 2'd0;
        else begin
            if (flags_i[FLAGS_OVERFLOW_LO] || flags_i[FLAGS_INVALID_LO])         failed_q <= 1'b1;
            else if (start || (to_interrupt && wdata_q[INTERRUPT_FAILED_LO])) failed_q <= 1'b0;
            if (to_interrupt) irq_enable_failed_q <= wdata_q[INTERRUPT_ENABLE_FAILED_LO];
        end

    assign {access_o, write_o, space_o, addr_o} = {access_q, writes_q, space_q, address_q};
    assign program_write_o  = load_q;
    assign program_addr_o   = address_q[PROGRAM_W-1:0];
    assign wdata_o          = memory_wdata_q;

    generate
        if (COUNTERS != 0) begin : g_counters
            fp3_counters #(.N(`FP3_EVENTS_W), .INDEX_W(COUNTER_W)) u_counters (
                .clk_i(clk_i), .clear_i(rst_i || clear_q), .event_i(events_i),
                .read_i(ours_q), .index_i(counter_q), .high_i(counters_high_q), .value_o(count));
        end else begin : g_no_counters
            wire unused_events = &{clear_q, events_i, counter_q, counters_high_q};
            assign count = 32'd0;
        end
    endgenerate

    assign irq_o       = (irq_enable_q && ended_q) || (irq_enable_failed_q && failed_q);

`ifdef FP3_CHECK
    // A register, counter or constant is alone.
    wire        alone = check_q && (ours || (in_memory && space == HOST_CONSTANT));
    reg  [4:0]  alone_q;
    reg  [56:0] stood_q;
    always @(posedge clk_i) begin
        alone_q <= rst_i ? 5'd0 : {alone_q[3:0], alone};
        if (!rst_i && ((check_q && |alone_q) || (alone && (req_valid_i || writes_q || ours_q || shows_q || fetches_q || fetched)))) begin
            $display("%m: a request beside one that has to be alone"); $stop;
        end
        stood_q <= {req_write_i, req_addr_i, req_wdata_i};
        if (!rst_i && (alone || |alone_q[3:0]) && {req_write_i, req_addr_i, req_wdata_i} != stood_q) begin
            $display("%m: the address or the data of a request change that is alone"); $stop;
        end
    end
    always @(posedge clk_i)
        if (!rst_i && start_o && !(setting_step < setting_last && setting_last <= setting_size)) begin
            $display("%m: a run starts whose steps are the words %0d to %0d of %0d", setting_step, setting_last - 1'b1, setting_size); $stop;
        end
`endif
endmodule
`default_nettype wire
`include "config/undefine.vh"
