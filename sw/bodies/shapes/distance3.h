/* SPDX-License-Identifier: Apache-2.0 */
/* distance3.h - the closest points of two cores (Gilbert, Johnson and Keerthi, "A fast procedure
 * for computing the distance between complex objects in three-dimensional space", IEEE Journal on
 * Robotics and Automation 4, 1988).
 *
 * Each round takes the corners of both that are farthest towards each other, and keeps the at most
 * four whose hull is closest. It ends when that is no longer closer, after 40 rounds at the latest.
 */
#ifndef FP3_BODIES_DISTANCE3_H
#define FP3_BODIES_DISTANCE3_H

#include "bodies/shapes/shape3.h"

typedef struct {
    fp3_point3 a, b;   /* the closest points, in a's frame; a point that both have, if they meet */
    fp3_point3 normal; /* from a to b, of length 1; 0 if the cores meet */
    float distance;    /* of these points, so never less than that of the cores */
    float least;       /* the cores are at least as far apart along `normal`; not below 0 */
    uint32_t rounds;
} fp3_closest3;

/* The distance is right within 1e-5 of itself and 1e-6 of what the cores measure, their distance
 * from a's origin included. Cores that are closer than that may be said to meet. */
void fp3_distance3(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b,
                   fp3_closest3 *closest);

/* Where two lines from + s along are closest, with s and t held between 0 and 1. */
void fp3_closest_of_edges3(fp3_point3 from_a, fp3_point3 along_a, fp3_point3 from_b,
                           fp3_point3 along_b, float *s, float *t);

#endif
