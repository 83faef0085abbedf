// config_rules: ends elaboration where a configuration cannot be built.
//
// Purpose   The rules that tools/generate.py checks for the named configurations, for those that set
//           fp3's parameters themselves. A broken rule names a module that does not exist. A tool that
//           takes unknown modules for black boxes does not end; it shows the name.
// Latency   None: there is no logic in here.
//
//     fp3 #(.REGISTERS(24)) u_fp3 (...);
//     // error: unknown module REGISTERS_must_be_a_power_of_two_from_2_to_64
`default_nettype none
module config_rules #(
`include "config/config.vh"
) ();
    localparam N = TILES * SCHEDULERS;
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
        if (DUAL != 0 && (INTERLEAVE == 0 || CHAIN + ESTIMATE + ROUND + SLEEP + STATUS != 0)) begin : g_dual
            DUAL_needs_INTERLEAVE_and_has_no_CHAIN_ESTIMATE_ROUND_SLEEP_STATUS u_error ();
        end
        if (DUAL != 0 && (SCHEDULERS != 1 || REGISTERS < 4 || LATENCY < 2)) begin : g_dual_shape
            DUAL_needs_one_SCHEDULER_4_REGISTERS_and_a_latency_of_2 u_error ();
        end
        if (STATUS != 0 && FLAGS == 0) begin : g_status
            STATUS_needs_FLAGS u_error ();
        end
        if (INTERLEAVE != 0 && ADD_LATENCY + MUL_LATENCY < 3) begin : g_latency
            INTERLEAVE_needs_latencies_of_3_in_all u_error ();
        end
        if (ADD_SPARE < 1) begin : g_add_latency
            ADD_LATENCY_must_be_more_than_the_cuts u_error ();
        end
        if (MUL_SPARE < 1) begin : g_mul_latency
            MUL_LATENCY_must_be_more_than_the_cuts u_error ();
        end
    endgenerate
endmodule
`default_nettype wire
