/* SPDX-License-Identifier: Apache-2.0 */
/* choose.c - which solver suits this processor. */
#include "solve2.h"

extern const fp3_solver2 fp3_solver2_plain;
#if defined __x86_64__
extern const fp3_solver2 fp3_solver2_v3;

const fp3_solver2 *fp3_solver2_choose(void) {
    return __builtin_cpu_supports("avx2") ? &fp3_solver2_v3 : &fp3_solver2_plain;
}
#else
const fp3_solver2 *fp3_solver2_choose(void) { return &fp3_solver2_plain; }
#endif
