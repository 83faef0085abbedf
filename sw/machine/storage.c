/* SPDX-License-Identifier: Apache-2.0 */
/* storage.c - see storage.h; rtl/lane/fp3_narrow.v and sw/engine/fast/halves.h do the same. */
#include "storage.h"
#include "base/bits.h"

#include <fp3/isa.h>

#define SIZE 0x7fffffffu
#define INFINITE 0x7f800000u
#define SIGNIFICAND 0x7fffffu
#define HALF_LEAST 0x38800000u /* 2^-14 */
#define HALF_ABOVE 0x47800000u /* 2^16 */
#define NEAREST UINT32_MAX     /* instead of a random number */

static const struct {
    const char *name;
    float most;
    uint32_t counts;
} formats[] = {
    {"binary32", 0x1.fffffep127f, UINT32_C(1) << 24},
    {"bfloat16", 0x1.fep127f, UINT32_C(1) << 8},
    {"binary16", 65504, UINT32_C(1) << 11},
};

const char *fp3_storage_name(const fp3_config *config) { return formats[config->storage].name; }

float fp3_storage_most(const fp3_config *config) { return formats[config->storage].most; }

uint32_t fp3_storage_counts(const fp3_config *config) { return formats[config->storage].counts; }

/* ---- draws ---- */

/* rtl/lane/fp3_mix.v */
static uint32_t mix(uint32_t x) {
    x = ~x + (x << 15);
    x ^= x >> 12;
    x += x << 2;
    x ^= x >> 4;
    x *= 2057;
    return x ^ x >> 16;
}

uint32_t fp3_storage_seed(uint32_t seed) {
    const uint32_t mixed = mix(seed);
    return !seed ? 0 : mixed ? mixed : 1;
}

static uint32_t random_of(const fp3_draw *draw) {
    if (!draw || !draw->seed)
        return NEAREST;
    return mix(mix(draw->seed ^ draw->step ^ draw->reg << 26) + draw->object) & 0xffff;
}

/* ---- rounding ---- */

/* What is added in front of the cut, of a number that has so many bits behind it, 16 at most. */
static uint32_t added(uint32_t number, int bits, int has_more, uint32_t random) {
    if (random != NEAREST)
        return random >> (16 - bits);
    return (1u << (bits - 1)) - 1 + (number >> bits & 1 || has_more);
}

static uint32_t cut(uint32_t number, int bits, int has_more, uint32_t random) {
    return (number + added(number, bits, has_more, random)) >> bits;
}

/* A magnitude below 2^-14: multiples of 2^-24. */
static uint32_t small_half(uint32_t size, uint32_t random) {
    const uint32_t distance = (HALF_LEAST >> 23) - (size >> 23),
                   shift = distance < 31 ? distance : 31;
    const uint32_t all = ((size & SIGNIFICAND) + SIGNIFICAND + 1) << 3;
    const uint32_t least = cut(all >> shift, 16, (all & ((1u << shift) - 1)) != 0, random);
    return fp3_bits_of((float)least * 0x1p-24f);
}

static uint32_t rounded(uint32_t storage, uint32_t size, uint32_t random) {
    if (storage == 1)
        return cut(size, 16, 0, random) << 16;
    if (size < HALF_LEAST)
        return small_half(size, random);
    const uint32_t half = size < HALF_ABOVE ? cut(size, 13, 0, random) << 13 : INFINITE;
    return half < HALF_ABOVE ? half : INFINITE;
}

uint32_t fp3_stored(const fp3_config *config, uint32_t word, const fp3_draw *draw,
                    uint32_t *flags) {
    const uint32_t size = word & SIZE;
    *flags = 0;
    if (!config->storage)
        return word;
    if (size >= INFINITE)
        return size > INFINITE ? FP3_BITS_NAN : word;
    const uint32_t stored = rounded(config->storage, size, random_of(draw));
    if (stored >= INFINITE && config->flags)
        *flags = FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
    return (word & ~SIZE) | stored;
}
