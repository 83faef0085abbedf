/* SPDX-License-Identifier: Apache-2.0 */
/* packing.h - near objects of one group: how many see each other, and some put side by side. */
#ifndef FP3_LAB_PACKING_H
#define FP3_LAB_PACKING_H

#include "crowd.h"

/* How many objects of its own group, in the mean, one that moves has within reach of its first
 * relation of near objects; infinite where there is no such relation. */
double fp3_packing_neighbours(const fp3_crowd *crowd);
/* Leaves a few equal objects of the group alive, at rest, side by side, just within reach of each
 * other. Returns 0 if it has no such relation, or no two equal objects. */
int fp3_packing_make(const fp3_crowd_group *g);

#endif
