/* SPDX-License-Identifier: Apache-2.0 */
/* raised.h - the processor's sticky flags as those of the machine. */
#ifndef FP3_FAST_RAISED_H
#define FP3_FAST_RAISED_H

#include "place.h"

#include "base/fpu.h"

#include <fp3/isa.h>
#include <stdint.h>

/* seen: FP3_SEEN_*. */
static inline uint32_t fp3_fast_raised(unsigned seen) {
    const uint64_t sticky = fp3_fpu_get();
    return (sticky & FP3_FPU_INVALID ? FP3_FLAG_INVALID : 0) |
           (sticky & FP3_FPU_DIVIDE_BY_ZERO ? FP3_FLAG_DIVIDE_BY_ZERO : 0) |
           (sticky & FP3_FPU_OVERFLOW ? FP3_FLAG_OVERFLOW : 0) |
           (sticky & FP3_FPU_UNDERFLOW || seen & FP3_SEEN_UNDERFLOW ? FP3_FLAG_UNDERFLOW : 0) |
           (sticky & FP3_FPU_INEXACT ? FP3_FLAG_INEXACT : 0);
}

#endif
