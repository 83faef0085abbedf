/* SPDX-License-Identifier: Apache-2.0 */
/* longest.c - the longest dependence from step to step. */
#include "longest.h"

#include "machine/cycles.h"

#include <stdlib.h>

/* The largest mean weight of a circle (Karp). weight[x * n + y]: from x to y in one step; below 0:
 * none. */
static double largest_mean(const double *weight, uint32_t n, double *longest) {
    /* longest[k * n + y]: of walks of k edges from anywhere to y; each n of them. */
    for (uint32_t y = 0; y < n; y++)
        longest[y] = 0;
    for (uint32_t k = 1; k <= n; k++)
        for (uint32_t y = 0; y < n; y++) {
            double most = -1;
            for (uint32_t x = 0; x < n; x++) {
                const double before = longest[(k - 1) * n + x], edge = weight[x * n + y];
                if (before >= 0 && edge >= 0 && before + edge > most)
                    most = before + edge;
            }
            longest[k * n + y] = most;
        }
    double best = 0;
    for (uint32_t y = 0; y < n; y++) {
        double least = -1;
        for (uint32_t k = 0; k < n && longest[n * n + y] >= 0; k++)
            if (longest[k * n + y] >= 0) {
                const double mean = (longest[n * n + y] - longest[k * n + y]) / (double)(n - k);
                if (least < 0 || mean < least)
                    least = mean;
            }
        if (least > best)
            best = least;
    }
    return best;
}

/* Of each operation, the cycles from reading variable x to its result; -1: independent of x. */
static void path_from(const fp3_step_code *code, const fp3_config *config, uint32_t x, double *to) {
    for (uint32_t i = 0; i < code->step_count; i++) {
        const fp3_op *op = &code->step[i];
        const fp3_ref refs[3] = {op->a, op->b, op->c};
        double begin = -1;
        for (int k = 0; k < 3; k++) {
            const double here = refs[k].at == FP3_AT_OP ? to[refs[k].index]
                                : refs[k].at == FP3_AT_VARIABLE && refs[k].index == x ? 0
                                                                                      : -1;
            if (here > begin)
                begin = here;
        }
        to[i] = begin < 0 ? -1 : begin + fp3_cycles_delay(config, op->op);
    }
}

fp3_status fp3_longest_path(const fp3_step_code *code, const fp3_config *config, double *cycles,
                            fp3_error *error) {
    const uint32_t n = code->variable_count;
    *cycles = 0;
    double *weight = malloc(((size_t)n * (2 * n + 1) + code->step_count + 1) * sizeof *weight);
    if (!weight)
        return fp3_no_memory(error);
    double *longest = weight + (size_t)n * n, *to = longest + (size_t)n * (n + 1);
    for (uint32_t x = 0; x < n; x++) {
        path_from(code, config, x, to);
        for (uint32_t y = 0; y < n; y++) {
            const fp3_ref next = code->variables[y].next;
            weight[x * n + y] = next.at == FP3_AT_OP                            ? to[next.index]
                                : next.at == FP3_AT_VARIABLE && next.index == x ? 0
                                                                                : -1;
        }
    }
    *cycles = n ? largest_mean(weight, n, longest) : 0;
    free(weight);
    return FP3_OK;
}
