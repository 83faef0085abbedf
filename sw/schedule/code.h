/* code.h - the instructions of one step, before and after they have places.
 *
 * fp3_step is what the passes make: operations with operands that name values. fp3_schedule is what
 * the scheduler makes of it for a configuration: operations in order of issue, operands that name
 * registers, and how many cycles a step will take.
 */
#ifndef FP3_CODE_H
#define FP3_CODE_H

#include <fp3/status.h>
#include <machine/config.h>
#include <stdint.h>

typedef enum {
    FP3_AT_NOWHERE, /* an operand that the operation does not have */
    FP3_AT_OP,      /* result of step operation index, of this step */
    FP3_AT_FIRST, /* result of first operation index; in first operations and fp3_variable.first */
    FP3_AT_VARIABLE, /* variable index as it was when the step began */
    FP3_AT_NEXT,     /* variable index as it is when the step ends; only in last operations */
    FP3_AT_LAST,     /* result of last operation index; only there */
    FP3_AT_PARAM,    /* object register that the host writes and nobody else */
    FP3_AT_CONSTANT  /* shared constant */
} fp3_place;

typedef struct {
    fp3_place at;
    uint32_t index;
} fp3_ref;

typedef struct {
    uint32_t op;     /* FP3_OP_ADD and so on: none of sleep, ld, lds, st */
    fp3_ref a, b, c; /* as in the instruction: madd d = c + a * b */
    uint32_t note;   /* the caller's: which equation it serves; carried along */
} fp3_op;

/* What lives in an object register from step to step. */
typedef struct {
    /* Its value after the step: OP, VARIABLE (also another one), PARAM or CONSTANT. */
    fp3_ref next;
    /* NOWHERE: a state, which the host writes and reads (and a visit stores). Else it is computed
     * by the first part from states: FIRST, VARIABLE, PARAM or CONSTANT. */
    fp3_ref first;
    /* NOWHERE, or LAST: what the last part makes of it (a state). */
    fp3_ref last;
} fp3_variable;

typedef struct {
    fp3_op *first, *step, *last; /* each in an order in which operands come before their use */
    uint32_t first_count, step_count, last_count;
    fp3_variable *variables;
    uint32_t variable_count, param_count, constant_count;
    /* A constant that is -0.0, for copies; FP3_NONE_INDEX: there is none yet, the scheduler asks
     * for it by needs_minus_zero. */
    uint32_t minus_zero;
    int allow_ahead; /* operations of the next step may be executed at the end of this one */
} fp3_step;
#define FP3_NONE_INDEX UINT32_MAX

typedef struct {
    uint32_t op;
    uint32_t d;          /* object register */
    uint32_t operand[3]; /* as numbered in a word: constant k is FP3_BANK_SHARED_BASE + k */
    uint32_t note;       /* of the fp3_op; FP3_NONE_INDEX: a copy */
    uint32_t from;       /* index of the fp3_op in its part; FP3_NONE_INDEX: a copy */
    int is_ahead;        /* of the next step: executed here, and once by the first part */
} fp3_line;

typedef struct {
    fp3_line *first, *step, *last;
    uint32_t first_count, step_count, last_count;
    /* Object registers in use: variables are 0 .. variable_count-1, then params, then temps. */
    uint32_t registers;
    uint32_t constants;
    int needs_minus_zero; /* a copy reads constant constant_count, which the caller adds as -0.0 */
    uint32_t ahead;       /* operations that a step executes for the next one */
    uint32_t copies;      /* of the step: instructions that only move a value */
    uint32_t loads, stores; /* what a visit puts around the program (interleaved) */
    /* Cycles per object-step when all contexts are full, steady state, loads and stores not
     * counted: exact. 0: not known beforehand (schedulers share units). */
    double cycles;
    double bound;       /* the larger of the two below */
    double bound_issue; /* issue slots, uses of a unit, write port: whatever is scarcest */
    double bound_path;  /* the longest dependence cycle from step to step, latency over distance */
} fp3_schedule;

/* An order and registers for a configuration. FP3_E_LIMIT: too few registers: the message says how
 * many are needed at least by the best order found, and how many there are. FP3_E_ARGUMENT: a
 * reference that is none. The caller frees. */
fp3_status fp3_schedule_make(const fp3_step *step, const fp3_config *config,
                             fp3_schedule **schedule, fp3_error *error);
void fp3_schedule_free(fp3_schedule **schedule);

/* Exact cycles of a run of so many steps of these lines: what the hardware's counter CYCLES says,
 * for one object (solo machine), or with full contexts and one visit, its loads and stores
 * included (interleaved, one scheduler per arithmetic unit). 0: no steps, or not predictable. */
uint64_t fp3_schedule_cycles(const fp3_schedule *schedule, const fp3_config *config,
                             uint64_t steps);

#endif
