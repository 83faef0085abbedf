/* SPDX-License-Identifier: Apache-2.0 */
/* plan.h - a program as the fast engine executes it: decoded, with what each instruction has to
 * take care of.
 *
 * The parts of a program are executed for a block of objects at a time, a row of lanes for each
 * register (block.h). Between parts, and from step to step, only the registers that something reads
 * later are in their rows.
 */
#ifndef FP3_FAST_PLAN_H
#define FP3_FAST_PLAN_H

#include <fp3/isa.h>
#include <machine/neighbours.h>
#include <machine/operation.h>
#include <machine/placement.h>

/* Each register of a set, in order. */
static inline uint32_t fp3_register_from(uint64_t set, uint32_t first) {
    const uint64_t left = first < FP3_BANK_OBJECT_COUNT ? set >> first : 0;
    return left ? first + (uint32_t)__builtin_ctzll(left) : FP3_BANK_OBJECT_COUNT;
}
#define FP3_EACH_REGISTER(set, reg)                                                                \
    for (uint32_t reg = fp3_register_from((set), 0); reg < FP3_BANK_OBJECT_COUNT;                  \
         reg = fp3_register_from((set), reg + 1))

/* An operand that a neighbour gives. Sets of registers and of constants do not have it; its row is
 * behind those of registers. */
#define FP3_FAST_GIVEN (FP3_BANK_SHARED_BASE + FP3_BANK_SHARED_COUNT)
#define FP3_FAST_ROWS (FP3_BANK_OBJECT_COUNT + 1)

typedef struct {
    fp3_instruction
        in; /* arithmetic with what a neighbour gives: of registers, one of them FP3_FAST_GIVEN */
    fp3_gives gives; /* what a neighbour gives: to register d, or as that operand */
    uint32_t number; /* ... of the word or of the field; of `stl` that of the field */
    int ends_phase;
    int is_dead;    /* nothing reads its result: it counts for its flags alone */
    int is_unread;  /* no step reads its result: in all steps but the last one it counts for its
                       flags alone */
    int is_rounded; /* a store to a record of 16 bits, of another register than that of `sleep` */
    int is_masked;  /* objects that sleep keep what is in d */
    int is_one_nan; /* what is written is seen as it is: a NaN is made the one of the machine */
    int is_behind;  /* an operand may be a NaN that the host wrote, or the operation makes one: see
                       fp3_behind in lanes.h */
    int is_behind_words; /* the same where no shared constant is a NaN: fp3_fast_native_for */
} fp3_fast_word;

typedef enum { FP3_PART_FIRST, FP3_PART_STEP, FP3_PART_LAST, FP3_PARTS } fp3_fast_part_number;

typedef struct {
    uint32_t first, end; /* of the instructions */
    uint64_t written;    /* rows */
    uint64_t words;      /* of records, that it loads or stores */
    uint64_t stored;     /* those that it stores */
} fp3_fast_part;

/* A loop over neighbours. */
typedef struct {
    uint32_t first, end; /* of the instructions within */
    uint32_t list;       /* number of the list */
    uint64_t outside,
        kept;    /* registers that it reads as they were before; that something reads after it */
    int is_fold; /* what it keeps are sums, leasts and mosts */
} fp3_fast_loop;

typedef struct {
    const fp3_config *config;
    fp3_fast_word *code;
    uint32_t count;
    fp3_fast_part part[FP3_PARTS];
    uint64_t entered;      /* rows that count before the first part, ... */
    uint64_t live;         /* ... between two steps, and for those asleep, ... */
    uint64_t left;         /* ... and behind the last part */
    uint64_t written;      /* registers that an arithmetic operation writes */
    uint64_t constants;    /* shared constants that are read */
    uint64_t read, stored; /* record words: by ld and lds; by st */
    fp3_neighbourhood
        around; /* with neighbours: of these parts only the step part has instructions */
    fp3_fast_loop *loops;
    uint32_t loop_count;
    int is_final;      /* a phase that writes fields of entries, and so is never made again, has a
                          loop that is no fold: native code has none */
    uint32_t *phase;   /* where each phase begins, and where the last one ends */
    uint32_t *order;   /* which of these a step makes, one after the other */
    int sleeps, slept; /* there is a sleep; the register of sleep and lds, or -1 */
    int has_lds;       /* objects whose word for sleep is not 0 make no visit */
} fp3_fast_plan;

/* Of a program with neighbours: words of a record, whole quads of them. */
uint32_t fp3_fast_record(const fp3_fast_plan *plan);
/* The registers of the object that a word reads or writes. */
uint64_t fp3_fast_touched(const fp3_fast_word *word);
/* Whether a phase writes fields of entries; whether all its loops are folds. */
int fp3_fast_remembers(const fp3_fast_plan *plan, uint32_t phase);
int fp3_fast_folds(const fp3_fast_plan *plan, uint32_t phase);

/* states: registers that are looked at after each step. *plan is freed by the caller.
 * FP3_E_PROGRAM: a word is no instruction that the configuration has, or an lds stands behind
 * something else than loads. */
fp3_status fp3_fast_plan_make(const fp3_config *config, const fp3_code *code, uint64_t states,
                              const fp3_neighbourhood *around, fp3_fast_plan *plan,
                              fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_fast_plan_free(fp3_fast_plan *plan);

#endif
