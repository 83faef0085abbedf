/* circular.h - sine, cosine, tangent. */
#ifndef FP3_CIRCULAR_H
#define FP3_CIRCULAR_H

#include "term.h"

/* Of x in radians, |x| < 2^16; sine and cosine with the pass `small-angles`, |x| <= pi/2. Beyond that the
 * value is a NaN and raises invalid. */
term fp3_sine(dag *g, term x);
term fp3_cosine(dag *g, term x);
term fp3_tangent(dag *g, term x);

#endif
