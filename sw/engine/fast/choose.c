/* SPDX-License-Identifier: Apache-2.0 */
/* choose.c - which interpreter suits this processor and this arithmetic. */
#include "sweep.h"

#include <machine/execute.h>
#include <string.h>

extern const fp3_sweep fp3_sweep_plain, fp3_sweep_flushed, fp3_sweep_cut, fp3_sweep_flushed_cut,
    fp3_sweep_finite, fp3_sweep_words;

/* The kinds of this family, from the least on, and those among them that this processor is. */
#if defined __x86_64__
extern const fp3_sweep fp3_sweep_v3, fp3_sweep_v4;
static const fp3_sweep *const kinds[] = {&fp3_sweep_plain, &fp3_sweep_v3, &fp3_sweep_v4};
const char fp3_sweep_kinds[] = "x86-64, x86-64-v3 or x86-64-v4";

static int is_kind(int kind) {
    const int is[] = {1, __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"),
                      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")};
    return is[kind];
}
#else
static const fp3_sweep *const kinds[] = {&fp3_sweep_plain};
const char fp3_sweep_kinds[] = "or " FP3_SWEEP_LEAST;

static int is_kind(int kind) {
    (void)kind;
    return 1;
}
#endif
enum { KINDS = sizeof kinds / sizeof *kinds };

/* Other arithmetic is rare: for it the least kind of processor has to do. */
static const fp3_sweep *rare(const fp3_config *config) {
    if (config->finite)
        return &fp3_sweep_finite;
    if (fp3_execute_is_of_words(config))
        return &fp3_sweep_words;
    if (config->subnormal)
        return &fp3_sweep_cut;
    return config->nearest ? &fp3_sweep_flushed : &fp3_sweep_flushed_cut;
}

int fp3_sweep_is_kind(const char *name) {
    for (int i = 0; i < KINDS; i++)
        if (strcmp(kinds[i]->name, name) == 0)
            return 1;
    return 0;
}

const fp3_sweep *fp3_sweep_choose(const fp3_config *config, const char *most) {
    const fp3_sweep *best = kinds[0];
    if (!config->subnormal || !config->nearest || fp3_execute_is_of_words(config))
        return rare(config);
    for (int i = 0; i < KINDS && is_kind(i); i++) {
        best = kinds[i];
        if (strcmp(best->name, most) == 0)
            break;
    }
    return best;
}
