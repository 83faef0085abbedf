/* SPDX-License-Identifier: Apache-2.0 */
/* arc.h - what arcs of floats share with those of pairs. */
#ifndef FP3_ARC_H
#define FP3_ARC_H

#include "compiler/value/dag.h"

/* atan(q) for |q| <= 1. */
uint32_t fp3_small_arc(dag *g, uint32_t q);

#endif
