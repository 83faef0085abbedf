// host_port: the host's registers and its windows onto the memories.
//
// Purpose   One request, one response. Loads programs, constants and objects, starts and stops
//           runs, and shows how they went. isa/registers.toml is the map.
// Latency   The response comes three cycles after the request is taken: one to decode it, one to
//           execute it, so that no path leads from the address through all that it may mean to
//           a memory.
// Promise   Every request is answered. What has no register, no such access or no sense is
//           answered with rsp_error_o and changes nothing.
//
//     cycle        0     1     2     3     4
//     req_valid_i  1     0     0     0     1        req_ready_o falls until the response is taken
//     req_ready_o  1     0     0     0     1
//     rsp_valid_o  0     0     0     1     0
`default_nettype none
module host_port #(
    parameter REGISTER_W    = 5,
    parameter CONTEXTS      = 1,
    parameter CONTEXT_W     = 1,
    parameter PROGRAM_W     = 9,
    parameter [31:0] FEATURES = 0
) (
    input  wire                            clk_i,
    input  wire                            rst_i,
    // Requests and responses
    input  wire                            req_valid_i,
    output wire                            req_ready_o,
    input  wire                            req_write_i,
    input  wire [15:0]                     req_addr_i,
    input  wire [31:0]                     req_wdata_i,
    output wire                            rsp_valid_o,
    input  wire                            rsp_ready_i,
    output wire [31:0]                     rsp_rdata_o,
    output wire                            rsp_error_o,
    // The scheduler's run
    output wire                            start_o,
    output wire                            stop_o,
    output wire [31:0]                     steps_o,
    output wire [PROGRAM_W-1:0]            step_o,
    output wire [PROGRAM_W-1:0]            step_end_o,
    output wire [PROGRAM_W-1:0]            end_o,
    input  wire                            running_i,
    input  wire                            illegal_i,
    input  wire [PROGRAM_W-1:0]            illegal_pc_i,
    input  wire                            retire_i,
    input  wire [4:0]                      retire_flags_i,
    // Its memories
    output wire                            program_write_o,
    output wire [PROGRAM_W-1:0]            program_addr_o,
    output wire                            write_o,
    output wire [CONTEXT_W+REGISTER_W-1:0] addr_o,
    output wire [31:0]                     wdata_o,
    input  wire [31:0]                     rdata_i,
    // Its counters
    output wire                            counters_clear_o,
    output wire [3:0]                      counters_index_o,
    input  wire [63:0]                     counters_value_i
);
`include "gen/isa.vh"
`include "gen/registers.vh"
    localparam [31:0] REGISTERS     = 32'd1 << REGISTER_W;
    localparam [31:0] PROGRAM_WORDS = 32'd1 << PROGRAM_W;
    localparam [31:0] CONTEXTS_32   = CONTEXTS;
    localparam [CONTEXT_W-1:0] SHARED = CONTEXTS;
    localparam [15:0] IN_WINDOW       = 16'h3fff;         // address bits within the objects' window

    // Take a request, decode it, execute it, hold the response until it is taken.
    reg        decode_q, execute_q, respond_q;
    reg        write_q;
    reg [15:0] addr_q;
    reg [31:0] wdata_q;
    assign req_ready_o = !rst_i && !decode_q && !execute_q && !respond_q;
    assign rsp_valid_o = respond_q;

    always @(posedge clk_i) begin
        if (rst_i) {decode_q, execute_q, respond_q} <= 3'b000;
        else begin
            decode_q  <= req_valid_i && req_ready_o;
            execute_q <= decode_q;
            respond_q <= execute_q || (respond_q && !rsp_ready_i);
        end
        if (req_valid_i && req_ready_o) {write_q, addr_q, wdata_q} <= {req_write_i, req_addr_i, req_wdata_i};
    end

    // Where a request goes
    wire in_program   = addr_q[15:12] == ADDR_WINDOW_PROGRAM[15:12]
                     && {22'd0, addr_q[11:2]} < PROGRAM_WORDS;
    wire in_constants = addr_q[15:8] == ADDR_WINDOW_CONSTANTS[15:8] && {26'd0, addr_q[7:2]} < REGISTERS;
    wire in_objects   = addr_q[15:14] == ADDR_WINDOW_OBJECTS[15:14]
                     && {26'd0, addr_q[13:8]} < CONTEXTS_32 && {26'd0, addr_q[7:2]} < REGISTERS;
    wire in_values    = in_constants || in_objects;
    wire [15:0] from_counters = addr_q - ADDR_COUNTERS;
    wire in_counters  = addr_q >= ADDR_COUNTERS && from_counters < 8 * COUNTERS;

    // The run's description and its outcome
    reg [31:0]        steps_q;
    reg [PROGRAM_W:0] step_q, last_q, size_q;
    reg               done_q, illegal_q, stopped_q, was_running_q;
    reg [PROGRAM_W-1:0] fault_q;
    reg [4:0]         flags_q;

    wire runnable   = step_q < last_q && last_q <= size_q;
    wire is_index   = wdata_q <= PROGRAM_WORDS;
    wire wants_stop = wdata_q[CONTROL_STOP_LO];
    wire wants_start = wdata_q[CONTROL_START_LO];

    // The outcome is known in the cycle after the end: until then the run goes on.
    wire busy = running_i || was_running_q;

    reg        ok;                     // this access has a meaning now
    reg [31:0] rdata;
    always @* begin
        ok    = 1'b0;
        rdata = 32'd0;
        case (addr_q)
            ADDR_ID:       {ok, rdata} = {!write_q, 24'h465033, ISA_REVISION};
            ADDR_SHAPE:    {ok, rdata} = {!write_q, CONTEXTS_32[15:0], REGISTERS[7:0], REGISTERS[7:0]};
            ADDR_MEMORY:   {ok, rdata} = {!write_q, PROGRAM_WORDS};
            ADDR_FEATURES: {ok, rdata} = {!write_q, FEATURES};
            ADDR_CONTROL:  ok = write_q && !(wants_start && (running_i || wants_stop || !runnable));
            ADDR_STATUS:   {ok, rdata} = {!write_q, 28'd0, {stopped_q, illegal_q, done_q} & {3{!busy}}, busy};
            ADDR_FAULT:    {ok, rdata} = {!write_q, {32-PROGRAM_W{1'b0}}, fault_q};
            ADDR_FLAGS:    {ok, rdata} = {!write_q, 27'd0, flags_q};
            ADDR_STEPS:    {ok, rdata} = {!write_q || !running_i, steps_q};
            ADDR_STEP:     {ok, rdata} = {!write_q || (!running_i && is_index), {31-PROGRAM_W{1'b0}}, step_q};
            ADDR_LAST:     {ok, rdata} = {!write_q || (!running_i && is_index), {31-PROGRAM_W{1'b0}}, last_q};
            ADDR_SIZE:     {ok, rdata} = {!write_q || (!running_i && is_index), {31-PROGRAM_W{1'b0}}, size_q};
            default: begin
                ok    = in_counters ? !write_q : !running_i && (in_values || (in_program && write_q));
                rdata = addr_q[2] ? counters_value_i[63:32] : counters_value_i[31:0];
            end
        endcase
        if (addr_q[1:0] != 2'b00) ok = 1'b0;
    end

    // What was decoded is executed in the next cycle. A run may end in between, and nothing else
    // may change, so it still has its meaning.
    reg        ok_q, to_program_q, to_values_q, to_control_q, to_steps_q, to_step_q, to_last_q, to_size_q;
    reg [31:0] rdata_q;
    always @(posedge clk_i)
        if (decode_q) begin
            ok_q         <= ok;
            rdata_q      <= write_q || !ok ? 32'd0 : rdata;
            to_program_q <= in_program;
            to_values_q  <= in_values;
            to_control_q <= addr_q == ADDR_CONTROL;
            to_steps_q   <= addr_q == ADDR_STEPS;
            to_step_q    <= addr_q == ADDR_STEP;
            to_last_q    <= addr_q == ADDR_LAST;
            to_size_q    <= addr_q == ADDR_SIZE;
        end

    wire write   = execute_q && write_q && ok_q && !rst_i;
    wire control = write && to_control_q;
    wire start   = control && wants_start;
    assign start_o = start && steps_q != 32'd0;
    assign stop_o  = control && wants_stop && running_i;

    always @(posedge clk_i)
        if (rst_i) begin
            {steps_q, step_q, last_q, size_q} <= {32 + 3*(PROGRAM_W+1){1'b0}};
        end else if (write) begin
            if (to_steps_q) steps_q <= wdata_q;
            if (to_step_q)  step_q  <= wdata_q[PROGRAM_W:0];
            if (to_last_q)  last_q  <= wdata_q[PROGRAM_W:0];
            if (to_size_q)  size_q  <= wdata_q[PROGRAM_W:0];
        end

    always @(posedge clk_i)
        if (rst_i) begin
            {done_q, illegal_q, stopped_q, was_running_q, flags_q} <= 9'd0;
            fault_q <= {PROGRAM_W{1'b0}};
        end else begin
            was_running_q <= running_i;
            if (start) begin
                {illegal_q, stopped_q, flags_q} <= 7'd0;
                done_q <= steps_q == 32'd0;
            end else begin
                // The first reason to end is the one that counts.
                if (stop_o && !illegal_i && !illegal_q) stopped_q <= 1'b1;
                if (illegal_i && !stopped_q) {illegal_q, fault_q} <= {1'b1, illegal_pc_i};
                if (retire_i)  flags_q <= flags_q | retire_flags_i;
                if (was_running_q && !running_i) done_q <= !illegal_q && !stopped_q;
            end
        end

    // step and last are at most size <= PROGRAM_WORDS, and last and size at least 1: their ends
    // fit the program counter.
    wire [PROGRAM_W:0] step_end = last_q - 1'b1;
    wire [PROGRAM_W:0] last_end = size_q - 1'b1;
    assign steps_o    = steps_q;
    assign step_o     = step_q[PROGRAM_W-1:0];
    assign step_end_o = step_end[PROGRAM_W-1:0];
    assign end_o      = last_end[PROGRAM_W-1:0];
    wire unused = step_q[PROGRAM_W] | step_end[PROGRAM_W] | last_end[PROGRAM_W];

    assign program_write_o  = write && to_program_q;
    assign program_addr_o   = addr_q[PROGRAM_W+1:2];
    assign write_o          = write && to_values_q;
    assign addr_o           = {in_objects ? addr_q[8 +: CONTEXT_W] & IN_WINDOW[8 +: CONTEXT_W] : SHARED,
                               addr_q[REGISTER_W+1:2]};
    assign wdata_o          = wdata_q;
    assign counters_clear_o = start;
    assign counters_index_o = from_counters[6:3];

    assign rsp_error_o = !ok_q;
    assign rsp_rdata_o = to_values_q && ok_q && !write_q ? rdata_i : rdata_q;
endmodule
`default_nettype wire
