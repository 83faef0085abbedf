/* SPDX-License-Identifier: Apache-2.0 */
/* past.h - checkpoints of a run of a scene: a world's file that also knows what the scene made, the
 * arguments, and the chain of hashes (docs/checkpoints.md).
 *
 *     fp3_bodies_past past = {.command = "--scene\nx.scene"};
 *     if (fp3_bodies_past_begin(bodies, &past, &error) || ... steps ... ||
 *         fp3_bodies_keep(bodies, "x.ck", output, &past))
 *         ...
 */
#ifndef FP3_BODIES_PAST_H
#define FP3_BODIES_PAST_H

#include "base/file.h"
#include "record/state.h"

#include <fp3/bodies.h>

/* Of what a scene makes there are three hashes, so that a message can say what is different. Bodies
 * follow from their shapes, which are compared first. */
enum { FP3_START_SHAPES, FP3_START_BODIES, FP3_START_JOINTS, FP3_STARTS };
extern const char *const fp3_start_names[FP3_STARTS]; /* as attributes */

typedef struct {
    const char *command; /* the arguments of the run, one a line; or NULL */
    fp3_digest start[FP3_STARTS];
    fp3_digest before, chain; /* up to the checkpoint before, and up to this one */
} fp3_bodies_past;

/* Of a world that has made no step: what the scene made. */
fp3_status fp3_bodies_past_begin(fp3_bodies *bodies, fp3_bodies_past *past, fp3_error *error);
/* SHA-256 of the number of steps, 64 bits, and of the words of fp3_bodies_hash. */
fp3_status fp3_bodies_sum(const fp3_bodies *bodies, fp3_digest *sum, fp3_error *error);

/* Writes a checkpoint. past: adds to its chain; NULL: a world alone, of no run. output is of path,
 * for files that are written again and again. */
fp3_status fp3_bodies_keep(fp3_bodies *bodies, const char *path, fp3_output *output,
                           fp3_bodies_past *past);
/* As fp3_bodies_restart; past: of a world that the scene makes, without steps, and which is `of`.
 * Its chain becomes that of the file. FP3_E_ARGUMENT: it is of no run, or of another scene. */
fp3_status fp3_bodies_go_on(const fp3_bodies_def *def, const char *path, const fp3_bodies *of,
                            fp3_bodies_past *past, fp3_bodies **bodies);
uint64_t fp3_bodies_steps(const fp3_bodies *bodies);

#endif
