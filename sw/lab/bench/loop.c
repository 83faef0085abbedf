/* SPDX-License-Identifier: Apache-2.0 */
/* loop.c - see loop.h. */
#include "loop.h"

#include "equations.h"

#include <stdio.h>
#include <stdlib.h>

/* Behind the equations; `real` is float. */
static const char loops[] =
    "static inline __attribute__((always_inline)) void step(const real *p, real *y, real n, real "
    "h) {\n"
    "    real k1[STATES], k2[STATES], k3[STATES], k4[STATES], at[STATES], was[STATES];\n"
    "    for (int i = 0; i < STATES; i++) was[i] = y[i];\n"
    "    slopes(n * h, y, p, k1);\n"
    "    for (int i = 0; i < STATES; i++) at[i] = y[i] + 0.5f * h * k1[i];\n"
    "    slopes((n + 0.5f) * h, at, p, k2);\n"
    "    for (int i = 0; i < STATES; i++) at[i] = y[i] + 0.5f * h * k2[i];\n"
    "    slopes((n + 0.5f) * h, at, p, k3);\n"
    "    for (int i = 0; i < STATES; i++) at[i] = y[i] + h * k3[i];\n"
    "    slopes((n + 1) * h, at, p, k4);\n"
    "    for (int i = 0; i < STATES; i++) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + "
    "k4[i]);\n"
    "    events(n * h, was, (n + 1) * h, y, p);\n"
    "}\n"
    "void one(const real *p, real *y, unsigned long first, unsigned long steps, real h) {\n"
    "    real at[STATES];\n"
    "    memcpy(at, y, sizeof at);\n"
    "    for (unsigned long n = first; n < first + steps; n++) step(p, at, n, h);\n"
    "    memcpy(y, at, sizeof at);\n"
    "}\n"
    "#define BLOCK 64\n"
    "void many(const real *p, real *y, size_t objects, unsigned long steps, real h) {\n"
    "    for (size_t from = 0; from < objects; from += BLOCK) {\n"
    "        real ps[PARAMS + 1][BLOCK], ys[STATES][BLOCK];\n"
    "        for (int i = 0; i < PARAMS; i++) memcpy(ps[i], p + i * objects + from, sizeof "
    "ps[i]);\n"
    "        for (int i = 0; i < STATES; i++) memcpy(ys[i], y + i * objects + from, sizeof "
    "ys[i]);\n"
    "        for (unsigned long n = 0; n < steps; n++)\n"
    "_Pragma(\"omp simd\")\n"
    "            for (int j = 0; j < BLOCK; j++) {\n"
    "                real own[PARAMS + 1], at[STATES];\n"
    "                for (int i = 0; i < PARAMS; i++) own[i] = ps[i][j];\n"
    "                for (int i = 0; i < STATES; i++) at[i] = ys[i][j];\n"
    "                step(own, at, n, h);\n"
    "                for (int i = 0; i < STATES; i++) ys[i][j] = at[i];\n"
    "            }\n"
    "        for (int i = 0; i < STATES; i++) memcpy(y + i * objects + from, ys[i], sizeof "
    "ys[i]);\n"
    "    }\n"
    "}\n";

fp3_status fp3_bench_loop_open(const fp3_model *model, const char *const *flags,
                               fp3_bench_loop *loop, fp3_error *error) {
    char *equations = NULL, *text = NULL;
    *loop = (fp3_bench_loop){0};
    fp3_status status = fp3_bench_equations(model, FP3_BENCH_FLOAT, &equations, error);
    if (!status && asprintf(&text, "%s%s", equations, loops) < 0) {
        text = NULL;
        status = fp3_no_memory(error);
    }
    if (!status)
        status = fp3_bench_native_open(text, flags, &loop->native, error);
    if (!status)
        status = fp3_bench_native_find(loop->native, "one", &loop->one, error);
    if (!status)
        status = fp3_bench_native_find(loop->native, "many", &loop->many, error);
    if (status)
        fp3_bench_loop_close(loop);
    free(equations);
    free(text);
    return status;
}

void fp3_bench_loop_close(fp3_bench_loop *loop) {
    fp3_bench_native_close(&loop->native);
    *loop = (fp3_bench_loop){0};
}
