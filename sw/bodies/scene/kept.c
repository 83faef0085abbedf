/* SPDX-License-Identifier: Apache-2.0 */
/* kept.c - see kept.h. */
#include "kept.h"

#include "record/library_hdf5.h"

#include <inttypes.h>

/* The world of a file instead of the one that the scene has made. */
static fp3_status go_on(fp3_bodies_scene *scene, fp3_bodies_kept *k, fp3_error *error) {
    fp3_bodies *made = NULL;
    fp3_status status =
        fp3_bodies_go_on(&scene->def, k->def->restart, scene->bodies, &k->past, &made);
    if (status)
        return fp3_fail(error, status, "%s", scene->why.text);
    fp3_bodies_close(&scene->bodies);
    scene->bodies = made;
    k->begin = fp3_bodies_steps(made);
    k->chain = k->past.chain;
    if (k->begin > k->def->steps)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: after %" PRIu64 " steps, and the whole run has %" PRIu64,
                        k->def->restart, k->begin, k->def->steps);
    return FP3_OK;
}

fp3_status fp3_bodies_kept_open(fp3_bodies_scene *scene, const fp3_recording_def *def,
                                fp3_bodies_kept *k, fp3_error *error) {
    const int is_past = def->checkpoint || def->restart;
    *k = (fp3_bodies_kept){.def = def, .past.command = def->command};
    fp3_status status = is_past || def->expected ? fp3_library_hdf5(&k->calls, error) : FP3_OK;
    if (!status && is_past)
        status = fp3_bodies_past_begin(scene->bodies, &k->past, error);
    if (!status && def->checkpoint && !def->is_silent)
        status = fp3_output_open_again(def->checkpoint, &k->output, error);
    return !status && def->restart ? go_on(scene, k, error) : status;
}

void fp3_bodies_kept_close(fp3_bodies_kept *k) { fp3_output_close(&k->output); }

uint64_t fp3_bodies_kept_next(const fp3_bodies_kept *k, uint64_t step, uint64_t next) {
    const uint64_t every = k->def->checkpoint ? k->def->checkpoint_every : 0;
    const uint64_t own = every ? (step / every + 1) * every : next;
    return own < next ? own : next;
}

fp3_status fp3_bodies_kept_take(fp3_bodies_kept *k, const fp3_bodies_scene *scene, uint64_t step,
                                fp3_error *error) {
    const uint64_t every = k->def->checkpoint_every;
    if (!k->output || (step != k->def->steps && (!every || step % every)))
        return FP3_OK;
    const fp3_status status =
        fp3_bodies_keep(scene->bodies, k->def->checkpoint, k->output, &k->past);
    return status ? fp3_fail(error, status, "%s", scene->why.text) : FP3_OK;
}

fp3_status fp3_bodies_kept_hash(fp3_bodies_kept *k, const fp3_bodies_scene *scene, uint64_t step,
                                fp3_error *error) {
    fp3_digest hash;
    fp3_status status = k->calls ? FP3_OK : fp3_library_hdf5(&k->calls, error);
    if (!status)
        status = fp3_bodies_sum(scene->bodies, &hash, error);
    if (!status && k->def->expected)
        status = fp3_expected_compare(k->def->expected, k->calls, step, &hash, error);
    return status ? status : fp3_chain_add(k->calls, &k->chain, &hash, error);
}
