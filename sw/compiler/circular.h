/* circular.h - sine and cosine. */
#ifndef FP3_CIRCULAR_H
#define FP3_CIRCULAR_H

#include "term.h"

/* Of x in radians, |x| <= pi. */
term fp3_sine(dag *g, term x);
term fp3_cosine(dag *g, term x);

#endif
