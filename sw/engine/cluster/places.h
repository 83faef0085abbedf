/* SPDX-License-Identifier: Apache-2.0 */
/* places.h - where objects are, as those see it that are near each other, and an order along the
 * longest side of what they fill, in which they are divided. */
#ifndef FP3_CLUSTER_PLACES_H
#define FP3_CLUSTER_PLACES_H

#include "engine/common/near.h"

typedef struct {
    uint32_t *word[FP3_NEAR_DIMENSIONS]; /* of all objects */
    uint32_t dimensions;
    const fp3_near_rule *rule;
} fp3_positions;

void fp3_positions_close(fp3_positions *p);

/* Who is near whom among the first `objects`, by this rule: a list of each, itself not in it. The
 * caller frees *begin and *other. FP3_E_SYSTEM, FP3_E_LIMIT as of fp3_near_make. */
fp3_status fp3_positions_pairs(const fp3_positions *p, const fp3_near_rule *rule, uint32_t objects,
                               uint32_t **begin, uint32_t **other, fp3_error *error);

/* 0 where it is not finite, so that all ranks agree on whose such an object is. Nobody is near it:
 * the words say so. */
static inline double fp3_position(const fp3_positions *p, uint32_t k, uint32_t object) {
    const double x = fp3_near_number(p->rule, p->word[k][object]);
    return isfinite(x) ? x : 0;
}

typedef struct {
    float place; /* along the side by which they were sorted last */
    uint32_t object;
    uint64_t weight;
} fp3_positioned;

void fp3_positions_sort(const fp3_positions *p, fp3_positioned *list, uint32_t count);

#endif
