// host_port: the host's registers and its windows onto the memories.
//
// Purpose   Loads programs, constants and objects, starts and stops
//           runs, and shows how they went. isa/registers.toml is the map; every scheduler has one.
// Latency   A request is decoded (host_decode), checked, and executed, a cycle each. A write is answered while it is
//           executed, a read of a register or counter two cycles later, any other read MEMORY_LATENCY + 1 cycles later.
// Promise   Every request is answered. What has no register, no such access or no sense is
//           answered with an error and changes nothing.
// Hazard    A request may come in every cycle. But one to a register, a counter or a constant is alone: none is
//           before it without an answer, none comes until it is answered and then four cycles more have passed,
//           and its address and data stand all the time.
//           With start_o, step_o <= step_end_o <= end_o.
//
//     cycle           0     1     2     3     4    ..  3+M   M = MEMORY_LATENCY
//     req_valid_i     1     0     0     0     0
//     answer_wrote    0     0     1     0     0              a write
//     access_o        0     0     1     0     0              of a memory; rdata_i is its word in 2+M
//     answer_read     0     0     0     0     1         0    a register or counter
//     answer_read     0     0     0     0     0         1    a memory
`default_nettype none
`include "host/answer.vh"
module host_port #(
    parameter MEMORY_LATENCY = 1,      // cycles from access_o to the word on rdata_i, at least 1
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    // Requests and answers
    input  wire                 req_valid_i,
    input  wire                 req_write_i,
    input  wire [23:0]          req_addr_i,
    input  wire [31:0]          req_wdata_i,
    output wire [`ANSWER_W-1:0] answer_o,
    output wire                 irq_o,
    // The scheduler's run
    output wire                 start_o,
    output wire                 stop_o,
    output wire [31:0]          steps_o,
    output wire [31:0]          visit_o,
    output wire [31:0]          clock_o,
    output wire [1:0]           record_o,                 // its logarithm less 3
    output wire [PROGRAM_W-1:0] step_o,
    output wire [PROGRAM_W-1:0] step_end_o,
    output wire [PROGRAM_W-1:0] end_o,
    input  wire                 running_i,
    input  wire                 illegal_i,
    input  wire [PROGRAM_W-1:0] illegal_pc_i,
    input  wire [4:0]           flags_i,                  // raised in this cycle
    // Its memories
    output wire                 program_write_o,
    output wire [PROGRAM_W-1:0] program_addr_o,
    output wire                 access_o,
    output wire                 write_o,
    output wire [2:0]           space_o,                  // see lane_host.vh
    output wire [19:0]          addr_o,
    output wire [31:0]          wdata_o,
    input  wire [31:0]          rdata_i,
    // Its counters
    output wire                 counters_clear_o,
    output wire                 counters_read_o,
    output wire [3:0]           counters_index_o,
    output wire                 counters_high_o,
    input  wire [31:0]          counters_value_i          // in the next cycle
);
`include "gen/isa.vh"
`include "gen/registers.vh"
`include "gen/shown.vh"
`include "host/lane_host.vh"
    localparam [31:0] REGISTERS_32 = REGISTERS;
    localparam [31:0] CONTEXTS_32  = CONTEXTS;
    localparam [31:0] PROGRAM_32   = PROGRAM_WORDS;
    localparam [31:0] STORE_32     = STORE_WORDS;

    // Decode a request, check it, execute it. What is alone stands until it is answered.
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
    wire [3:0]  counter;
    wire        ours = in_registers || in_counters;
    host_decode #(.CONFIG(CONFIG)) u_decode (
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

    // The run's description and its outcome
    reg [31:0]        steps_q, visit_q, clock_q;
    reg [1:0]         record_q;
    reg [PROGRAM_W:0] step_q, last_q, size_q;
    reg               done_q, illegal_q, stopped_q, was_running_q;
    reg [PROGRAM_W-1:0] fault_q;
    reg [4:0]         flags_q;
    reg               irq_enable_q, ended_q;

    // Whether an access to a register has a meaning is told of its address first, then of what happens now. That keeps
    // the path short.
    reg  runnable, is_index, is_small, is_record;          // a record: its low bits say is_record, the others are zero, is_small
    reg  has_q;                                           // there is such an access
    reg  starts_q, sets_q, sets_index_q, sets_record_q;   // it writes: a start, what describes a run; an index, a record
    wire [4:0] register = req_addr_i[6:2];
    wire starts = req_write_i && register == ADDR_CONTROL[6:2] && req_wdata_i[CONTROL_START_LO];
    reg  has, sets, sets_index;
    always @* begin
        {has, sets, sets_index} = 3'b000;
        case (register)
            ADDR_CONTROL[6:2]:   has = req_write_i && !(starts && req_wdata_i[CONTROL_STOP_LO]);
            ADDR_INTERRUPT[6:2]: has = 1'b1;
            ADDR_STEPS[6:2]:     {has, sets} = {1'b1, req_write_i};
            ADDR_VISIT[6:2], ADDR_CLOCK[6:2], ADDR_RECORD[6:2]: {has, sets} = {STORE_WORDS != 0, req_write_i};
            ADDR_STEP[6:2], ADDR_LAST[6:2], ADDR_SIZE[6:2]: {has, sets, sets_index} = {1'b1, {2{req_write_i}}};
            default:             has = !req_write_i && register <= ADDR_FLAGS[6:2];
        endcase
    end
    always @(posedge clk_i) begin
        {has_q, starts_q, sets_q, sets_index_q} <= {has, starts, sets, sets_index};
        sets_record_q <= req_write_i && register == ADDR_RECORD[6:2];
        runnable      <= step_q < last_q && last_q <= size_q;
        is_index      <= req_wdata_i <= PROGRAM_32;
        is_small      <= req_wdata_i[31:3] == 29'd0;
        is_record     <= req_wdata_i[2:0] >= 3'd3 && req_wdata_i[2:0] <= 3'd6;
    end
    wire [2:0] record = {1'b0, record_q} + 3'd3;
    // A list is told of objects that the lane has rows for, a power of two. A list of numbers is only emptied.
    wire [31:0] rows   = STORE_32 >> record;
    wire        in_row = (req_wdata_i & ~(rows - 32'd1)) == 32'd0;
    reg         is_row, is_count;
    always @(posedge clk_i) begin
        is_row   <= in_row;
        is_count <= SLEEP != 0 ? req_wdata_i == 32'd0 : in_row || req_wdata_i == rows;
    end
    wire wants_stop = wdata_q[CONTROL_STOP_LO];
    wire wants_start = wdata_q[CONTROL_START_LO];

    // The outcome is known in the cycle after the end: until then the run goes on.
    wire busy = running_i || was_running_q;

    wire register_ok = has_q && !(running_i && (starts_q || sets_q)) && !(starts_q && !runnable)
                             && !(sets_index_q && !is_index) && !(sets_record_q && !(is_small && is_record));
    wire beyond = (space == HOST_AWAKE && !is_count) || (space == HOST_WAKE && !is_row);
    wire ok = in_registers ? register_ok                  // this access has a meaning now
            : in_counters  ? !write_q
            : !running_i && ((in_memory && !(write_q && beyond)) || (in_program && write_q));

    // What a read shows, in parts: one mux would be the longest path of the whole.
    wire [31:0] third = {27'd0, register_q[0] ? {3'd0, ended_q, irq_enable_q} : flags_q};
    reg  [31:0] first, second;
    always @* begin
        first  = 32'd0;
        second = 32'd0;
        case (register_q[2:0])
            ADDR_ID[4:2]:       first = {24'h465033, ISA_REVISION};
            ADDR_SHAPE[4:2]:    first = {CONTEXTS_32[15:0], REGISTERS_32[7:0], REGISTERS_32[7:0]};
            ADDR_MEMORY[4:2]:   first = PROGRAM_32;
            ADDR_FEATURES[4:2]: first = REGISTER_FEATURES;
            ADDR_STATUS[4:2]:   first = {28'd0, {stopped_q, illegal_q, done_q} & {3{!busy}}, busy};
            ADDR_RECORD[4:2]:   first = {29'd0, record};
            ADDR_FAULT[4:2]:    first = {{32-PROGRAM_W{1'b0}}, fault_q};
            default: ;
        endcase
        case (register_q[2:0])
            ADDR_STEPS[4:2]:    second = steps_q;
            ADDR_STEP[4:2]:     second = {{31-PROGRAM_W{1'b0}}, step_q};
            ADDR_LAST[4:2]:     second = {{31-PROGRAM_W{1'b0}}, last_q};
            ADDR_SIZE[4:2]:     second = {{31-PROGRAM_W{1'b0}}, size_q};
            ADDR_ARRAY[4:2]:    second = REGISTER_ARRAY;
            ADDR_STORE[4:2]:    second = STORE_32;
            ADDR_VISIT[4:2]:    second = visit_q;
            ADDR_CLOCK[4:2]:    second = clock_q;
        endcase
    end

    // What was decoded is executed in the next cycle. A run may end in between, and nothing else
    // may change, so it still has its meaning. What is read stands a cycle longer.
    reg  [31:0] first_q, second_q, third_q;
    reg         counters_high_q;
    reg  [3:0]  counter_q;
    always @(posedge clk_i) begin
        {first_q, second_q, third_q} <= {first, second, third};
        {counter_q, counters_high_q} <= {counter, register_q[0]};
    end
    wire [31:0] shown = in_counters ? counters_value_i : register_q[4] ? third_q : register_q[3] ? second_q : first_q;

    // The answers
    wire        fetched, fetched_ok;
    reg         read_q, read_error_q;
    reg  [31:0] rdata_q;
    delay #(.W(1), .N(MEMORY_LATENCY)) u_fetched (.clk_i(clk_i), .rst_i(rst_i), .d_i(fetches_q), .q_o(fetched));
    delay #(.W(1), .N(MEMORY_LATENCY)) u_fetched_ok (.clk_i(clk_i), .rst_i(1'b0), .d_i(ok_q), .q_o(fetched_ok));
    always @(posedge clk_i) begin
        read_q       <= (shows_q || fetched) && !rst_i;
        read_error_q <= (shows_q && !ok_q) || (fetched && !fetched_ok);
        rdata_q      <= (shown & {32{shows_q && ok_q}}) | (rdata_i & {32{fetched && fetched_ok}});
    end
    `ANSWER_FIELDS
    assign answer_wrote       = writes_q;
    assign answer_write_error = writes_q && !ok_q;
    assign {answer_read, answer_read_error, answer_rdata} = {read_q, read_error_q, rdata_q};
    assign answer_o = `ANSWER;

    // Which register a write is for is told while it is checked; what enables that register then is that it may.
    wire writes = check_q && write_q && in_registers && !rst_i;
    reg  to_control_q, to_interrupt_q, to_record_q, to_steps_q, to_step_q, to_last_q, to_size_q, to_visit_q, to_clock_q;
    always @(posedge clk_i) begin
        to_control_q   <= writes && register_q == ADDR_CONTROL[6:2];
        to_interrupt_q <= writes && register_q == ADDR_INTERRUPT[6:2];
        to_record_q    <= writes && register_q == ADDR_RECORD[6:2];
        to_steps_q     <= writes && register_q == ADDR_STEPS[6:2];
        to_step_q      <= writes && register_q == ADDR_STEP[6:2];
        to_last_q      <= writes && register_q == ADDR_LAST[6:2];
        to_size_q      <= writes && register_q == ADDR_SIZE[6:2];
        to_visit_q     <= writes && register_q == ADDR_VISIT[6:2];
        to_clock_q     <= writes && register_q == ADDR_CLOCK[6:2];
    end
    wire start        = to_control_q && ok_q && wants_start;
    wire to_interrupt = to_interrupt_q && ok_q;
    reg  start_q, clear_q;             // a start reaches far: it begins in the next cycle
    reg  no_steps_q;
    always @(posedge clk_i) begin
        no_steps_q <= steps_q == 32'd0;
        start_q    <= start && !no_steps_q && !rst_i;
        clear_q    <= start;
    end
    assign start_o = start_q;
    assign stop_o  = to_control_q && ok_q && wants_stop && running_i;

    always @(posedge clk_i)
        if (rst_i) begin
            {steps_q, visit_q, clock_q, record_q} <= 98'd0;
            {step_q, last_q, size_q}              <= {3*(PROGRAM_W+1){1'b0}};
        end else if (ok_q) begin
            if (to_record_q) record_q <= wdata_q[1:0] + 2'd1;
            if (to_steps_q)  steps_q  <= wdata_q;
            if (to_step_q)   step_q   <= wdata_q[PROGRAM_W:0];
            if (to_last_q)   last_q   <= wdata_q[PROGRAM_W:0];
            if (to_size_q)   size_q   <= wdata_q[PROGRAM_W:0];
            if (to_visit_q)  visit_q  <= wdata_q;
            if (to_clock_q)  clock_q  <= wdata_q;
        end

    always @(posedge clk_i)
        if (rst_i) begin
            {done_q, illegal_q, stopped_q, was_running_q, flags_q, irq_enable_q, ended_q} <= 11'd0;
            fault_q <= {PROGRAM_W{1'b0}};
        end else begin
            was_running_q <= running_i;
            if (start) begin
                {illegal_q, stopped_q, flags_q} <= 7'd0;
                {done_q, ended_q} <= {2{no_steps_q}};
            end else begin
                // The first reason to end is the one that counts.
                if (stop_o && !illegal_i && !illegal_q) stopped_q <= 1'b1;
                if (illegal_i && !stopped_q) {illegal_q, fault_q} <= {1'b1, illegal_pc_i};
                flags_q <= flags_q | flags_i;
                if (was_running_q && !running_i) {ended_q, done_q} <= {1'b1, !illegal_q && !stopped_q};
                else if (to_interrupt && wdata_q[INTERRUPT_ENDED_LO]) ended_q <= 1'b0;
            end
            if (to_interrupt) irq_enable_q <= wdata_q[INTERRUPT_ENABLE_LO];
        end

    // step and last are at most size <= PROGRAM_WORDS, and last and size at least 1: their ends
    // fit the program counter.
    reg  [PROGRAM_W:0] step_end_q, last_end_q;
    always @(posedge clk_i) begin
        step_end_q <= last_q - 1'b1;
        last_end_q <= size_q - 1'b1;
    end
    assign {steps_o, visit_o, clock_o, record_o} = {steps_q, visit_q, clock_q, record_q};
    assign step_o     = step_q[PROGRAM_W-1:0];
    assign step_end_o = step_end_q[PROGRAM_W-1:0];
    assign end_o      = last_end_q[PROGRAM_W-1:0];
    wire unused = step_q[PROGRAM_W] | step_end_q[PROGRAM_W] | last_end_q[PROGRAM_W];

    assign {access_o, write_o, space_o, addr_o} = {access_q, writes_q, space_q, address_q};
    assign program_write_o  = load_q;
    assign program_addr_o   = address_q[PROGRAM_W-1:0];
    assign wdata_o          = memory_wdata_q;
    assign counters_clear_o = clear_q;
    assign counters_read_o  = ours_q;
    assign counters_index_o = counter_q;
    assign counters_high_o  = counters_high_q;

    assign irq_o       = irq_enable_q && ended_q;

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
        if (!rst_i && start_o && !(step_o <= step_end_o && step_end_o <= end_o)) begin
            $display("%m: a run starts whose steps are the words %0d to %0d of 0 to %0d", step_o, step_end_o, end_o); $stop;
        end
`endif
endmodule
`default_nettype wire
