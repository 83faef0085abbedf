/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_steps.h - which groups can make their steps together. */
#ifndef FP3_KINDS_STEPS_H
#define FP3_KINDS_STEPS_H

#include <fp3/program.h>

/* A message about a group: with the place in its model, if a line is given. */
fp3_status fp3_kinds_refuse(const fp3_joined *group, uint32_t line, fp3_error *error,
                            const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Whether objects of this model never change: they are the same at every stage, by any method. */
int fp3_kinds_never_move(const fp3_model *model);

/* Whether a group can see another one, as its model says in this line. */
fp3_status fp3_kinds_check_steps(const fp3_joined *group, uint32_t line, const fp3_joined *other,
                                 fp3_error *error);
/* Of a scene in which groups with adaptive steps see each other, or others: whether all groups can
 * make these steps. */
fp3_status fp3_kinds_check_all(const fp3_joined *list, size_t count, fp3_error *error);

#endif
