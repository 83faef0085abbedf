/* format.c - see format.h. */
#include "format.h"

#include "lns.h"

#include <fp3/image.h>
#include <fp3/isa.h>
#include <string.h>

typedef struct {
    fp3_key key; /* configurations in which it is not 0 have this format */
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

static const format formats[] = {{FP3_KEY_LOGARITHMIC, log_word, log_bits, log_counts}};

/* NULL: binary32. */
static const format *format_of(const fp3_config *config) {
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (fp3_config_value(config, formats[i].key))
            return &formats[i];
    return NULL;
}

int fp3_format_is_float(const fp3_config *config) { return !format_of(config); }

const char *fp3_format_word(const fp3_config *config, float value, uint32_t *word) {
    const format *of = format_of(config);
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (of)
        return of->word(config, bits, word);
    *word = bits;
    return NULL;
}

float fp3_format_value(const fp3_config *config, uint32_t word) {
    const format *of = format_of(config);
    const uint32_t bits = of ? of->bits(config, word) : word;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

int64_t fp3_format_counts(const fp3_config *config) {
    const format *of = format_of(config);
    return of ? of->counts(config) : FP3_STEPS_LIMIT;
}
