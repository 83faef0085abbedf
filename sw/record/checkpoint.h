/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoint.h - the state of a run in a file, from which another process goes on with the same
 * bits (docs/checkpoints.md). */
#ifndef FP3_CHECKPOINT_H
#define FP3_CHECKPOINT_H

#include "state.h"

#include "base/file.h"

/* What a run knows of itself besides its state. */
typedef struct {
    uint64_t step;    /* that is made since the load */
    fp3_digest start; /* the hash before the first step, of what the program was loaded with */
    fp3_digest hash;  /* of the state at this checkpoint */
    fp3_digest before, chain; /* up to the checkpoint before, and up to this one */
    uint32_t flags;           /* that some instruction raised */
    fp3_failure *failures;    /* of each group */
    uint32_t *has_failed;     /* of each object: 0 or 1 */
} fp3_past;

/* Room for an engine's groups and objects, all 0. The caller frees *past, after a failure too.
 * FP3_E_SYSTEM: out of memory. */
fp3_status fp3_past_open(const fp3_engine *engine, fp3_past *past, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_past_free(fp3_past *past);

typedef struct {
    const char *path;
    const char *command; /* the arguments of the run, one a line */
    fp3_output *output;  /* of path, opened again and again; NULL: looks at the state, and writes
                            nothing: another process of a cluster does */
} fp3_checkpoint_def;

/* Gives past its hash, adds that to the chain, and writes the file: whole, or not at all. What it
 * held before stays as path.1. */
fp3_status fp3_checkpoint_write(const fp3_checkpoint_def *def, fp3_state *state, fp3_past *past,
                                fp3_error *error);

/* The attribute that checkpoints of bodies have alone (sw/bodies/fields.h). Such a one is opened,
 * too, for its step, its chain and its command, and is restored by nobody here. */
#define FP3_CHECKPOINT_BODIES "bodies"

typedef struct fp3_checkpoint fp3_checkpoint;
/* *is: the file begins as a checkpoint does, whole or not. FP3_E_ARGUMENT: it cannot be read. */
fp3_status fp3_checkpoint_is(const char *path, int *is, fp3_error *error);
/* The caller closes *checkpoint, which is NULL on failure. FP3_E_ARGUMENT: the file is no whole
 * checkpoint; error names path.1 if that is one. */
fp3_status fp3_checkpoint_open(const char *path, fp3_checkpoint **checkpoint, fp3_error *error);
/* Sets *checkpoint to NULL, which it may be already. */
void fp3_checkpoint_close(fp3_checkpoint **checkpoint);

uint64_t fp3_checkpoint_step(const fp3_checkpoint *checkpoint);
void fp3_checkpoint_chain(const fp3_checkpoint *checkpoint, fp3_digest *before, fp3_digest *chain);
/* See fp3_checkpoint_def. */
const char *fp3_checkpoint_command(const fp3_checkpoint *checkpoint);

/* Writes the state to an engine that has been loaded as that of the checkpoint was; past has the
 * hash of that load as its start. Gives past the rest. FP3_E_ARGUMENT: it has been loaded
 * otherwise; error says with what. */
fp3_status fp3_checkpoint_restore(fp3_checkpoint *checkpoint, fp3_state *state, fp3_past *past,
                                  fp3_error *error);

/* ---- for the files of this folder ---- */

/* SHA-256 of the lists of neighbours that the host has given, and of lifetimes. */
fp3_status fp3_checkpoint_links(const fp3_state *state, fp3_digest *links, fp3_error *error);
fp3_status fp3_checkpoint_lives(const fp3_state *state, fp3_digest *lives, fp3_error *error);

enum { FP3_CHECKPOINT_NAME = 32, FP3_FAILURE_WORDS = 9 };
/* "words:3" */
void fp3_checkpoint_name(char name[FP3_CHECKPOINT_NAME], const char *what, uint32_t group);
/* "pairs:3:17": of group 3 and the list of register 17 */
void fp3_checkpoint_list_name(char name[FP3_CHECKPOINT_NAME], uint32_t group, uint32_t reg);
void fp3_failure_pack(const fp3_failure *failure, uint32_t words[FP3_FAILURE_WORDS]);
fp3_failure fp3_failure_unpack(const uint32_t words[FP3_FAILURE_WORDS]);

#endif
