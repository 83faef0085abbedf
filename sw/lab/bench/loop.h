/* SPDX-License-Identifier: Apache-2.0 */
/* loop.h - the loop that one writes by hand: a model by rk4 in plain C, compiled by the host's
 * compiler.
 *
 * FP32, the functions of libm, the sums of the textbook; the events of the model after each step.
 */
#ifndef FP3_BENCH_LOOP_H
#define FP3_BENCH_LOOP_H

#include "native.h"

#include <fp3/model.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    fp3_bench_native *native;
    /* Steps first .. first + steps - 1 of one object: p its params, y its states. */
    void (*one)(const float *p, float *y, uint64_t first, uint64_t steps, float h);
    /* The same of `objects` objects (a multiple of FP3_BENCH_LOOP_BLOCK) from step 0, in columns: p
     * and y have a row of `objects` numbers for each param and state. The compiler may use vectors.
     */
    void (*many)(const float *p, float *y, size_t objects, uint64_t steps, float h);
} fp3_bench_loop;

#define FP3_BENCH_LOOP_BLOCK 64

/* flags: of the compiler, ended by NULL. As fp3_bench_native_open. */
fp3_status fp3_bench_loop_open(const fp3_model *model, const char *const *flags,
                               fp3_bench_loop *loop, fp3_error *error);
void fp3_bench_loop_close(fp3_bench_loop *loop);

#endif
