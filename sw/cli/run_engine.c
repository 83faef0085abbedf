/* SPDX-License-Identifier: Apache-2.0 */
/* run_engine.c - see run_engine.h. */
#include "run_engine.h"

#include "engine/common/inside.h"

/* What is known before the program is: where no engine is named, it may be the usual one. */
void fp3_run_engine_check(const fp3_run_engine *on, struct argp_state *state) {
    const char *name = on->engine ? on->engine : fp3_engine_usual(0);
    const fp3_engine_traits *is = fp3_engine_traits_of(name, NULL);
    if (!is)
        return;
    if (on->kanata && !is->is_simulated)
        argp_error(state, "--kanata: only the hardware, engine rtl, has a pipeline to look into");
    if (on->clock > 0 && !is->is_hardware)
        argp_error(state, "--clock: only the hardware, engines rtl and board, has cycles");
    if (on->bus_log && !is->is_hardware)
        argp_error(state, "--bus-log: only the hardware, engines rtl and board, has a bus");
    if (on->bus_waits && !is->is_simulated)
        argp_error(state, "--bus-waits: only the hardware, engine rtl, has a bus that waits");
    if (is->has_port && !on->port)
        argp_error(state, "--engine board: expected --port DEV, its serial port");
    if ((on->port || on->baud) && !is->has_port)
        argp_error(state, "--port, --baud: only engine board has a port");
}

/* What is known when a scene has said which engine and configuration. */
static fp3_status check(const fp3_run_engine *on, const fp3_engine_def *def, fp3_error *error) {
    const fp3_config *config = fp3_config_find(def->config);
    const fp3_engine_traits *is = fp3_engine_traits_of(def->engine, error);
    if (!is)
        return FP3_E_ARGUMENT;
    if (on->threads && !is->has_threads)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--threads: only engine fast has threads, not engine '%s'", def->engine);
    if (on->visit && config && !config->interleave)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--visit: configuration '%s' does not interleave: its object makes all "
                        "steps in one visit",
                        config->name);
    return FP3_OK;
}

fp3_status fp3_run_engine_define(const fp3_run_engine *on, fp3_engine_def *def, fp3_error *error) {
    def->engine = on->engine ? on->engine : def->engine;
    def->seed = on->has_seed ? (uint32_t)on->seed : def->seed;
    def->visit = on->visit ? (uint32_t)on->visit : def->visit;
    def->cycle_limit = on->cycle_limit;
    def->threads = (uint32_t)on->threads;
    def->native = on->native;
    def->bus_log = on->bus_log;
    def->bus_waits = on->bus_waits;
    def->port = on->port;
    def->baud = (uint32_t)on->baud;
    def->error = error;
    return check(on, def, error);
}
