/* kind.h - what a kind of engine provides behind fp3/engine.h.
 *
 * engine.c checks every argument, so a kind sees valid ones only: objects, registers and constants
 * in range, an image that fits. To add a kind, write this table and list it in engine.c.
 */
#ifndef FP3_KIND_H
#define FP3_KIND_H

#include <fp3/engine.h>

/* A named configuration, as isa/configs.toml has it. */
typedef struct {
    const char *name;
    uint32_t registers, contexts, program_words;
    int chain, subnormal, nearest;
} fp3_config;

typedef struct {
    const char *name;
    fp3_status (*open)(fp3_engine *engine);
    void (*close)(fp3_engine *engine); /* also after an open that failed */
    fp3_status (*load)(fp3_engine *engine, const fp3_image *image);
    fp3_status (*write)(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits);
    fp3_status (*read)(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits);
    fp3_status (*write_shared)(fp3_engine *engine, uint32_t index, uint32_t bits);
    fp3_status (*read_shared)(fp3_engine *engine, uint32_t index, uint32_t *bits);
    fp3_status (*run)(fp3_engine *engine, uint32_t steps,
                      fp3_stats *stats); /* counters and flags */
} fp3_engine_kind;

extern const fp3_engine_kind fp3_kind_rtl, fp3_kind_model;

struct fp3_engine {
    const fp3_engine_kind *kind;
    const fp3_config *config;
    fp3_engine_def def;
    fp3_image *image; /* NULL until a load */
    void *self;       /* the kind's own */
};

/* The two ends of a run that are not its own, in the same words from every kind. */
fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t index, uint32_t word);
fp3_status fp3_engine_limit(fp3_engine *engine);

#endif
