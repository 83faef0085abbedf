/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoints.c - see checkpoints.h. */
#include "checkpoints.h"

#include "format.h"

#include <inttypes.h>

#define NEVER UINT64_MAX

static fp3_status refuse_adaptive(const fp3_engine *engine, fp3_error *error) {
    const fp3_layout *layout = fp3_engine_layout(engine);
    for (uint32_t i = 0; i < layout->count; i++)
        if (fp3_adaptive_is(layout->groups[i].image))
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "checkpoints: objects choose their own steps, so no step is common "
                            "to all");
    return FP3_OK;
}

static fp3_status open_restart(fp3_checkpoints *c, const char *path, fp3_error *error) {
    const fp3_status status = fp3_checkpoint_open(path, &c->from, error);
    if (status || fp3_checkpoint_step(c->from) <= c->steps)
        return status;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s: after %" PRIu64 " steps, and the whole run has %" PRIu64, path,
                    fp3_checkpoint_step(c->from), c->steps);
}

fp3_status fp3_checkpoints_open(const fp3_recording_def *def, fp3_engine *engine,
                                fp3_checkpoints *c, fp3_error *error) {
    *c = (fp3_checkpoints){.def = {def->checkpoint, def->command, NULL},
                           .every = def->checkpoint_every,
                           .steps = def->steps,
                           .hashed = NEVER};
    c->is_recorded = def->path && fp3_format_of(def->path)->is_hdf5;
    fp3_status status = fp3_past_open(engine, &c->past, error);
    if (!status && (def->checkpoint || def->restart || def->expected))
        status = refuse_adaptive(engine, error);
    c->is_there = def->checkpoint || def->restart || def->expected || c->is_recorded;
    if (status || !c->is_there)
        return status;
    status = fp3_state_open(engine, &c->state, error);
    if (!status && def->checkpoint && !def->is_silent)
        status = fp3_output_open_again(def->checkpoint, &c->def.output, error);
    if (!status)
        status = fp3_state_hash(&c->state, 0, &c->past.start, error);
    return !status && def->restart ? open_restart(c, def->restart, error) : status;
}

void fp3_checkpoints_close(fp3_checkpoints *c) {
    fp3_checkpoint_close(&c->from);
    fp3_output_close(&c->def.output);
    fp3_state_free(&c->state);
    fp3_past_free(&c->past);
    *c = (fp3_checkpoints){0};
}

uint64_t fp3_checkpoints_begin(const fp3_checkpoints *c) {
    return c->from ? fp3_checkpoint_step(c->from) : 0;
}

fp3_status fp3_checkpoints_restore(fp3_checkpoints *c, fp3_error *error) {
    return c->from ? fp3_checkpoint_restore(c->from, &c->state, &c->past, error) : FP3_OK;
}

uint64_t fp3_checkpoints_next(const fp3_checkpoints *c, uint64_t step, uint64_t next) {
    if (!c->def.path || !c->every)
        return next;
    const uint64_t own = (step / c->every + 1) * c->every;
    return own < next ? own : next;
}

fp3_status fp3_checkpoints_take(fp3_checkpoints *c, uint64_t step, fp3_error *error) {
    if (!c->def.path || (step != c->steps && (!c->every || step % c->every)))
        return FP3_OK;
    c->past.step = step;
    const fp3_status status = fp3_checkpoint_write(&c->def, &c->state, &c->past, error);
    c->hash = c->past.hash;
    c->hashed = step;
    return status;
}

fp3_status fp3_checkpoints_hash(fp3_checkpoints *c, uint64_t step, fp3_error *error) {
    if (c->hashed == step)
        return FP3_OK;
    c->hashed = step;
    return fp3_state_hash(&c->state, step, &c->hash, error);
}
