// SPDX-License-Identifier: Apache-2.0
// fp3_config_rules: ends elaboration where a configuration cannot be built.
//
// Purpose   The rules that tools/generate.py checks for the named configurations, for designs that
//           set fp3's parameters themselves. What one key says alone, needs or excludes comes from
//           its table in isa/configs.toml. A broken rule names a module that does not exist. A tool
//           that takes unknown modules for black boxes does not end; it shows the name.
// Latency   None: there is no logic in here.
//
//     fp3 #(.REGISTERS(24)) u_fp3 (...);
//     // error: unknown module REGISTERS_must_be_2_to_64_and_a_power_of_two
`default_nettype none
module fp3_config_rules #(
    parameter integer FOLLOW = -1,     // of fp3: its parameters that follow from others; -1: not told
`include "config/config.vh"
) ();
    generate
`include "gen/config_rules.vh"
        if (INTERLEAVE != 0 && (STORE_WORDS < 16 || STORE_WORDS < REGISTERS)) begin : g_store
            STORE_WORDS_must_be_at_least_16_and_REGISTERS u_error ();
        end
        if (INTERLEAVE != 0 && STORE_WORDS < 8 * CONTEXTS) begin : g_records
            STORE_WORDS_must_be_at_least_8_times_CONTEXTS u_error ();
        end
        if (LANES * STORE_WORDS > 1048576) begin : g_words
            LANES_times_STORE_WORDS_must_be_at_most_1048576 u_error ();
        end
        if (TILES * SCHEDULERS > 64 || (SCHEDULERS > 1 && LANES > 1)) begin : g_array
            SCHEDULERS_must_be_at_most_64_in_all_and_1_with_LANES u_error ();
        end
        if (DUAL != 0 && (SCHEDULERS != 1 || REGISTERS < 4 || LATENCY < 2)) begin : g_dual_shape
            MULTIPLY_ADD_DUAL_needs_one_SCHEDULER_4_REGISTERS_and_a_latency_of_2 u_error ();
        end
        if (INTERLEAVE != 0 && ADD_LATENCY + MUL_LATENCY < 3) begin : g_latency
            STORE_WORDS_needs_latencies_of_3_in_all u_error ();
        end
        if (LOGARITHMIC != 0 && (SCHEDULERS != 1 || MUL_LATENCY < 2 || ADD_LATENCY < 10)) begin : g_logarithmic
            ARITHMETIC_LOGARITHMIC_needs_one_SCHEDULER_and_latencies_of_2_and_10 u_error ();
        end
        if (MIXED != 0 && (SCHEDULERS != 1 || ADD_LATENCY + MUL_LATENCY < 14)) begin : g_mixed
            RECIPROCAL_MIXED_needs_one_SCHEDULER_and_latencies_of_14_in_all u_error ();
        end
        if (STORAGE != 0 && ADD_LATENCY + MUL_LATENCY < 8) begin : g_storage_latency
            STORAGE_needs_latencies_of_8_in_all u_error ();
        end
        if (KEEP != 0 && ADD_LATENCY + MUL_LATENCY < 4) begin : g_keep_latency
            KEEP_needs_latencies_of_4_in_all u_error ();
        end
        if (NEIGHBOURS != 0 && SCHEDULERS != 1) begin : g_neighbours_shape
            NEIGHBOURS_needs_one_SCHEDULER u_error ();
        end
        if (FUSED != 0 && SCHEDULERS != 1) begin : g_fused_shape
            MULTIPLY_ADD_FUSED_needs_one_SCHEDULER u_error ();
        end
        if (FUSED != 0 && INTERLEAVE == 0 && VALUES != 0 && MUL_LATENCY < 2) begin : g_fused_value
            MULTIPLY_ADD_FUSED_for_one_object_with_SELECT_RECIPROCAL_or_ROUND_needs_MUL_LATENCY_of_2 u_error ();
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
