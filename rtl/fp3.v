// fp3: the field-programmable physics processor, one workload scheduler and its arithmetic unit.
//
// Purpose   Integrates equations of motion. A host loads a program and objects over the host port
//           and starts a run of N steps; docs/architecture.md says how the parts work together.
//
//           host port ──► scheduler ──► arithmetic unit
//               │    ◄──     │     ◄────────┘
//               └─ counters ◄┘
//
// Latency   See scheduler (a run), host_port (an access).
// Hazard    trace ports (issue_*, retire_*) are for simulation; leave them open in a design.
//           Use a named configuration (rtl/gen/fp3_<name>.v) or set parameters here.
`default_nettype none
module fp3 #(
    parameter REGISTERS       = 32,    // object registers per context, and as many constants: 2, 4 .. 64
    parameter CONTEXTS        = 1,     // objects: 1 .. 64
    parameter PROGRAM_WORDS   = 512,   // instruction memory: 2, 4 .. 1024
    parameter BYPASS          = 1,     // results go straight to a waiting operand
    parameter WRITEBACK_STALL = 0,     // no issue in a cycle in which a result is written
    parameter CHAIN           = 1,     // madd and msub
    parameter SUBNORMAL       = 1,     // 1: gradual underflow, 0: flushed
    parameter NEAREST         = 1,     // 1: nearest-even, 0: truncated
    parameter ADD_LATENCY     = 1,     // at least 1 + the number of cuts
    parameter MUL_LATENCY     = 1,     // likewise
    parameter [6:0] ADD_CUTS  = 0,     // see fp_add
    parameter [6:0] MUL_CUTS  = 0      // see fp_mul
) (
    input  wire        clk_i,
    input  wire        rst_i,
    // Host port
    input  wire        req_valid_i,
    output wire        req_ready_o,
    input  wire        req_write_i,
    input  wire [15:0] req_addr_i,
    input  wire [31:0] req_wdata_i,
    output wire        rsp_valid_o,
    input  wire        rsp_ready_i,
    output wire [31:0] rsp_rdata_o,
    output wire        rsp_error_o,
    // Trace: an instruction issues
    output wire        issue_valid_o,
    output wire [15:0] issue_pc_o,
    output wire [15:0] issue_context_o,
    output wire [31:0] issue_word_o,
    // Trace: a result is written
    output wire        retire_valid_o,
    output wire [15:0] retire_context_o,
    output wire [5:0]  retire_register_o,
    output wire [31:0] retire_value_o,
    output wire [4:0]  retire_flags_o
);
`include "gen/registers.vh"
    localparam REGISTER_W = $clog2(REGISTERS);
    localparam CONTEXT_W  = $clog2(CONTEXTS + 1);         // the constants are one context more
    localparam PROGRAM_W  = $clog2(PROGRAM_WORDS);
    localparam [7:0] ADD_LATENCY_8 = ADD_LATENCY;
    localparam [7:0] MUL_LATENCY_8 = MUL_LATENCY;
    localparam [31:0] FEATURES =
          (CHAIN           != 0 ? 32'd1 << FEATURES_CHAIN_LO           : 32'd0)
        | (BYPASS          != 0 ? 32'd1 << FEATURES_BYPASS_LO          : 32'd0)
        | (WRITEBACK_STALL != 0 ? 32'd1 << FEATURES_WRITEBACK_STALL_LO : 32'd0)
        | (SUBNORMAL       != 0 ? 32'd1 << FEATURES_SUBNORMAL_LO       : 32'd0)
        | (NEAREST         != 0 ? 32'd1 << FEATURES_NEAREST_LO         : 32'd0)
        | {24'd0, ADD_LATENCY_8} << FEATURES_ADD_LATENCY_LO
        | {24'd0, MUL_LATENCY_8} << FEATURES_MUL_LATENCY_LO;

    // A parameter that cannot be built names a module that does not exist: elaboration ends there.
    generate
        if (REGISTERS != 1 << REGISTER_W || REGISTERS < 2 || REGISTERS > 64) begin : g_registers
            REGISTERS_must_be_a_power_of_two_from_2_to_64 u_error ();
        end
        if (PROGRAM_WORDS != 1 << PROGRAM_W || PROGRAM_WORDS < 2 || PROGRAM_WORDS > 1024) begin : g_program
            PROGRAM_WORDS_must_be_a_power_of_two_from_2_to_1024 u_error ();
        end
        if (CONTEXTS < 1 || CONTEXTS > 64) begin : g_contexts
            CONTEXTS_must_be_1_to_64 u_error ();
        end
    endgenerate

    wire                            start, stop, running, illegal;
    wire [31:0]                     steps;
    wire [PROGRAM_W-1:0]            step, step_end, last_end, issue_pc, program_addr;
    wire                            program_write, host_write;
    wire [CONTEXT_W+REGISTER_W-1:0] host_addr;
    wire [31:0]                     host_wdata, host_rdata;
    wire                            issue_add, issue_mul, issue_chain;
    wire                            stall_fetch, stall_dependency, stall_unit, stall_writeback, stall_drain;
    wire [CONTEXT_W-1:0]            issue_context, retire_context;
    wire [REGISTER_W-1:0]           retire_register;
    wire                            counters_clear;
    wire [3:0]                      counters_index;
    wire [63:0]                     counters_value;
    wire                            chain, chain_soon, subtract;
    wire [31:0]                     a, b, c, add_value, mul_value;
    wire [4:0]                      add_flags, mul_flags;

    host_port #(.REGISTER_W(REGISTER_W), .CONTEXTS(CONTEXTS), .CONTEXT_W(CONTEXT_W),
                .PROGRAM_W(PROGRAM_W), .FEATURES(FEATURES)) u_host_port (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_ready_o(req_ready_o), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .rsp_valid_o(rsp_valid_o), .rsp_ready_i(rsp_ready_i), .rsp_rdata_o(rsp_rdata_o),
        .rsp_error_o(rsp_error_o),
        .start_o(start), .stop_o(stop), .steps_o(steps), .step_o(step), .step_end_o(step_end),
        .end_o(last_end), .running_i(running), .illegal_i(illegal), .illegal_pc_i(issue_pc),
        .retire_i(retire_valid_o), .retire_flags_i(retire_flags_o),
        .program_write_o(program_write), .program_addr_o(program_addr),
        .write_o(host_write), .addr_o(host_addr), .wdata_o(host_wdata), .rdata_i(host_rdata),
        .counters_clear_o(counters_clear), .counters_index_o(counters_index),
        .counters_value_i(counters_value));

    scheduler #(.REGISTER_W(REGISTER_W), .CONTEXTS(CONTEXTS), .CONTEXT_W(CONTEXT_W),
                .PROGRAM_W(PROGRAM_W), .BYPASS(BYPASS), .WRITEBACK_STALL(WRITEBACK_STALL),
                .CHAIN(CHAIN), .ADD_LATENCY(ADD_LATENCY), .MUL_LATENCY(MUL_LATENCY)) u_scheduler (
        .clk_i(clk_i), .rst_i(rst_i),
        .start_i(start), .stop_i(stop), .steps_i(steps), .step_i(step), .step_end_i(step_end),
        .end_i(last_end), .running_o(running), .illegal_o(illegal),
        .host_program_i(program_write), .host_write_i(host_write),
        .host_program_addr_i(program_addr), .host_addr_i(host_addr), .host_wdata_i(host_wdata),
        .host_rdata_o(host_rdata),
        .chain_o(chain), .subtract_o(subtract), .a_o(a), .b_o(b), .c_o(c),
        .chain_soon_i(chain_soon), .add_value_i(add_value), .add_flags_i(add_flags),
        .mul_value_i(mul_value), .mul_flags_i(mul_flags),
        .issue_o(issue_valid_o), .issue_add_o(issue_add), .issue_mul_o(issue_mul),
        .issue_chain_o(issue_chain), .issue_pc_o(issue_pc), .issue_context_o(issue_context),
        .issue_word_o(issue_word_o),
        .stall_fetch_o(stall_fetch), .stall_dependency_o(stall_dependency),
        .stall_unit_o(stall_unit), .stall_writeback_o(stall_writeback), .stall_drain_o(stall_drain),
        .retire_o(retire_valid_o), .retire_context_o(retire_context),
        .retire_register_o(retire_register), .retire_value_o(retire_value_o),
        .retire_flags_o(retire_flags_o));

    arith_unit #(.CHAIN(CHAIN), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST),
                 .ADD_LATENCY(ADD_LATENCY), .MUL_LATENCY(MUL_LATENCY),
                 .ADD_CUTS(ADD_CUTS), .MUL_CUTS(MUL_CUTS)) u_arith_unit (
        .clk_i(clk_i), .rst_i(rst_i),
        .chain_i(chain), .subtract_i(subtract), .add_a_i(a), .add_b_i(b),
        .mul_a_i(a), .mul_b_i(b), .mul_c_i(c), .chain_soon_o(chain_soon),
        .add_value_o(add_value), .add_flags_o(add_flags),
        .mul_value_o(mul_value), .mul_flags_o(mul_flags));

    // In the order of isa/registers.toml, the first counter in bit 0.
    counters #(.N(COUNTERS)) u_counters (
        .clk_i(clk_i), .clear_i(rst_i || counters_clear),
        .event_i({stall_drain, stall_writeback, stall_unit, stall_dependency, stall_fetch,
                  retire_valid_o, issue_chain, issue_mul, issue_add, running}),
        .index_i(counters_index), .value_o(counters_value));

    assign issue_pc_o        = {{16-PROGRAM_W{1'b0}}, issue_pc};
    assign issue_context_o   = {{16-CONTEXT_W{1'b0}}, issue_context};
    assign retire_context_o  = {{16-CONTEXT_W{1'b0}}, retire_context};
    assign retire_register_o = {{6-REGISTER_W{1'b0}}, retire_register};
endmodule
`default_nettype wire
