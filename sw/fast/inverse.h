/* inverse.h - `rcp` and `rsqrt` of the key `mixed`, for native code. */
#ifndef FP3_FAST_INVERSE_H
#define FP3_FAST_INVERSE_H

#include "place.h"

fp3_fast_inverse fp3_inverse;

#endif
