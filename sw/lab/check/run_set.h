/* SPDX-License-Identifier: Apache-2.0 */
/* run_set.h - the groups of a run that see each other, directly or by others: what is computed of
 * one of them again needs all of them.
 */
#ifndef FP3_CHECK_RUN_SET_H
#define FP3_CHECK_RUN_SET_H

#include "run_loss.h"

#include <fp3/scene.h>

typedef struct {
    const fp3_scene *scene; /* NULL: a program, which is alone */
    size_t count;
    fp3_run_part *parts;            /* in the order of the scene */
    const fp3_scene_group **groups; /* of each part, or NULL */
} fp3_run_set;

/* Divides the parts of a run, of a scene one for each group. The caller frees *sets, which are NULL
 * on failure, with their number. */
fp3_status fp3_run_sets_make(const fp3_scene *scene, const fp3_run_part *parts, size_t count,
                             fp3_run_set **sets, size_t *set_count, fp3_error *error);
/* Sets *sets to NULL, which it may be already. */
void fp3_run_sets_free(fp3_run_set **sets, size_t set_count);

/* Which of these sets has a part. */
size_t fp3_run_set_of(const fp3_run_set *sets, size_t set_count, const fp3_run_part *part);

/* The name by which models call a part, or NULL. */
const char *fp3_run_set_name(const fp3_run_set *set, size_t part);

/* Whether the objects of a set are not the same at its start and at its end. */
int fp3_run_set_changes(const fp3_run_set *set);

#endif
