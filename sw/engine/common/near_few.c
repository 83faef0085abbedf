/* SPDX-License-Identifier: Apache-2.0 */
/* near_few.c - see near_few.h. */
#include "near_few.h"

#include "near_levels.h"

#include <stdlib.h>

int fp3_near_are_few(const fp3_where_they_are *now) {
    return !now->theirs[0] && now->own && now->own < now->objects &&
           (uint64_t)now->own * now->objects <= FP3_NEAR_FEW;
}

/* Who is near one row, in the order of lists, as `find` has it; there is room for all. */
static uint32_t seek(const fp3_where_they_are *now, uint32_t own, float far, uint32_t *found) {
    const uint32_t y = now->dimensions > 1, z = now->dimensions > 2 ? 2 : 0;
    const float *x[FP3_NEAR_DIMENSIONS], has_y = y > 0, has_z = z > 0;
    const uint32_t of[FP3_NEAR_DIMENSIONS] = {0, y, z};
    float at[FP3_NEAR_DIMENSIONS];
    uint32_t count = 0;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        x[k] = (const float *)(const void *)now->position[of[k]];
        at[k] = x[k][own * now->stride];
    }
    for (uint32_t i = 0; i < now->objects; i++) {
        const uint32_t object = now->order ? now->order[i] : i;
        const uint32_t j = now->row ? now->row[object] : object;
        const size_t place = j * now->stride;
        const float a = x[0][place] - at[0], b = x[1][place] - at[1], c = x[2][place] - at[2];
        found[count] = j;
        count += (uint32_t)(a * a + has_y * (b * b) + has_z * (c * c) < far && j != own &&
                            (!now->lives || now->lives[j]));
    }
    return count;
}

/* In double. */
static uint32_t seek_exact(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t own,
                           float far, uint32_t *found) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < now->objects; i++) {
        const uint32_t object = now->order ? now->order[i] : i;
        const uint32_t j = now->row ? now->row[object] : object;
        double sum = 0;
        for (uint32_t k = 0; k < now->dimensions; k++) {
            const double way = fp3_near_at(rule, now, k, j) - fp3_near_at(rule, now, k, own);
            sum += way * way;
        }
        found[count] = j;
        count += sum < (double)far && j != own;
    }
    return count;
}

/* How far those reach differs. */
static uint32_t seek_each(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t own,
                          const float *shares, uint32_t *found) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < now->objects; i++) {
        const uint32_t object = now->order ? now->order[i] : i;
        const uint32_t j = now->row ? now->row[object] : object;
        const float reach = shares[j] + shares[own];
        float sum = 0;
        double exact = 0;
        for (uint32_t k = 0; k < now->dimensions; k++) {
            const double to = fp3_near_at(rule, now, k, j), at = fp3_near_at(rule, now, k, own);
            const float way = (float)to - (float)at;
            sum += way * way;
            exact += (to - at) * (to - at);
        }
        found[count] = j;
        count +=
            (fp3_near_is_exact(rule) ? exact < (double)(reach * reach) : sum < reach * reach) &&
            j != own;
    }
    return count;
}

fp3_status fp3_near_make_few(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                             uint32_t **other, fp3_error *error) {
    fp3_near_find_margins(rule, now);
    const double reach = fp3_near_reach(rule);
    const float far = (float)(reach * reach);
    float *shares = fp3_near_has_radii(now) ? malloc((now->objects + 1u) * sizeof *shares) : NULL;
    uint32_t count = 0;
    *begin = malloc((now->objects + 2u) * sizeof **begin);
    *other = malloc(((size_t)now->own * now->objects + 1u) * sizeof **other);
    if (!*begin || !*other || (fp3_near_has_radii(now) && !shares)) {
        free(shares);
        return fp3_no_memory(error);
    }
    for (uint32_t i = 0; shares && i < now->objects; i++)
        shares[i] = fp3_near_share(rule, now, i);
    for (uint32_t own = 0; own < now->own; own++) {
        (*begin)[own] = count;
        if (now->lives && !now->lives[own])
            continue;
        count += shares                    ? seek_each(rule, now, own, shares, *other + count)
                 : fp3_near_is_exact(rule) ? seek_exact(rule, now, own, far, *other + count)
                                           : seek(now, own, far, *other + count);
    }
    free(shares);
    for (uint32_t i = now->own; i <= now->objects; i++)
        (*begin)[i] = count;
    rule->looks = (uint64_t)now->own * now->objects;
    return fp3_near_note(rule, now, error);
}
