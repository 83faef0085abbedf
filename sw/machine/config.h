/* config.h - the named configurations of isa/configs.toml as a table. */
#ifndef FP3_CONFIG_H
#define FP3_CONFIG_H

#include <stdint.h>

/* In the order of FP3_CONFIGS; docs/configurations.md says what each means. */
typedef struct {
    const char *name, *doc;
    uint32_t interleave, tiles, schedulers, lanes;
    uint32_t registers, contexts, program_words, store_words;
    uint32_t bypass, writeback_stall, chain, scale, select, estimate, sleep, flags, status;
    uint32_t subnormal, nearest;
    uint32_t add_latency, mul_latency, add_cuts, mul_cuts;
} fp3_config;

extern const fp3_config fp3_configs[];
extern const uint32_t fp3_config_count;

/* By name, which may be NULL; NULL if there is none. */
const fp3_config *fp3_config_find(const char *name);

/* Schedulers in all: each has its own program and counters. */
uint32_t fp3_config_schedulers(const fp3_config *config);

#endif
