/* SPDX-License-Identifier: Apache-2.0 */
/* fill.h - objects at random in a box, none too near another; the same on every machine. */
#ifndef FP3_ARRANGE_FILL_H
#define FP3_ARRANGE_FILL_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

#define FP3_FILL_AXES 3

typedef struct {
    unsigned axes; /* 1 to 3 */
    double from[FP3_FILL_AXES], to[FP3_FILL_AXES];
    double apart; /* the least distance of two objects; 0: any */
    uint64_t seed;
    size_t objects;
} fp3_fill;

#define FP3_FILL_TRIES 5000 /* of one object, before the box counts as full */

/* position[k][i] of each object: FP32 numbers. *placed: how many found a place; fewer than all: the
 * rest is not set. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_fill_box(const fp3_fill *fill, double *const position[FP3_FILL_AXES], size_t *placed,
                        fp3_error *error);

#endif
