/* arc.h - arcs: atan, atan2, asin, acos. docs/compiler.md says what they are of special values. */
#ifndef FP3_ARC_H
#define FP3_ARC_H

#include "compiler/value/dag.h"

uint32_t fp3_atan(dag *g, uint32_t x);
uint32_t fp3_atan2(dag *g, uint32_t y, uint32_t x);
/* Of |x| > 1 a NaN, which raises invalid. */
uint32_t fp3_asin(dag *g, uint32_t x);
uint32_t fp3_acos(dag *g, uint32_t x);

/* atan(q) for |q| <= 1. */
uint32_t fp3_small_arc(dag *g, uint32_t q);

#endif
