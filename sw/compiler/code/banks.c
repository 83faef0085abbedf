/* SPDX-License-Identifier: Apache-2.0 */
/* banks.c - see banks.h. */
#include "banks.h"

#include "machine/operation.h"

#include <fp3/isa.h>
#include <stdlib.h>

typedef enum { EITHER, SUM, PRODUCT } bank;

typedef struct {
    fp3_step_code *code;
    uint32_t one, minus_zero;
    bank *params;
} banks;

/* A part: its operations as they were and as they become. */
typedef struct {
    const banks *b;
    fp3_place own;
    const fp3_op *from;
    uint32_t from_count;
    fp3_op *to;
    uint32_t to_count;
    uint32_t *at;    /* of each operation, where it is now */
    uint32_t *moved; /* of each operation, variable, param: its move, or FP3_NONE_INDEX */
    uint32_t *wants; /* of the same: operations that need it, or their other operand, moved */
} part;

static int adds(uint32_t op) { return !fp3_operation_multiplies(fp3_operation_find(op)); }

/* It reads a register of sums alone. */
static int estimates(uint32_t op) { return (fp3_operation_find(op)->path & FP3_UNIT_VALUE) != 0; }

static bank bank_of(const part *p, fp3_ref ref) {
    if (ref.at == p->own)
        return adds(p->from[ref.index].op) ? SUM : PRODUCT;
    if (ref.at == FP3_AT_VARIABLE || ref.at == FP3_AT_NEXT)
        return SUM;
    return ref.at == FP3_AT_PARAM ? p->b->params[ref.index] : EITHER;
}

/* Where moved and wants have it. */
static uint32_t slot_of(const part *p, fp3_ref ref) {
    const fp3_step_code *code = p->b->code;
    if (ref.at == p->own)
        return ref.index;
    if (ref.at == FP3_AT_PARAM)
        return p->from_count + code->variable_count + ref.index;
    return p->from_count + ref.index;
}

/* ---- params ---- */

static void vote(const part *p, const fp3_op *op, fp3_ref param, fp3_ref other, int is_b,
                 int *sums) {
    const bank of = bank_of(p, other);
    if (param.at != FP3_AT_PARAM)
        return;
    if (fp3_operation_scales(op->op))
        sums[param.index] += is_b ? -1 : 1;
    else if (estimates(op->op))
        sums[param.index]++;
    else if (other.at != FP3_AT_PARAM && of != EITHER)
        sums[param.index] += of == PRODUCT ? 1 : -1;
}

static void vote_all(const part *p, int *sums) {
    for (uint32_t i = 0; i < p->from_count; i++) {
        vote(p, &p->from[i], p->from[i].a, p->from[i].b, 0, sums);
        vote(p, &p->from[i], p->from[i].b, p->from[i].a, 1, sums);
    }
}

static fp3_status give_registers(const banks *b, fp3_error *error) {
    fp3_step_code *code = b->code;
    uint32_t sums = code->variable_count, products = 0;
    code->param_registers = calloc(code->param_count + 1u, sizeof *code->param_registers);
    if (!code->param_registers)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < code->param_count; i++)
        code->param_registers[i] = b->params[i] == SUM ? 2 * sums++ : 2 * products++ + 1;
    return FP3_OK;
}

/* ---- moves ---- */

/* Which of a and b has to be moved: 0 none, 1 a, 2 b, 3 one of them. */
static int conflict_of(const part *p, const fp3_op *op) {
    const bank a = bank_of(p, op->a), b = bank_of(p, op->b);
    if (fp3_operation_scales(op->op))
        return (a == PRODUCT ? 1 : 0) + (b == SUM ? 2 : 0);
    if (estimates(op->op))
        return a == PRODUCT ? 1 : 0;
    return a != EITHER && a == b ? 3 : 0;
}

static fp3_ref now(const part *p, fp3_ref ref) {
    if (ref.at == p->own)
        ref.index = p->at[ref.index];
    return ref;
}

static fp3_ref move(part *p, fp3_ref ref, uint32_t note) {
    uint32_t *moved = &p->moved[slot_of(p, ref)];
    const int is_sum = bank_of(p, ref) == SUM;
    if (*moved == FP3_NONE_INDEX) {
        *moved = p->to_count;
        p->to[p->to_count++] =
            (fp3_op){.op = is_sum ? FP3_OP_MUL : FP3_OP_ADD,
                     .a = now(p, ref),
                     .b = {FP3_AT_CONSTANT, is_sum ? p->b->one : p->b->minus_zero},
                     .note = note};
    }
    return (fp3_ref){p->own, *moved};
}

/* The one that is moved already; else the one that is more often in the way. */
static int chosen(const part *p, const fp3_op *op) {
    const uint32_t a = slot_of(p, op->a), b = slot_of(p, op->b);
    if (p->moved[a] != FP3_NONE_INDEX || p->moved[b] != FP3_NONE_INDEX)
        return p->moved[a] != FP3_NONE_INDEX ? 1 : 2;
    return p->wants[a] > p->wants[b] ? 1 : 2;
}

static void split(part *p) {
    for (uint32_t i = 0; i < p->from_count; i++)
        if (conflict_of(p, &p->from[i]) == 3 && !fp3_operation_scales(p->from[i].op)) {
            p->wants[slot_of(p, p->from[i].a)]++;
            p->wants[slot_of(p, p->from[i].b)]++;
        }
    for (uint32_t i = 0; i < p->from_count; i++) {
        fp3_op op = p->from[i];
        int which = conflict_of(p, &op);
        if (which == 3 && !fp3_operation_scales(op.op))
            which = chosen(p, &op);
        const fp3_ref a = which & 1 ? move(p, op.a, op.note) : now(p, op.a);
        const fp3_ref b = which & 2 ? move(p, op.b, op.note) : now(p, op.b);
        op.a = a;
        op.b = b;
        p->at[i] = p->to_count;
        p->to[p->to_count++] = op;
    }
}

/* What a variable becomes: a sum. */
static fp3_ref root(part *p, fp3_ref ref) {
    if (ref.at != p->own)
        return ref;
    return bank_of(p, ref) == PRODUCT ? move(p, ref, p->from[ref.index].note) : now(p, ref);
}

static fp3_status open_part(const banks *b, fp3_place own, const fp3_op *ops, uint32_t count,
                            part *p, fp3_error *error) {
    const fp3_step_code *code = b->code;
    const size_t slots = (size_t)count + code->variable_count + code->param_count + 1;
    *p = (part){.b = b, .own = own, .from = ops, .from_count = count};
    p->to = calloc(2 * slots + count, sizeof *p->to);
    p->at = calloc(3 * slots, sizeof *p->at);
    if (!p->to || !p->at)
        return fp3_no_memory(error);
    p->moved = p->at + slots;
    p->wants = p->moved + slots;
    for (size_t i = 0; i < slots; i++)
        p->moved[i] = FP3_NONE_INDEX;
    return FP3_OK;
}

/* The moves of a part, and what its roots are called then. */
static fp3_status split_part(const banks *b, fp3_place own, fp3_op **ops, uint32_t *count,
                             fp3_ref *(*to)(fp3_variable *v), fp3_error *error) {
    part p;
    const fp3_status status = open_part(b, own, *ops, *count, &p, error);
    if (!status) {
        split(&p);
        for (uint32_t x = 0; x < b->code->variable_count; x++)
            *to(&b->code->variables[x]) = root(&p, *to(&b->code->variables[x]));
        free(*ops);
        *ops = p.to;
        *count = p.to_count;
        p.to = NULL;
    }
    free(p.to);
    free(p.at);
    return status;
}

static fp3_ref *next_of(fp3_variable *v) { return &v->next; }
static fp3_ref *first_of(fp3_variable *v) { return &v->first; }
static fp3_ref *last_of(fp3_variable *v) { return &v->last; }

fp3_status fp3_banks_split(fp3_step_code *code, uint32_t one, uint32_t minus_zero,
                           fp3_error *error) {
    banks b = {code, one, minus_zero, calloc(code->param_count + 1u, sizeof *b.params)};
    int *sums = calloc(code->param_count + 1u, sizeof *sums);
    fp3_status status = b.params && sums ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        vote_all(
            &(part){.b = &b, .own = FP3_AT_OP, .from = code->step, .from_count = code->step_count},
            sums);
        for (uint32_t i = 0; i < code->param_count; i++)
            b.params[i] = sums[i] > 0 ? SUM : PRODUCT;
        status = give_registers(&b, error);
    }
    if (!status)
        status = split_part(&b, FP3_AT_OP, &code->step, &code->step_count, next_of, error);
    if (!status)
        status = split_part(&b, FP3_AT_FIRST, &code->first, &code->first_count, first_of, error);
    if (!status)
        status = split_part(&b, FP3_AT_LAST, &code->last, &code->last_count, last_of, error);
    free(b.params);
    free(sums);
    return status;
}
