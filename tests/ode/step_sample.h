/* step_sample.h - steps to schedule: random ones, ones as an integrator makes them, and the ship's.
 */
#ifndef STEP_SAMPLE_H
#define STEP_SAMPLE_H

#include "../cosim/chance.h"

#include <compiler/schedule/code.h>
#include <fp3/isa.h>
#include <machine/operation.h>
#include <stdlib.h>
#include <string.h>

enum { VARIABLES_MAX = 40, PARAMS_MAX = 6, CONSTANTS_MAX = 6, OPS_MAX = 1000, REGISTERS = 64 };

#define MINUS_ZERO 0x80000000u

typedef struct {
    chance c;
    fp3_op first[OPS_MAX], step[OPS_MAX], last[OPS_MAX];
    fp3_variable variables[VARIABLES_MAX];
    uint32_t start[VARIABLES_MAX], params[PARAMS_MAX], constants[CONSTANTS_MAX + 1];
    fp3_step_code s;
    int is_hashed;  /* operations give numbers that depend on all that went in, no sums */
    int is_special; /* has operations that step_check.h does not know */
} sample;

/* Operands that an operation has: "dab" has two. */
static uint32_t operands_of(uint32_t op) {
    return (uint32_t)strlen(fp3_operation_find(op)->operands) - 1;
}

/* ---- random steps ---- */

static uint32_t number(chance *c) {
    return below(c, 16) ? 0x3f000000u + below(c, 0x01000000) + (below(c, 2) << 31) : value(c);
}

/* before: how many operations may be named; reach: how far back, mostly. */
static fp3_ref any_ref(sample *t, fp3_place op_at, fp3_place variable_at, uint32_t before,
                       uint32_t reach) {
    chance *c = &t->c;
    for (;;)
        switch (below(c, 8)) {
        default:
            if (before) {
                const uint32_t back = below(c, 8) && reach < before ? reach : before;
                return (fp3_ref){op_at, before - 1 - below(c, back)};
            }
            break;
        case 0:
        case 1:
            if (t->s.variable_count)
                return (fp3_ref){variable_at, below(c, t->s.variable_count)};
            break;
        case 2:
            if (t->s.param_count && below(c, 2))
                return (fp3_ref){FP3_AT_PARAM, below(c, t->s.param_count)};
            if (t->s.constant_count)
                return (fp3_ref){FP3_AT_CONSTANT, below(c, t->s.constant_count)};
        }
}

static uint32_t random_kind(sample *t, const fp3_config *config) {
    static const uint32_t kinds[] = {FP3_OP_ADD, FP3_OP_SUB,  FP3_OP_MUL,
                                     FP3_OP_MUL, FP3_OP_MADD, FP3_OP_MSUB};
    static const uint32_t specials[] = {FP3_OP_MIN, FP3_OP_ABS, FP3_OP_LT,
                                        FP3_OP_SEL, FP3_OP_RCP, FP3_OP_RSQRT};
    if (config->select && config->estimate && below(&t->c, 6) == 0) {
        t->is_special = 1;
        return specials[below(&t->c, 6)];
    }
    return kinds[below(&t->c, config->chain ? 6 : 4)];
}

static void random_ops(sample *t, const fp3_config *config, fp3_op *ops, uint32_t count,
                       fp3_place op_at, fp3_place variable_at) {
    const uint32_t reach = 1 + below(&t->c, 2 + below(&t->c, 40));
    for (uint32_t i = 0; i < count; i++) {
        ops[i] = (fp3_op){.op = random_kind(t, config), .note = i};
        fp3_ref *refs[3] = {&ops[i].a, &ops[i].b, &ops[i].c};
        for (uint32_t k = 0; k < operands_of(ops[i].op); k++)
            *refs[k] = any_ref(t, op_at, variable_at, i, reach);
    }
}

/* The first part reads states alone. */
static void read_states(const sample *t, fp3_ref *ref) {
    if (ref->at == FP3_AT_VARIABLE && t->variables[ref->index].first.at != FP3_AT_NOWHERE)
        *ref = (fp3_ref){FP3_AT_CONSTANT, 0};
}

static void random_variables(sample *t) {
    chance *c = &t->c;
    const int has_first = t->s.first_count && below(c, 2);
    for (uint32_t x = 0; x < t->s.variable_count; x++) {
        fp3_variable *v = &t->variables[x];
        *v = (fp3_variable){.next = {FP3_AT_VARIABLE, x}};
        if (below(c, 8))
            v->next = (fp3_ref){FP3_AT_OP, t->s.step_count - 1 - below(c, t->s.step_count)};
        else if (below(c, 4))
            v->next = any_ref(t, FP3_AT_OP, FP3_AT_VARIABLE, t->s.step_count, 10);
        if (has_first && x % 3 == 2)
            v->first = below(c, 4) ? (fp3_ref){FP3_AT_FIRST, below(c, t->s.first_count)}
                                   : any_ref(t, FP3_AT_FIRST, FP3_AT_VARIABLE, 1, 1);
        else if (t->s.last_count && !below(c, 4))
            v->last = (fp3_ref){FP3_AT_LAST, below(c, t->s.last_count)};
    }
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        read_states(t, &t->variables[x].first);
    for (uint32_t i = 0; i < t->s.first_count; i++) {
        read_states(t, &t->first[i].a);
        read_states(t, &t->first[i].b);
        read_states(t, &t->first[i].c);
    }
}

static void random_sample(sample *t, const fp3_config *config, uint64_t seed, uint32_t limit) {
    memset(t, 0, sizeof *t);
    t->c = (chance){.state = seed};
    chance *c = &t->c;
    fp3_step_code *s = &t->s;
    *s = (fp3_step_code){
        .first = t->first, .step = t->step, .last = t->last, .variables = t->variables};
    const uint32_t most = below(c, 2) ? 12 : limit;
    s->step_count = 1 + below(c, most);
    s->variable_count = below(c, 2) ? below(c, 6) : below(c, config->registers * 5 / 8 + 1);
    s->param_count = below(c, PARAMS_MAX + 1);
    s->constant_count = 1 + below(c, CONSTANTS_MAX);
    s->first_count = below(c, 2) ? 0 : below(c, 12);
    s->last_count = below(c, 2) ? 0 : below(c, 12);
    s->minus_zero = below(c, 2) ? 0 : FP3_NONE_INDEX;
    s->allow_ahead = below(c, 4) != 0;
    for (uint32_t i = 0; i < VARIABLES_MAX; i++)
        t->start[i] = number(c);
    for (uint32_t i = 0; i < PARAMS_MAX; i++)
        t->params[i] = number(c);
    for (uint32_t i = 0; i <= CONSTANTS_MAX; i++)
        t->constants[i] = i == 0 && s->minus_zero == 0 ? MINUS_ZERO : number(c);
    t->constants[s->constant_count] = s->minus_zero ? MINUS_ZERO : t->constants[s->constant_count];
    random_ops(t, config, t->first, s->first_count, FP3_AT_FIRST, FP3_AT_VARIABLE);
    random_ops(t, config, t->step, s->step_count, FP3_AT_OP, FP3_AT_VARIABLE);
    random_ops(t, config, t->last, s->last_count, FP3_AT_LAST, FP3_AT_NEXT);
    random_variables(t);
}

/* ---- steps as an integrator makes them ---- */

static fp3_ref add_op(sample *t, uint32_t op, fp3_ref a, fp3_ref b, fp3_ref c) {
    if (t->s.step_count == OPS_MAX)
        abort();
    t->step[t->s.step_count] = (fp3_op){op, a, b, c, t->s.step_count};
    return (fp3_ref){FP3_AT_OP, t->s.step_count++};
}

/* y + a * x, chained if that can be. */
static fp3_ref add_multiple(sample *t, const fp3_config *config, fp3_ref y, fp3_ref a, fp3_ref x) {
    if (config->chain)
        return add_op(t, FP3_OP_MADD, a, x, y);
    return add_op(t, FP3_OP_ADD, y, add_op(t, FP3_OP_MUL, a, x, (fp3_ref){0}), (fp3_ref){0});
}

/* A derivative: some operations on states of a stage, params, constants and each other. */
static fp3_ref add_derivative(sample *t, const fp3_config *config, const fp3_ref *states,
                              uint32_t seed, uint32_t length) {
    chance c = {.state = seed}; /* the same formula in each stage */
    fp3_ref value = states[below(&c, t->s.variable_count)];
    for (uint32_t i = 0; i < length; i++) {
        const fp3_ref other = below(&c, 2) ? states[below(&c, t->s.variable_count)]
                                           : (fp3_ref){FP3_AT_PARAM, below(&c, t->s.param_count)};
        const fp3_ref third = states[below(&c, t->s.variable_count)];
        switch (below(&c, 4)) {
        case 0:
            value = add_op(t, FP3_OP_SUB, other, value, (fp3_ref){0});
            break;
        case 1:
            value = add_multiple(t, config, value, other, third);
            break;
        case 2:
            value = add_multiple(t, config, other, value, third);
            break;
        default:
            value = add_op(t, FP3_OP_MUL, value, other, (fp3_ref){0});
        }
    }
    return value;
}

/* y' = y + h (b1 k1 + b2 k2 ..), ki of y + h (a1 k1 ..), with some coefficients 0. */
static void integrator_sample(sample *t, const fp3_config *config, uint64_t seed, uint32_t limit) {
    fp3_ref states[VARIABLES_MAX], k[4][VARIABLES_MAX];
    random_sample(t, config, seed, 1);
    chance *c = &t->c;
    fp3_step_code *s = &t->s;
    s->first_count = s->last_count = s->step_count = 0;
    s->allow_ahead = 1;
    s->constant_count = CONSTANTS_MAX;
    t->constants[CONSTANTS_MAX] = MINUS_ZERO;
    s->minus_zero = FP3_NONE_INDEX;
    s->param_count = 1 + below(c, PARAMS_MAX);
    s->variable_count = 1 + below(c, below(c, 3) ? 4 : 12);
    const uint32_t stages = 1 + below(c, 4), formula = below(c, 1u << 30);
    uint32_t length = limit / stages / s->variable_count;
    length = 1 + below(c, length > 40 ? 32 : length > 8 ? length - 7 : 1);
    for (uint32_t i = 0; i < stages; i++)
        for (uint32_t x = 0; x < s->variable_count; x++) {
            fp3_ref y = {FP3_AT_VARIABLE, x};
            for (uint32_t j = 0; j < i; j++)
                if (j + 1 == i || below(c, 3) == 0)
                    y = add_multiple(t, config, y, (fp3_ref){FP3_AT_CONSTANT, 1 + j}, k[j][x]);
            states[x] = y;
            if (x + 1 == s->variable_count)
                for (uint32_t z = 0; z <= x; z++)
                    k[i][z] = add_derivative(t, config, states, formula + z, length);
        }
    for (uint32_t x = 0; x < s->variable_count; x++) {
        fp3_ref y = {FP3_AT_VARIABLE, x};
        for (uint32_t j = 0; j < stages; j++)
            y = add_multiple(t, config, y, (fp3_ref){FP3_AT_CONSTANT, 1 + j}, k[j][x]);
        t->variables[x] = (fp3_variable){.next = y};
    }
}

/* ---- the ship ---- */

static fp3_ref at(fp3_place place, uint32_t index) { return (fp3_ref){place, index}; }

/* programs/ship_madd.s as operations in the order of the equations. Nothing is ahead, nothing is
 * chained from step to step: that is the scheduler's work. */
static void ship_sample(sample *t) {
    const fp3_ref v = at(FP3_AT_VARIABLE, 0), s = at(FP3_AT_VARIABLE, 1);
    const fp3_ref T = at(FP3_AT_PARAM, 0), C = at(FP3_AT_PARAM, 1), rm = at(FP3_AT_PARAM, 2);
    const fp3_ref h = at(FP3_AT_CONSTANT, 0), half = at(FP3_AT_CONSTANT, 1),
                  two = at(FP3_AT_CONSTANT, 2), sixth = at(FP3_AT_CONSTANT, 3);
    const fp3_op ops[] = {
        {FP3_OP_MSUB, C, v, T, 0},                                   /* 0 F */
        {FP3_OP_MUL, at(FP3_AT_OP, 0), rm, {0}, 0},                  /* 1 a */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 1), {0}, 0},                   /* 2 k1 */
        {FP3_OP_MADD, half, at(FP3_AT_OP, 2), v, 0},                 /* 3 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 3), T, 0},                    /* 4 */
        {FP3_OP_MUL, at(FP3_AT_OP, 4), rm, {0}, 0},                  /* 5 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 5), {0}, 0},                   /* 6 k2 */
        {FP3_OP_MADD, half, at(FP3_AT_OP, 6), v, 0},                 /* 7 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 7), T, 0},                    /* 8 */
        {FP3_OP_MUL, at(FP3_AT_OP, 8), rm, {0}, 0},                  /* 9 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 9), {0}, 0},                   /* 10 k3 */
        {FP3_OP_ADD, v, at(FP3_AT_OP, 10), {0}, 0},                  /* 11 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 11), T, 0},                   /* 12 */
        {FP3_OP_MUL, at(FP3_AT_OP, 12), rm, {0}, 0},                 /* 13 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 13), {0}, 0},                  /* 14 k4 */
        {FP3_OP_MADD, two, at(FP3_AT_OP, 6), at(FP3_AT_OP, 2), 0},   /* 15 */
        {FP3_OP_MADD, two, at(FP3_AT_OP, 10), at(FP3_AT_OP, 15), 0}, /* 16 */
        {FP3_OP_ADD, at(FP3_AT_OP, 16), at(FP3_AT_OP, 14), {0}, 0},  /* 17 */
        {FP3_OP_MADD, sixth, at(FP3_AT_OP, 17), v, 0},               /* 18 v1 */
        {FP3_OP_MADD, h, at(FP3_AT_OP, 18), s, 0},                   /* 19 s1 */
    };
    memset(t, 0, sizeof *t);
    memcpy(t->step, ops, sizeof ops);
    t->s = (fp3_step_code){.first = t->first, .step = t->step, .last = t->last};
    t->s.variables = t->variables;
    t->s.step_count = sizeof ops / sizeof *ops;
    t->s.variable_count = 2;
    t->s.param_count = 3;
    t->s.constant_count = 4;
    t->s.minus_zero = FP3_NONE_INDEX;
    t->s.allow_ahead = 1;
    t->variables[0].next = at(FP3_AT_OP, 18);
    t->variables[1].next = at(FP3_AT_OP, 19);
    const float params[] = {1.2e6f, 5e4f, 4e-7f}, constants[] = {0.0078125f, 0.5f, 2, 0.16666667f};
    memcpy(t->params, params, sizeof params);
    memcpy(t->constants, constants, sizeof constants);
    t->constants[4] = MINUS_ZERO;
}

/* Without chaining a madd is a mul and an add. */
static void unchain(sample *t) {
    static fp3_op ops[OPS_MAX];
    uint32_t now[OPS_MAX] = {0}, count = 0;
    for (uint32_t i = 0; i < t->s.step_count; i++) {
        fp3_op op = t->step[i];
        fp3_ref *refs[3] = {&op.a, &op.b, &op.c};
        for (int k = 0; k < 3; k++)
            if (refs[k]->at == FP3_AT_OP)
                refs[k]->index = now[refs[k]->index];
        if (op.op == FP3_OP_MADD || op.op == FP3_OP_MSUB) {
            ops[count] = (fp3_op){FP3_OP_MUL, op.a, op.b, {0}, 0};
            op = (fp3_op){op.op == FP3_OP_MADD ? FP3_OP_ADD : FP3_OP_SUB,
                          op.c,
                          at(FP3_AT_OP, count++),
                          {0},
                          0};
        }
        now[i] = count;
        ops[count++] = op;
    }
    memcpy(t->step, ops, count * sizeof *ops);
    t->s.step_count = count;
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        t->variables[x].next.index = now[t->variables[x].next.index];
}

#endif
