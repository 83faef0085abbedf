/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoints.h - the checkpoints of a run, and hashes of its state. */
#ifndef FP3_OUTPUT_CHECKPOINTS_H
#define FP3_OUTPUT_CHECKPOINTS_H

#include "checkpoint.h"

#include <fp3/recording.h>

typedef struct {
    int is_there;    /* hashes are needed: the state is open */
    int is_recorded; /* a recording has them */
    fp3_state state;
    fp3_past past;          /* is there always */
    fp3_checkpoint_def def; /* path NULL: none is written */
    uint64_t every, steps;
    fp3_checkpoint *from; /* where the run begins; NULL: at its start */
    fp3_digest hash;      /* of the state after `hashed` steps */
    uint64_t hashed;
} fp3_checkpoints;

/* The program is loaded. The caller closes *c, after a failure too. FP3_E_ARGUMENT: adaptive steps;
 * checkpoints that another process writes; a restart from what is no checkpoint, or behind the end
 * of the run. */
fp3_status fp3_checkpoints_open(const fp3_recording_def *def, fp3_engine *engine,
                                fp3_checkpoints *c, fp3_error *error);
/* Leaves {0}, which may be closed as well. */
void fp3_checkpoints_close(fp3_checkpoints *c);

/* How many steps are made where the run begins. */
uint64_t fp3_checkpoints_begin(const fp3_checkpoints *c);
/* Gives the engine what it held then; from then on `past` knows of what was before. */
fp3_status fp3_checkpoints_restore(fp3_checkpoints *c, fp3_error *error);

/* The step at which a part of the run ends that would end at `next`. */
uint64_t fp3_checkpoints_next(const fp3_checkpoints *c, uint64_t step, uint64_t next);
/* Writes one if it is time. */
fp3_status fp3_checkpoints_take(fp3_checkpoints *c, uint64_t step, fp3_error *error);
/* The hash of the state as it is, in c->hash. */
fp3_status fp3_checkpoints_hash(fp3_checkpoints *c, uint64_t step, fp3_error *error);

#endif
