/* SPDX-License-Identifier: Apache-2.0 */
/* spots.h - where the objects of a batch are, and which of them are near each other. */
#ifndef FP3_BATCH_SPOTS_H
#define FP3_BATCH_SPOTS_H

#include "batch_own.h"

typedef struct {
    uint32_t dimensions, objects;
    float *x[3];          /* columns of all numbers; NaN: nobody is there */
    const char *names[3]; /* of the states */
    double reach;         /* of the relation, to which radii are added; 0: there is none */
    const char *radius;   /* the param; NULL: nothing is added */
    float *radii;         /* where they are asked for */
} fp3_spots;

/* of: as in fp3/batch.h. The caller closes, after a failure too. */
fp3_status fp3_spots_open(fp3_batch *batch, const char *of, fp3_spots *spots);
void fp3_spots_close(fp3_spots *spots);

/* The square of the distance from a point; NaN: nobody is there. */
static inline double fp3_spots_square(const fp3_spots *p, const double *point, size_t object) {
    double sum = 0;
    for (uint32_t k = 0; k < p->dimensions; k++) {
        const double way = (double)p->x[k][object] - point[k];
        sum += way * way;
    }
    return sum;
}

/* Pairs within a distance, or 0: the reach, by numbers: *first and *second, which the caller frees,
 * also after a failure. */
fp3_status fp3_spots_pairs(fp3_batch *batch, const char *of, double distance, uint32_t **first,
                           uint32_t **second, size_t *count);

#endif
