/* raised.h - the processor's sticky flags as those of the machine. */
#ifndef FP3_FAST_RAISED_H
#define FP3_FAST_RAISED_H

#include "place.h"

#include <fp3/isa.h>
#include <stdint.h>
#include <xmmintrin.h>

/* seen: FP3_SEEN_*. */
static inline uint32_t fp3_fast_raised(unsigned seen) {
    static const uint32_t of[] = {FP3_FLAG_INVALID,        0,
                                  FP3_FLAG_DIVIDE_BY_ZERO, FP3_FLAG_OVERFLOW,
                                  FP3_FLAG_UNDERFLOW,      FP3_FLAG_INEXACT};
    const uint32_t sticky = _mm_getcsr();
    uint32_t flags = seen & FP3_SEEN_UNDERFLOW ? FP3_FLAG_UNDERFLOW : 0;
    for (unsigned i = 0; i < sizeof of / sizeof *of; i++)
        flags |= sticky >> i & 1 ? of[i] : 0;
    return flags;
}

#endif
