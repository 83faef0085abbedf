/* SPDX-License-Identifier: Apache-2.0 */
/* near_stale.c - whether objects have moved so far that a list of those near has to be made again.
 */
#include "near.h"

#include <stdatomic.h>

/* Below this a square of FP32 may lose too much to underflow, the more so if the caller has the
 * processor flush what is subnormal. */
#define LEAST_LOOK 0x1p-100

/* Rows that are checked together. If an object of them has moved far, or is not finite, each row is
 * checked alone. */
#define BLOCK 1024u

/* Whether these rows have moved by less than this, as far as FP32 can tell: a look that costs
 * little. */
static int are_near_home(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t first,
                         uint32_t end, float most) {
    const float *made[FP3_NEAR_DIMENSIONS], *x[FP3_NEAR_DIMENSIONS];
    const float has_y = now->dimensions > 1, has_z = now->dimensions > 2;
    int is_beyond = 0;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        made[k] = (const float *)(const void *)rule->made[k < now->dimensions ? k : 0];
        x[k] = (const float *)(const void *)fp3_near_words(now, k < now->dimensions ? k : 0, first);
    }
    for (size_t i = first, at = first * now->stride; i < end; i++, at += now->stride) {
        const float a = x[0][at] - made[0][i], b = x[1][at] - made[1][i], c = x[2][at] - made[2][i];
        is_beyond |= !(a * a + has_y * (b * b) + has_z * (c * c) <= most);
    }
    return !is_beyond;
}

/* How far the object of a row was away when the list was made, squared. Who has no place, and had
 * none, has not moved. */
static double way_of(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t i) {
    double way = 0;
    int is_astray = 0, was_astray = 0;
    for (uint32_t k = 0; k < now->dimensions; k++) {
        const double x = fp3_near_at(rule, now, k, i), made = fp3_near_was(rule, k, i);
        is_astray |= !isfinite(x);
        was_astray |= !isfinite(made);
        way += (x - made) * (x - made);
    }
    return is_astray && was_astray ? 0 : way;
}

/* From this number of objects on threads are asked for help. */
#define LOOK_TOGETHER 65536u

typedef struct {
    const fp3_near_rule *rule;
    const fp3_where_they_are *now;
    uint32_t parts;
    atomic_int is_stale;
} look;

static int has_moved(const look *l, uint32_t first, uint32_t last) {
    const double most = l->rule->skin * l->rule->skin / 4;
    const float near_home = (float)(most * (1 - FP3_NEAR_ROUNDING));
    for (uint32_t i = first, end; i < last; i = end) {
        end = last - i < BLOCK ? last : i + BLOCK;
        if (!fp3_near_is_exact(l->rule) && most >= LEAST_LOOK &&
            are_near_home(l->rule, l->now, i, end, near_home))
            continue;
        for (uint32_t k = i; k < end; k++)
            if (!(way_of(l->rule, l->now, k) <= most))
                return 1;
    }
    return 0;
}

/* Whether some of these rows add something else to the reach. */
static int has_grown(const look *l, fp3_row_range range) {
    for (uint32_t i = range.first; l->rule->radii && i < range.end; i++)
        if (fp3_near_radius_word(l->now, i) != l->rule->radii[i])
            return 1;
    return 0;
}

static void look_at(void *of, uint32_t part) {
    look *l = of;
    const fp3_row_range own = fp3_near_part(fp3_near_seekers(l->now), part, l->parts),
                        theirs = fp3_near_part(fp3_near_sought(l->now), part, l->parts);
    if (!atomic_load(&l->is_stale) &&
        (has_moved(l, own.first, own.end) || has_grown(l, own) || has_grown(l, theirs) ||
         (l->now->theirs[0] && has_moved(l, theirs.first, theirs.end))))
        atomic_store(&l->is_stale, 1);
}

int fp3_near_is_stale(const fp3_near_rule *rule, const fp3_where_they_are *now) {
    look l = {.rule = rule, .now = now, .parts = fp3_near_parts(now, LOOK_TOGETHER)};
    if (!rule->made[0])
        return 1;
    fp3_parts_make(now->crew, look_at, &l, l.parts);
    return atomic_load(&l.is_stale);
}
