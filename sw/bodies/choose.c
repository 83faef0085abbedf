/* SPDX-License-Identifier: Apache-2.0 */
/* choose.c - which solvers suit this processor. */
#include "solve3.h"

#include <engine/fast/fast.h>
#include <string.h>

extern const fp3_solver2 fp3_solver2_plain;
extern const fp3_solver3 fp3_solver3_plain;
#if defined __x86_64__
extern const fp3_solver2 fp3_solver2_v3;
extern const fp3_solver3 fp3_solver3_v3;

static int has_more(void) { return __builtin_cpu_supports("avx2"); }
#define BETTER(d) fp3_solver##d##_v3
#else
static int has_more(void) { return 0; }
#define BETTER(d) fp3_solver##d##_plain
#endif

fp3_status fp3_solvers_choose(const fp3_solver2 **plane, const fp3_solver3 **space,
                              fp3_error *error) {
    fp3_fast_wish wish;
    const fp3_status status = fp3_fast_wished(&wish, error);
    const int is_least = strcmp(wish.most, fp3_solver2_plain.name) == 0 || !has_more();
    *plane = is_least ? &fp3_solver2_plain : &BETTER(2);
    *space = is_least ? &fp3_solver3_plain : &BETTER(3);
    return status;
}
