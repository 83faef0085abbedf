/* SPDX-License-Identifier: Apache-2.0 */
/* places.c - see places.h. */
#include "places.h"

#include <stdlib.h>

void fp3_positions_close(fp3_positions *p) {
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        free(p->word[k]);
}

fp3_status fp3_positions_pairs(const fp3_positions *p, const fp3_near_rule *rule, uint32_t objects,
                               uint32_t **begin, uint32_t **other, fp3_error *error) {
    fp3_near_rule of = fp3_near_without_list(rule);
    fp3_where_they_are now = {.stride = 1, .objects = objects, .dimensions = p->dimensions};
    for (uint32_t k = 0; k < p->dimensions; k++)
        now.position[k] = p->word[k];
    const fp3_status status = fp3_near_make(&of, &now, begin, other, error);
    fp3_near_close(&of);
    return status;
}

static int by_place(const void *a, const void *b) {
    const fp3_positioned *x = a, *y = b;
    return x->place != y->place ? (x->place > y->place) - (x->place < y->place)
                                : (x->object > y->object) - (x->object < y->object);
}

static uint32_t longest_side(const fp3_positions *p, const fp3_positioned *list, uint32_t count) {
    uint32_t axis = 0;
    double longest = -1;
    for (uint32_t k = 0; k < p->dimensions; k++) {
        double least = INFINITY, most = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            least = fmin(least, fp3_position(p, k, list[i].object));
            most = fmax(most, fp3_position(p, k, list[i].object));
        }
        if (most - least > longest) {
            longest = most - least;
            axis = k;
        }
    }
    return axis;
}

void fp3_positions_sort(const fp3_positions *p, fp3_positioned *list, uint32_t count) {
    const uint32_t axis = longest_side(p, list, count);
    for (uint32_t i = 0; i < count; i++)
        list[i].place = (float)fp3_position(p, axis, list[i].object);
    qsort(list, count, sizeof *list, by_place);
}
