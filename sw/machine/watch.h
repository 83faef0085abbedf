/* SPDX-License-Identifier: Apache-2.0 */
/* watch.h - what goes wrong with each object in a run of the isa engine. */
#ifndef FP3_WATCH_H
#define FP3_WATCH_H

#include <fp3/engine.h>

/* Exceptions after which a number means nothing; divide by zero, which only inverses by logarithms
 * raise, leaves an infinity. */
#define FP3_FLAGS_GRAVE (FP3_FLAG_INVALID | FP3_FLAG_OVERFLOW)
#define FP3_NEVER UINT64_MAX

/* Steps count from 1 in this run. */
typedef struct {
    uint64_t raised;  /* the first step with a grave exception, or FP3_NEVER */
    uint64_t strayed; /* the first step after which a state was not finite; 0: before them */
    uint32_t flags;   /* the grave exceptions of the first instruction that has one */
    uint32_t ahead;   /* likewise, of the step that follows, if one follows in this visit */
    uint32_t
        partner; /* raised by what it sees of an object at the same place: 1 + its number; else 0 */
    uint32_t reg, bits; /* which state that was */
    int is_astray;      /* a state is not finite in the end */
} fp3_watched;

typedef struct {
    uint32_t object;
    fp3_watched watched;
} fp3_failed;

/* Of a configuration with `finite`, too: the host has no number for a state from 2^128 on. */
static inline int fp3_watch_is_finite(uint32_t bits) { return (~bits & 0x7f800000u) != 0; }

/* Whether these are the first grave ones. */
static inline int fp3_watch_flags(fp3_watched *w, uint32_t step, uint32_t flags) {
    if (w->raised != FP3_NEVER || !(flags & FP3_FLAGS_GRAVE))
        return 0;
    w->raised = step;
    w->flags = flags & FP3_FLAGS_GRAVE;
    return 1;
}

/* Of an instruction that works for the step that follows. */
static inline void fp3_watch_ahead(fp3_watched *w, uint32_t flags) {
    if (!w->ahead)
        w->ahead = flags & FP3_FLAGS_GRAVE;
}

/* That step begins. */
static inline void fp3_watch_step(fp3_watched *w, uint32_t step) {
    fp3_watch_flags(w, step, w->ahead);
    w->ahead = 0;
}

/* states: a set of registers. The first of them that is not finite; 64: none. */
static inline uint32_t fp3_watch_find(uint64_t states, const uint32_t *registers) {
    uint32_t reg = 0;
    while (reg < 64 && !(states >> reg & 1 && !fp3_watch_is_finite(registers[reg])))
        reg++;
    return reg;
}

static inline void fp3_watch_states(fp3_watched *w, uint32_t step, uint64_t states,
                                    const uint32_t *registers) {
    if (w->strayed != FP3_NEVER)
        return;
    const uint32_t reg = fp3_watch_find(states, registers);
    if (reg == 64)
        return;
    w->strayed = step;
    w->reg = reg;
    w->bits = registers[reg];
}

#endif
