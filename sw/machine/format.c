/* SPDX-License-Identifier: Apache-2.0 */
/* format.c - see format.h. */
#include "format.h"
#include "base/bits.h"

#include "lns.h"
#include "narrow.h"
#include "storage.h"

#include <fp3/image.h>
#include <fp3/isa.h>
#include <math.h>

#define INFINITE 0x7f800000u

typedef struct {
    int (*has)(const fp3_config *config); /* whether a configuration has this format */
    const char *(*word)(const fp3_config *config, uint32_t bits, uint32_t *word);
    uint32_t (*bits)(const fp3_config *config, uint32_t word);
    int64_t (*counts)(const fp3_config *config);
} format;

static const char *log_word(const fp3_config *config, uint32_t bits, uint32_t *word) {
    (void)config;
    uint32_t flags;
    const uint32_t d = fp3_lns_from_float(bits, &flags);
    if (flags & FP3_FLAG_UNDERFLOW)
        return "is nearer to 0 than 2^-127";
    *word = d;
    return NULL;
}

static uint32_t log_bits(const fp3_config *config, uint32_t word) {
    (void)config;
    uint32_t flags;
    return fp3_lns_to_float(word, &flags);
}

/* Each sum is rounded: the 8,192nd is off by 0.04. */
static int64_t log_counts(const fp3_config *config) {
    (void)config;
    return 8192;
}

static int is_log(const fp3_config *config) { return config->logarithmic != 0; }

/* To the nearest number with fewer fraction bits, ties to even; a NaN is the quiet one. */
static const char *narrow_word(const fp3_config *config, uint32_t bits, uint32_t *word) {
    const uint32_t sign = bits & FP3_BITS_MINUS_ZERO, size = bits & ~FP3_BITS_MINUS_ZERO;
    const uint32_t below = 23 - config->fraction;
    const uint32_t odd = size >> below & 1, half = UINT32_C(1) << (below - 1);
    const uint32_t rounded = fp3_narrow_read(config, size + half - 1 + odd);
    if (size >= INFINITE) {
        *word = size > INFINITE ? FP3_BITS_NAN : bits;
        return NULL;
    }
    if (rounded == INFINITE)
        return "is rounded to infinity: numbers with fewer fraction bits do not reach it";
    if (size && !rounded)
        return "is rounded to 0: numbers with fewer fraction bits do not reach it";
    *word = sign | rounded;
    return NULL;
}

static uint32_t narrow_bits(const fp3_config *config, uint32_t word) {
    return fp3_narrow_read(config, word);
}

/* From there on 1 is at most half of the last place. */
static int64_t narrow_counts(const fp3_config *config) { return INT64_C(2) << config->fraction; }

static int is_narrow(const fp3_config *config) { return config->fraction < 23; }

static const format formats[] = {{is_log, log_word, log_bits, log_counts},
                                 {is_narrow, narrow_word, narrow_bits, narrow_counts}};

/* NULL: binary32. */
static const format *format_of(const fp3_config *config) {
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].has(config))
            return &formats[i];
    return NULL;
}

int fp3_format_is_float(const fp3_config *config) { return !format_of(config); }

const char *fp3_format_word(const fp3_config *config, float value, uint32_t *word) {
    const format *of = format_of(config);
    const uint32_t bits = fp3_bits_of(value);
    if (of)
        return of->word(config, bits, word);
    *word = bits;
    return NULL;
}

const char *fp3_format_written(const fp3_config *config, float value, uint32_t *word) {
    const char *wrong = fp3_format_word(config, value, word);
    return wrong && fabsf(value) < 1 ? fp3_format_word(config, copysignf(0, value), word) : wrong;
}

float fp3_format_value(const fp3_config *config, uint32_t word) {
    const format *of = format_of(config);
    return fp3_value_of(of ? of->bits(config, word) : word);
}

double fp3_format_number(const fp3_config *config, uint32_t word) {
    const uint32_t size = word & ~FP3_BITS_MINUS_ZERO;
    if (!is_log(config) || !size || size >= INFINITE)
        return fp3_format_value(config, word);
    const double number = exp2(size * 0x1p-23 - 127);
    return word == size ? number : -number;
}

int64_t fp3_format_counts(const fp3_config *config) {
    const format *of = format_of(config);
    const int64_t words = of ? of->counts(config) : FP3_STEPS_LIMIT;
    const int64_t records = fp3_storage_counts(config);
    return records < words ? records : words;
}
