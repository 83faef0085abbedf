/* division.h - quotients and roots from the machine's estimates. */
#ifndef FP3_DIVISION_H
#define FP3_DIVISION_H

#include "term.h"

/* An estimate y and a small t, so that x/b or x/sqrt(b) is x y (1 + t). Two of the same b share both. */
typedef struct {
    uint32_t estimate, correction;
} fp3_series;

fp3_series fp3_reciprocal(dag *g, uint32_t b);
fp3_series fp3_inverse_root(dag *g, uint32_t b);

/* x y (1 + t) */
term fp3_corrected(dag *g, term x, fp3_series s);

/* sqrt(b) is b/sqrt(b), which is 0 for 0, as the estimate is finite there. */
term fp3_root(dag *g, uint32_t b);

#endif
