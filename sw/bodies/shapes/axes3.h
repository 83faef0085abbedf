/* SPDX-License-Identifier: Apache-2.0 */
/* axes3.h - the direction along which two cores overlap least, or are farthest apart.
 *
 * Tried are the normals of both shapes' faces, and the directions square to one edge of each; of
 * the latter only those that are normals of faces of the Minkowski difference: a direction s (ea x
 * eb), s = +-1, is one exactly if s eb.a1 > 0 > s eb.a2 and s ea.b1 > 0 > s ea.b2, where a1 and b1
 * are the normals of the faces to the left of the edges, a2 and b2 to their right. For two boxes
 * all 15 directions are computed from half sides instead.
 *
 * A face of a is taken unless one of b is better by `slack`, and a face unless edges are: so the
 * choice does not change with the last bits of a pose.
 */
#ifndef FP3_BODIES_AXES3_H
#define FP3_BODIES_AXES3_H

#include "bodies/shapes/shape3.h"

typedef enum { FP3_APART3, FP3_FACE_OF_A3, FP3_FACE_OF_B3, FP3_EDGES3 } fp3_axis_kind3;

typedef struct {
    fp3_axis_kind3 kind; /* FP3_APART3: the cores are farther apart than the limit */
    uint32_t face;       /* of a or of b */
    float gap;           /* of the cores along the normal */
    fp3_point3 normal;   /* from a to b, in a's frame as all here */
    /* Edges: each from a point along a vector. */
    fp3_point3 from_a, along_a, from_b, along_b;
} fp3_axis3;

/* `of_b`: b's frame in a's. One shape has three corners or more. */
void fp3_axes3(const fp3_shape3 *a, const fp3_shape3 *b, const fp3_turn3 *of_b, float limit,
               fp3_axis3 *axis);

/* By how much a direction must be better than one that is preferred. */
static inline float fp3_axes3_slack(const fp3_shape3 *a, const fp3_shape3 *b) {
    const float both = a->faces == 0         ? b->inner
                       : b->faces == 0       ? a->inner
                       : a->inner < b->inner ? a->inner
                                             : b->inner;
    return 0.0078125f * both + 5e-7f * (a->extent + b->extent);
}

#endif
