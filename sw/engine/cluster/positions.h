/* SPDX-License-Identifier: Apache-2.0 */
/* positions.h - where the objects of all ranks are, where they see those that are near. */
#ifndef FP3_CLUSTER_POSITIONS_H
#define FP3_CLUSTER_POSITIONS_H

#include "inside.h"

#include <math.h>
#include <string.h>

typedef struct {
    uint32_t *word[FP3_NEAR_DIMENSIONS]; /* of all objects */
    uint32_t dimensions;
    const fp3_near_rule *rule;
} fp3_positions;

/* The rule of the first relation `near`; all have its position. And the least skin of all. */
const fp3_near_rule *fp3_positions_rule(const fp3_members *group);
double fp3_positions_skin(const fp3_members *group);
/* Who is near whom among the first `objects`, by this rule: a list of each, itself not in it. The
 * caller frees *begin and *other. */
fp3_status fp3_positions_pairs(fp3_engine *engine, const fp3_near_rule *rule,
                               const fp3_positions *p, uint32_t objects, uint32_t **begin,
                               uint32_t **other);
/* All ranks together. fp3_positions_close whatever comes of it. */
fp3_status fp3_positions_read(fp3_engine *engine, const fp3_near_rule *rule, fp3_positions *p);
void fp3_positions_close(fp3_positions *p);

/* 0 where it is not finite, so that all ranks agree on whose such an object is. Nobody is near it:
 * the words say so. */
static inline double fp3_position(const fp3_positions *p, uint32_t k, uint32_t object) {
    const double x = fp3_near_number(p->rule, p->word[k][object]);
    return isfinite(x) ? x : 0;
}

#endif
