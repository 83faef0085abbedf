/* SPDX-License-Identifier: Apache-2.0 */
/* run_engine.h - the engine that fp3 run is asked for: what its options say, and which go together.
 */
#ifndef FP3_CLI_RUN_ENGINE_H
#define FP3_CLI_RUN_ENGINE_H

#include <argp.h>
#include <fp3/engine.h>

typedef struct {
    const char *engine, *bus_log, *kanata, *port, *native;
    uint64_t cycle_limit, visit, seed, threads, bus_waits, baud;
    double clock; /* Hz; 0: not given */
    int has_seed;
} fp3_run_engine;

/* Ends the command with an error where they do not. */
void fp3_run_engine_check(const fp3_run_engine *on, struct argp_state *state);
/* def has the engine and configuration where the options say nothing. FP3_E_ARGUMENT: an option
 * that means nothing there. */
fp3_status fp3_run_engine_define(const fp3_run_engine *on, fp3_engine_def *def, fp3_error *error);

#endif
