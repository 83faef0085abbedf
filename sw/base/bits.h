/* SPDX-License-Identifier: Apache-2.0 */
/* bits.h - a float and its 32 bits. */
#ifndef FP3_BASE_BITS_H
#define FP3_BASE_BITS_H

#include <stdint.h>
#include <string.h>

static inline uint32_t fp3_bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inline float fp3_value_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
