/* SPDX-License-Identifier: Apache-2.0 */
/* code.h - the operations of one step before they have places.
 *
 * Operands name values. The compiler makes a code; the scheduler turns it into lines (lines.h).
 */
#ifndef FP3_CODE_H
#define FP3_CODE_H

#include <fp3/status.h>
#include <machine/needs.h>
#include <stdint.h>

typedef enum {
    FP3_AT_NOWHERE, /* an operand that the operation does not have */
    FP3_AT_OP,      /* result of step operation index, of this step */
    FP3_AT_FIRST, /* result of first operation index; in first operations and fp3_variable.first */
    FP3_AT_VARIABLE, /* variable index as it was when the step began */
    FP3_AT_NEXT,     /* variable index as it is when the step ends; only in last operations */
    FP3_AT_LAST,     /* result of last operation index; only there */
    FP3_AT_PARAM,    /* object register that only the host writes */
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
    /* NOWHERE: a state, which the host writes and reads (and a visit stores). Else the first part
     * computes the variable from states: FIRST, VARIABLE, PARAM or CONSTANT. */
    fp3_ref first;
    /* NOWHERE, or LAST: what the last part makes of it (a state). */
    fp3_ref last;
} fp3_variable;

typedef struct {
    fp3_op *first, *step, *last; /* each in an order in which operands come before their use */
    uint32_t first_count, step_count, last_count;
    fp3_variable *variables;
    uint32_t variable_count, param_count, constant_count;
    /* A constant that is -0.0, for copies; FP3_NONE_INDEX: none yet; the scheduler asks for one by
     * needs_minus_zero. */
    uint32_t minus_zero;
    /* Where sums and products are apart (`dual`): the registers of the params, which say which of
     * the two each is kept with. Variables are kept with sums, in the lowest even registers. NULL
     * elsewhere. */
    uint32_t *param_registers;
    int allow_ahead; /* operations of the next step may be executed at the end of this one */
    int may_spill;   /* many objects: values may be stored and loaded within the program */
    /* Sets of one variable or none: what a `sleep` behind the step part writes, and reads. */
    uint64_t slept, tested;
} fp3_step_code;
#define FP3_NONE_INDEX UINT32_MAX

/* The object register of a variable and of a param, and the owner of a register: VARIABLE, PARAM or
 * NOWHERE. */
uint32_t fp3_code_variable(const fp3_step_code *code, uint32_t variable);
uint32_t fp3_code_param(const fp3_step_code *code, uint32_t param);
fp3_ref fp3_code_owner(const fp3_step_code *code, uint32_t reg);

/* Its operations, constants and words, as far as they are known before it is scheduled. */
fp3_needs fp3_code_needs(const fp3_step_code *code);

#endif
