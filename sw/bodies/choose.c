/* SPDX-License-Identifier: Apache-2.0 */
/* choose.c - which solver suits this processor. */
#include "solve2.h"

#include <engine/fast/fast.h>
#include <string.h>

extern const fp3_solver2 fp3_solver2_plain;
#if defined __x86_64__
extern const fp3_solver2 fp3_solver2_v3;

static const fp3_solver2 *best(void) {
    return __builtin_cpu_supports("avx2") ? &fp3_solver2_v3 : &fp3_solver2_plain;
}
#else
static const fp3_solver2 *best(void) { return &fp3_solver2_plain; }
#endif

fp3_status fp3_solver2_choose(const fp3_solver2 **solver, fp3_error *error) {
    fp3_fast_wish wish;
    const fp3_status status = fp3_fast_wished(&wish, error);
    const int is_least = strcmp(wish.most, fp3_solver2_plain.name) == 0;
    *solver = is_least ? &fp3_solver2_plain : best();
    return status;
}
