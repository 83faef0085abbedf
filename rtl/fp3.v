// fp3: the field-programmable physics processor.
//
// Purpose   Integrates equations of motion. A host loads a program and objects over the host port
//           and starts a run of N steps; docs/architecture.md says how the parts work together.
//
//           host port ──► hub ──► solo                     one object, INTERLEAVE = 0
//                          └────► tile, tile ...           many, INTERLEAVE = 1
//
// Latency   See solo, or sequencer and lane; hub for an access of the host.
// Hazard    Trace ports (issue_*, retire_*) are for simulation; leave them open in a design. They
//           have a part for each scheduler, or for each lane of each, the first in the low bits.
//           Use a named configuration (rtl/gen/fp3_<name>.v) or set parameters here.
`default_nettype none
module fp3 #(
    parameter INTERLEAVE      = 0,     // 1: contexts take turns; 0: one object, busy flags
    parameter TILES           = 1,     // INTERLEAVE: each with arithmetic of its own
    parameter SCHEDULERS      = 1,     // INTERLEAVE: of a tile, sharing an adder and a multiplier: 1 .. 8
    parameter LANES           = 1,     // INTERLEAVE: of a scheduler, if that has the tile for itself: 1 .. 64
    parameter REGISTERS       = 32,    // object registers per context, and as many constants: 2, 4 .. 64
    parameter CONTEXTS        = 1,     // INTERLEAVE: objects in flight in each lane: 1 .. 64
    parameter PROGRAM_WORDS   = 512,   // instruction memory: 2, 4 .. 8192
    parameter STORE_WORDS     = 0,     // INTERLEAVE: object store of a lane, a power of two, at least 16
    parameter BYPASS          = 1,     // not INTERLEAVE: results go straight to a waiting operand
    parameter WRITEBACK_STALL = 0,     // not INTERLEAVE: no issue in a cycle in which a result is written
    parameter CHAIN           = 1,     // madd and msub
    parameter SCALE           = 0,     // INTERLEAVE: addh, subh, addt, subt
    parameter SELECT          = 0,     // min, max, abs, lt, le, sel
    parameter ESTIMATE        = 0,     // rcp, rsqrt
    parameter SLEEP           = 0,     // INTERLEAVE: sleep and lds
    parameter FLAGS           = 1,     // exceptions are flagged
    parameter STATUS          = 0,     // INTERLEAVE: for each object, too
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
    input  wire [31:0] req_addr_i,
    input  wire [31:0] req_wdata_i,
    output wire        rsp_valid_o,
    input  wire        rsp_ready_i,
    output wire [31:0] rsp_rdata_o,
    output wire        rsp_error_o,
    // Trace: instructions issue
    output wire [TILES*SCHEDULERS-1:0]          issue_valid_o,
    output wire [16*TILES*SCHEDULERS-1:0]       issue_pc_o,
    output wire [16*TILES*SCHEDULERS-1:0]       issue_context_o,
    output wire [32*TILES*SCHEDULERS-1:0]       issue_word_o,
    // Trace: results are written
    output wire [TILES*SCHEDULERS*LANES-1:0]    retire_valid_o,
    output wire [16*TILES*SCHEDULERS*LANES-1:0] retire_context_o,
    output wire [32*TILES*SCHEDULERS*LANES-1:0] retire_object_o,
    output wire [6*TILES*SCHEDULERS*LANES-1:0]  retire_register_o,
    output wire [32*TILES*SCHEDULERS*LANES-1:0] retire_value_o,
    output wire [5*TILES*SCHEDULERS*LANES-1:0]  retire_flags_o
);
`include "gen/registers.vh"
    localparam N = TILES * SCHEDULERS;
    localparam [7:0] ADD_LATENCY_8 = ADD_LATENCY, MUL_LATENCY_8 = MUL_LATENCY;
    localparam [31:0] FEATURES =
          (CHAIN           != 0 ? 32'd1 << FEATURES_CHAIN_LO           : 32'd0)
        | (BYPASS          != 0 ? 32'd1 << FEATURES_BYPASS_LO          : 32'd0)
        | (WRITEBACK_STALL != 0 ? 32'd1 << FEATURES_WRITEBACK_STALL_LO : 32'd0)
        | (SUBNORMAL       != 0 ? 32'd1 << FEATURES_SUBNORMAL_LO       : 32'd0)
        | (NEAREST         != 0 ? 32'd1 << FEATURES_NEAREST_LO         : 32'd0)
        | (INTERLEAVE      != 0 ? 32'd1 << FEATURES_INTERLEAVE_LO      : 32'd0)
        | (SLEEP           != 0 ? 32'd1 << FEATURES_SLEEP_LO           : 32'd0)
        | (FLAGS           != 0 ? 32'd1 << FEATURES_FLAGS_LO           : 32'd0)
        | (SCALE           != 0 ? 32'd1 << FEATURES_SCALE_LO           : 32'd0)
        | (SELECT          != 0 ? 32'd1 << FEATURES_SELECT_LO          : 32'd0)
        | (ESTIMATE        != 0 ? 32'd1 << FEATURES_ESTIMATE_LO        : 32'd0)
        | (STATUS          != 0 ? 32'd1 << FEATURES_STATUS_LO          : 32'd0)
        | {24'd0, ADD_LATENCY_8} << FEATURES_ADD_LATENCY_LO
        | {24'd0, MUL_LATENCY_8} << FEATURES_MUL_LATENCY_LO;
    localparam [7:0] TILES_8 = TILES, SCHEDULERS_8 = SCHEDULERS, LANES_8 = LANES;
    localparam [31:0] ARRAY = {24'd0, TILES_8} << ARRAY_TILES_LO | {24'd0, SCHEDULERS_8} << ARRAY_SCHEDULERS_LO
                            | {24'd0, LANES_8} << ARRAY_LANES_LO;

    // A parameter that cannot be built names a module that does not exist: elaboration ends there.
    generate
        if (REGISTERS != 1 << $clog2(REGISTERS) || REGISTERS < 2 || REGISTERS > 64) begin : g_registers
            REGISTERS_must_be_a_power_of_two_from_2_to_64 u_error ();
        end
        if (PROGRAM_WORDS != 1 << $clog2(PROGRAM_WORDS) || PROGRAM_WORDS < 2 || PROGRAM_WORDS > 8192) begin : g_program
            PROGRAM_WORDS_must_be_a_power_of_two_from_2_to_8192 u_error ();
        end
        if (SELECT != 0 && CHAIN == 0) begin : g_select
            SELECT_needs_CHAIN u_error ();
        end
        if (CONTEXTS < 1 || CONTEXTS > 64) begin : g_contexts
            CONTEXTS_must_be_1_to_64 u_error ();
        end
        if (INTERLEAVE == 0 && (N * LANES * CONTEXTS != 1 || STORE_WORDS + SCALE + SLEEP + STATUS != 0)) begin : g_solo
            TILES_SCHEDULERS_LANES_CONTEXTS_STORE_WORDS_SCALE_SLEEP_STATUS_need_INTERLEAVE u_error ();
        end
        if (INTERLEAVE != 0 && (BYPASS != 0 || WRITEBACK_STALL != 0)) begin : g_bypass
            INTERLEAVE_has_neither_BYPASS_nor_WRITEBACK_STALL u_error ();
        end
        if (INTERLEAVE != 0 && (STORE_WORDS != 1 << $clog2(STORE_WORDS) || STORE_WORDS < 16 || STORE_WORDS < REGISTERS)) begin : g_store
            STORE_WORDS_must_be_a_power_of_two_at_least_16_and_REGISTERS u_error ();
        end
        if (INTERLEAVE != 0 && STORE_WORDS < 8 * CONTEXTS) begin : g_records
            STORE_WORDS_must_be_at_least_8_times_CONTEXTS u_error ();
        end
        if (SCHEDULERS < 1 || SCHEDULERS > 8 || LANES < 1 || LANES > 64 || N > 64 || (SCHEDULERS > 1 && LANES > 1)) begin : g_array
            SCHEDULERS_must_be_1_to_8_or_LANES_1_to_64 u_error ();
        end
        if (STATUS != 0 && FLAGS == 0) begin : g_status
            STATUS_needs_FLAGS u_error ();
        end
        if (INTERLEAVE != 0 && ADD_LATENCY + MUL_LATENCY < 3) begin : g_latency
            INTERLEAVE_needs_latencies_of_3_in_all u_error ();
        end
    endgenerate

    wire [N-1:0]    req_valid, req_ready, rsp_valid, rsp_error;
    wire            req_write, rsp_ready;
    wire [23:0]     req_addr;
    wire [31:0]     req_wdata;
    wire [32*N-1:0] rsp_rdata;
    hub #(.N(N)) u_hub (
        .clk_i(clk_i), .rst_i(rst_i),
        .req_valid_i(req_valid_i), .req_ready_o(req_ready_o), .req_write_i(req_write_i),
        .req_addr_i(req_addr_i), .req_wdata_i(req_wdata_i),
        .rsp_valid_o(rsp_valid_o), .rsp_ready_i(rsp_ready_i), .rsp_rdata_o(rsp_rdata_o), .rsp_error_o(rsp_error_o),
        .req_valid_o(req_valid), .req_ready_i(req_ready), .req_write_o(req_write), .req_addr_o(req_addr),
        .req_wdata_o(req_wdata), .rsp_valid_i(rsp_valid), .rsp_ready_o(rsp_ready), .rsp_rdata_i(rsp_rdata),
        .rsp_error_i(rsp_error));

    genvar t;
    generate
        if (INTERLEAVE == 0) begin : g_one
            assign {issue_context_o, retire_context_o, retire_object_o} = 64'd0;
            solo #(.REGISTERS(REGISTERS), .PROGRAM_WORDS(PROGRAM_WORDS), .BYPASS(BYPASS),
                   .WRITEBACK_STALL(WRITEBACK_STALL), .CHAIN(CHAIN), .SELECT(SELECT), .ESTIMATE(ESTIMATE), .FLAGS(FLAGS),
                   .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .ADD_LATENCY(ADD_LATENCY), .MUL_LATENCY(MUL_LATENCY),
                   .ADD_CUTS(ADD_CUTS), .MUL_CUTS(MUL_CUTS), .FEATURES(FEATURES), .ARRAY(ARRAY)) u_solo (
                .clk_i(clk_i), .rst_i(rst_i),
                .req_valid_i(req_valid[0]), .req_ready_o(req_ready[0]), .req_write_i(req_write), .req_addr_i(req_addr),
                .req_wdata_i(req_wdata), .rsp_valid_o(rsp_valid[0]), .rsp_ready_i(rsp_ready), .rsp_rdata_o(rsp_rdata),
                .rsp_error_o(rsp_error[0]),
                .issue_valid_o(issue_valid_o), .issue_pc_o(issue_pc_o), .issue_word_o(issue_word_o),
                .retire_valid_o(retire_valid_o), .retire_register_o(retire_register_o),
                .retire_value_o(retire_value_o), .retire_flags_o(retire_flags_o));
        end else begin : g_many
            localparam S = SCHEDULERS, L = SCHEDULERS * LANES;
            for (t = 0; t < TILES; t = t + 1) begin : g_tile
                tile #(.SCHEDULERS(SCHEDULERS), .LANES(LANES), .REGISTERS(REGISTERS), .CONTEXTS(CONTEXTS),
                       .PROGRAM_WORDS(PROGRAM_WORDS), .STORE_WORDS(STORE_WORDS), .CHAIN(CHAIN), .SCALE(SCALE),
                       .SELECT(SELECT), .ESTIMATE(ESTIMATE), .SLEEP(SLEEP), .FLAGS(FLAGS), .STATUS(STATUS), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST),
                       .ADD_LATENCY(ADD_LATENCY), .MUL_LATENCY(MUL_LATENCY), .ADD_CUTS(ADD_CUTS), .MUL_CUTS(MUL_CUTS),
                       .FEATURES(FEATURES), .ARRAY(ARRAY)) u_tile (
                    .clk_i(clk_i), .rst_i(rst_i),
                    .req_valid_i(req_valid[S*t +: S]), .req_ready_o(req_ready[S*t +: S]), .req_write_i(req_write),
                    .req_addr_i(req_addr), .req_wdata_i(req_wdata), .rsp_valid_o(rsp_valid[S*t +: S]),
                    .rsp_ready_i(rsp_ready), .rsp_rdata_o(rsp_rdata[32*S*t +: 32*S]), .rsp_error_o(rsp_error[S*t +: S]),
                    .issue_valid_o(issue_valid_o[S*t +: S]), .issue_pc_o(issue_pc_o[16*S*t +: 16*S]),
                    .issue_context_o(issue_context_o[16*S*t +: 16*S]), .issue_word_o(issue_word_o[32*S*t +: 32*S]),
                    .retire_valid_o(retire_valid_o[L*t +: L]), .retire_context_o(retire_context_o[16*L*t +: 16*L]),
                    .retire_object_o(retire_object_o[32*L*t +: 32*L]),
                    .retire_register_o(retire_register_o[6*L*t +: 6*L]),
                    .retire_value_o(retire_value_o[32*L*t +: 32*L]), .retire_flags_o(retire_flags_o[5*L*t +: 5*L]));
            end
        end
    endgenerate
endmodule
`default_nettype wire
