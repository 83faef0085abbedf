/* SPDX-License-Identifier: Apache-2.0 */
/* mass3.h - mass, centre and inertia of shapes, in double, with a stated order of operations.
 */
#ifndef FP3_BODIES_MASS3_H
#define FP3_BODIES_MASS3_H

#include "bodies/shapes/shape3.h"

#include <stddef.h>

typedef struct {
    double mass, centre[3];
    double inertia[6]; /* about the centre: xx, yy, zz, xy, xz, yz of the tensor, so xy is minus the
                          integral of x y */
} fp3_mass3;

/* Of the rounded shape; what has no volume weighs nothing. Exact to rounding for balls, capsules
 * and polyhedra without a radius; what a radius adds to a polyhedron or a triangle is within 1e-5
 * of itself. */
fp3_mass3 fp3_weigh3(const fp3_shape3 *shape, double density);
/* Of several together, in their order. Without mass the centre is the origin. */
fp3_mass3 fp3_weigh_together3(const fp3_mass3 *parts, size_t count);

/* The principal moments, and the turn from their axes to the frame's, as a quaternion with w >= 0.
 * By Jacobi's turns of xy, xz and yz in this order; the axes stay near those of the frame. */
void fp3_axes_of_mass3(const fp3_mass3 *mass, double moment[3], double q[4]);

#endif
