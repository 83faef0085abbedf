/* ship_bench.h - one ship program on one configuration: run, compared and measured.
 *
 * Every write to the registers of v and s is recorded as it retires, and compared afterwards. In n
 * steps a program writes each of them n times, in the golden order; or n + 1 times, where the first
 * write is the value that the host gave, bit for bit (a program may run the position one step
 * behind and begin with s + -0). Nothing else passes: no write is skipped, reordered or forgiven.
 * Then the registers are read back through the host port and compared again.
 */
#ifndef FP3_SHIP_BENCH_H
#define FP3_SHIP_BENCH_H

#include "params.h"

typedef struct {
    const char *config, *program;
    uint64_t objects;   /* each with another speed at the start */
    uint64_t steps;     /* of `all`; at least 2 */
    fp3_stats one, all; /* a run of one step, and a run of all */
    uint64_t words, mismatches;
    fp3_error mismatch;          /* the first one: step, register, both words */
    double rel_err_v, rel_err_s; /* of object 0 after all steps, against truth */
} fp3_ship_result;

/* The caller sets config, program and steps. FP3_OK also with mismatches. *is_unfit: the
 * configuration cannot execute the image. */
fp3_status fp3_ship_bench(const fp3_image *image, fp3_params *params, fp3_ship_result *result,
                          int *is_unfit, fp3_error *error);

#endif
