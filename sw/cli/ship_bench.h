/* ship_bench.h - one ship program on one configuration: run, compared and measured.
 *
 * Each object is a ship of its own, with another thrust or, where that is shared, another speed at
 * the start. Every write to the registers of v and s is recorded as it retires, and compared
 * afterwards. In a visit of n steps a program writes each of them n times, in the golden order; and
 * before that the value at the beginning of the visit, bit for bit: where objects come from a store,
 * when it is loaded; and once more if the program asks for it (it may run the position one step
 * behind and begin with s + -0). Nothing else passes: no write is skipped, reordered or forgiven.
 * Then the registers are read back through the host port and compared again.
 */
#ifndef FP3_SHIP_BENCH_H
#define FP3_SHIP_BENCH_H

#include <fp3/program.h>

/* What to run; the strings stay the caller's. */
typedef struct {
    const char *config, *program;
    uint32_t objects;  /* 0: as many as the configuration has contexts */
    uint32_t visit;    /* steps per visit; 0: all */
    uint32_t awake_of; /* one of so many is awake; the others are removed, which needs a sleep */
    uint64_t steps;    /* of each object that is awake; at least 2 */
} fp3_ship_case;

typedef struct {
    uint64_t objects, awake;
    fp3_stats one, all;          /* a run of one step, and a run of all */
    uint32_t issues, adds, muls; /* of one step: instructions, uses of adder, multiplier */
    uint64_t words, mismatches;  /* compared; of those that differ ... */
    fp3_error mismatch;          /* ... the first one: step, register, both words */
    double rel_err_v, rel_err_s; /* of object 0 after all steps, against truth */
} fp3_ship_result;

/* FP3_OK also with mismatches. *is_unfit: the configuration cannot execute the image. */
fp3_status fp3_ship_bench(const fp3_program *program, const fp3_params *params,
                          const fp3_ship_case *what, fp3_ship_result *result, int *is_unfit,
                          fp3_error *error);

#endif
