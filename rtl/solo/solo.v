// solo: one scheduler with busy flags and its arithmetic unit, for one object.
//
// Purpose   The paper's machine, and the one with the shortest time for a single object: results
//           are taken as soon as they can be, whatever their unit's latency.
//
//           host port ──► scheduler ──► arithmetic unit
//               │    ◄──     │     ◄────────┘
//               └─ counters ◄┘
//
//           Trace ports (issue_*, retire_*) are for simulation.
// Latency   See solo_scheduler (a run), host_port (an access).
`default_nettype none
`include "host/answer.vh"
`include "unit/socket.vh"
module solo #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        rst_i,
    // Host port
    input  wire        req_valid_i,
    input  wire        req_write_i,
    input  wire [23:0] req_addr_i,
    input  wire [31:0] req_wdata_i,
    output wire [`ANSWER_W-1:0] answer_o,
    output wire        irq_o,
    // Trace
    output wire        issue_valid_o,
    output wire [15:0] issue_pc_o,
    output wire [31:0] issue_word_o,
    output wire        retire_valid_o,
    output wire [5:0]  retire_register_o,
    output wire [31:0] retire_value_o,
    output wire [4:0]  retire_flags_o
);
`include "gen/registers.vh"
`include "host/lane_host.vh"
    wire                            start, stop, running, illegal;
    wire [31:0]                     steps;
    wire [PROGRAM_W-1:0]            step, step_end, last_end, issue_pc, program_addr;
    wire                            program_write, access, host_write;
    wire [2:0]                      space;
    wire [19:0]                     address;
    wire [31:0]                     unused_visit, unused_clock;
    wire [1:0]                      unused_record;
    wire [31:0]                     host_wdata, host_rdata;
    wire                            issue_add, issue_mul, issue_chain;
    wire                            stall_fetch, stall_dependency, stall_unit, stall_writeback, stall_drain;
    wire [REGISTER_W-1:0]           retire_register;
    wire                            counters_clear, counters_read, counters_high;
    wire [3:0]                      counters_index;
    wire [31:0]                     counters_value;
    wire                            chain, chain_soon;
    wire [`OPERANDS_W-1:0]          operands;
    wire [`RESULT_W-1:0]            sum, product;
    wire [31:0]                     add_a, add_b, chain_z;
    wire [4:0]                      retire_flags;

    host_port #(.CONFIG(CONFIG)) u_host_port (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .answer_o(answer_o), .irq_o(irq_o),
        .start_o(start), .stop_o(stop), .steps_o(steps), .visit_o(unused_visit), .clock_o(unused_clock), .record_o(unused_record),
        .step_o(step), .step_end_o(step_end), .end_o(last_end),
        .running_i(running), .illegal_i(illegal), .illegal_pc_i(issue_pc),
        .flags_i(retire_flags_o & {5{retire_valid_o}}),
        .program_write_o(program_write), .program_addr_o(program_addr),
        .access_o(access), .write_o(host_write), .space_o(space), .addr_o(address),
        .wdata_o(host_wdata), .rdata_i(host_rdata),
        .counters_clear_o(counters_clear), .counters_read_o(counters_read), .counters_index_o(counters_index),
        .counters_high_o(counters_high),
        .counters_value_i(counters_value));

    // In reset a request may still be anything: registers keep what they have.
    solo_scheduler #(.CONFIG(CONFIG)) u_scheduler (
        .clk_i(clk_i), .rst_i(rst_i),
        .start_i(start), .stop_i(stop), .steps_i(steps), .step_i(step), .step_end_i(step_end),
        .end_i(last_end), .running_o(running), .illegal_o(illegal),
        .host_program_i(program_write), .host_write_i(access && host_write && !rst_i),
        .host_program_addr_i(program_addr),
        .host_addr_i({space == HOST_CONSTANT, address[REGISTER_W-1:0]}), .host_wdata_i(host_wdata),
        .host_rdata_o(host_rdata),
        .chain_o(chain), .operands_o(operands), .add_a_o(add_a), .add_b_o(add_b),
        .chain_soon_i(chain_soon), .chain_z_i(chain_z), .sum_i(sum), .product_i(product),
        .issue_o(issue_valid_o), .issue_add_o(issue_add), .issue_mul_o(issue_mul),
        .issue_chain_o(issue_chain), .issue_pc_o(issue_pc), .issue_word_o(issue_word_o),
        .stall_fetch_o(stall_fetch), .stall_dependency_o(stall_dependency),
        .stall_unit_o(stall_unit), .stall_writeback_o(stall_writeback), .stall_drain_o(stall_drain),
        .retire_o(retire_valid_o), .retire_register_o(retire_register), .retire_value_o(retire_value_o),
        .retire_flags_o(retire_flags));
    assign retire_flags_o = FLAGS != 0 ? retire_flags : 5'd0;

    solo_arith #(.CONFIG(CONFIG)) u_arith (
        .clk_i(clk_i), .rst_i(rst_i),
        .chain_i(chain), .operands_i(operands), .add_a_i(add_a), .add_b_i(add_b),
        .chain_soon_o(chain_soon), .chain_z_o(chain_z), .sum_o(sum), .product_o(product));

    reg [COUNTERS-1:0] events;
    always @* begin
        events = {COUNTERS{1'b0}};
        events[EVENT_CYCLES]           = running;
        events[EVENT_ISSUED_ADD]       = issue_add;
        events[EVENT_ISSUED_MUL]       = issue_mul;
        events[EVENT_ISSUED_CHAIN]     = issue_chain;
        events[EVENT_RETIRED]          = retire_valid_o;
        events[EVENT_STALL_FETCH]      = stall_fetch;
        events[EVENT_STALL_DEPENDENCY] = stall_dependency;
        events[EVENT_STALL_UNIT]       = stall_unit;
        events[EVENT_STALL_WRITEBACK]  = stall_writeback;
        events[EVENT_STALL_DRAIN]      = stall_drain;
    end
    counters #(.N(COUNTERS)) u_counters (
        .clk_i(clk_i), .clear_i(rst_i || counters_clear), .event_i(events),
        .read_i(counters_read), .index_i(counters_index), .high_i(counters_high), .value_o(counters_value));

    assign issue_pc_o        = {{16-PROGRAM_W{1'b0}}, issue_pc};
    assign retire_register_o = {{6-REGISTER_W{1'b0}}, retire_register};
    wire unused = |address;
endmodule
`default_nettype wire
