/* step_check.h - a step evaluated as it stands, and its schedule executed: the same bits. */
#ifndef STEP_CHECK_H
#define STEP_CHECK_H

#include "step_sample.h"
#include <base/bits.h>

#include <compiler/schedule/lines.h>
#include <math.h>

/* ---- arithmetic ---- */

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return isnan(value) ? 0x7fc00000u : bits;
}

/* A sum with -0.0 is a copy, whatever the rest is. */
static uint32_t hash(uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    chance h = {.state = op};
    if (op == FP3_OP_ADD && b == MINUS_ZERO)
        return a;
    h.state = next64(&h) ^ a;
    h.state = next64(&h) ^ b;
    h.state = next64(&h) ^ c;
    return (uint32_t)next64(&h);
}

static uint32_t calculate(const sample *t, uint32_t op, uint32_t a_bits, uint32_t b_bits,
                          uint32_t c_bits) {
    if (t->is_hashed)
        return hash(op, a_bits, b_bits, c_bits);
    const float a = fp3_value_of(a_bits), b = fp3_value_of(b_bits), c = fp3_value_of(c_bits);
    volatile float product = a * b;
    switch (op) {
    case FP3_OP_ADD:
        return bits_of(a + b);
    case FP3_OP_SUB:
        return bits_of(a - b);
    case FP3_OP_MUL:
        return bits_of(product);
    case FP3_OP_MADD:
        return bits_of(c + product);
    case FP3_OP_MSUB:
        return bits_of(c - product);
    default:
        abort();
    }
}

/* ---- a step, evaluated as it stands ---- */

typedef struct {
    const sample *t;
    const uint32_t *variables; /* as they are named by VARIABLE and NEXT */
    uint32_t values[OPS_MAX];  /* of the part's operations */
} evaluation;

static uint32_t look_up(const evaluation *e, fp3_ref ref) {
    switch (ref.at) {
    case FP3_AT_NOWHERE:
        return 0;
    case FP3_AT_VARIABLE:
    case FP3_AT_NEXT:
        return e->variables[ref.index];
    case FP3_AT_PARAM:
        return e->t->params[ref.index];
    case FP3_AT_CONSTANT:
        return e->t->constants[ref.index];
    default:
        return e->values[ref.index];
    }
}

static void evaluate(evaluation *e, const fp3_op *ops, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        e->values[i] = calculate(e->t, ops[i].op, look_up(e, ops[i].a), look_up(e, ops[i].b),
                                 look_up(e, ops[i].c));
}

/* The variables of the part that follow from those of e. which: 0 first, 1 next, 2 last. */
static void assign(const evaluation *e, int which, uint32_t *to) {
    uint32_t made[VARIABLES_MAX] = {0};
    for (uint32_t x = 0; x < e->t->s.variable_count; x++) {
        const fp3_variable *v = &e->t->variables[x];
        const fp3_ref ref = which == 0 ? v->first : which == 1 ? v->next : v->last;
        made[x] = ref.at == FP3_AT_NOWHERE ? e->variables[x] : look_up(e, ref);
    }
    memcpy(to, made, sizeof made);
}

/* after[]: all variables after the steps; ended[]: after the last part, too. */
static void reference(const sample *t, uint32_t steps, uint32_t *after, uint32_t *ended) {
    static evaluation e;
    e = (evaluation){.t = t, .variables = after};
    memcpy(after, t->start, sizeof t->start);
    evaluate(&e, t->first, t->s.first_count);
    assign(&e, 0, after);
    for (uint32_t i = 0; i < steps; i++) {
        evaluate(&e, t->step, t->s.step_count);
        assign(&e, 1, after);
    }
    evaluate(&e, t->last, t->s.last_count);
    assign(&e, 2, ended);
}

/* ---- lines, executed ---- */

typedef struct {
    uint32_t registers[REGISTERS], record[REGISTERS];
} object;

static uint32_t fetch(const sample *t, const uint32_t *registers, const fp3_line *line,
                      uint32_t k) {
    const uint32_t operand = line->operand[k];
    if (k >= operands_of(line->op))
        return 0;
    return operand < FP3_BANK_SHARED_BASE ? registers[operand]
                                          : t->constants[operand - FP3_BANK_SHARED_BASE];
}

static void execute(const sample *t, const fp3_line *lines, uint32_t count, object *o) {
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t d = lines[i].d;
        if (lines[i].op == FP3_OP_ST)
            o->record[d] = o->registers[d];
        else if (lines[i].op == FP3_OP_LD)
            o->registers[d] = o->record[d];
        else
            o->registers[d] = calculate(t, lines[i].op, fetch(t, o->registers, &lines[i], 0),
                                        fetch(t, o->registers, &lines[i], 1),
                                        fetch(t, o->registers, &lines[i], 2));
    }
}

/* What no host has written is something else in every register and every word. */
static void fill(const sample *t, object *o) {
    uint32_t *host = t->s.may_spill ? o->record : o->registers;
    for (uint32_t r = 0; r < REGISTERS; r++) {
        o->registers[r] = 0x43000000u + (r << 16);
        o->record[r] = 0x44000000u + (r << 16);
    }
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        if (t->variables[x].first.at == FP3_AT_NOWHERE)
            host[x] = t->start[x];
    memcpy(host + t->s.variable_count, t->params, t->s.param_count * sizeof *host);
}

static int is_within(const fp3_schedule *s, const fp3_config *config, const sample *t,
                     const fp3_line *lines, uint32_t count) {
    const uint32_t params = t->s.variable_count, temps = params + t->s.param_count;
    for (uint32_t i = 0; i < count; i++) {
        const int is_params = lines[i].d >= params && lines[i].d < temps;
        if (lines[i].d >= s->registers || (is_params && !t->s.may_spill))
            return 0;
        for (uint32_t k = 0; k < 3 && fp3_operation_is_arithmetic(fp3_operation_find(lines[i].op));
             k++) {
            const uint32_t operand = lines[i].operand[k];
            if (k >= operands_of(lines[i].op)    ? operand != 0
                : operand < FP3_BANK_SHARED_BASE ? operand >= s->registers
                                                 : operand - FP3_BANK_SHARED_BASE >= s->constants)
                return 0;
        }
    }
    return s->registers <= config->registers;
}

static const char *check_lines(const fp3_config *config, const sample *t, const fp3_schedule *s) {
    const int spills = t->s.may_spill;
    uint32_t after[VARIABLES_MAX], ended[VARIABLES_MAX];
    object o;
    if (s->registers > REGISTERS || !is_within(s, config, t, s->first, s->first_count) ||
        !is_within(s, config, t, s->step, s->step_count) ||
        !is_within(s, config, t, s->last, s->last_count))
        return "a register that is not there";
    for (uint32_t steps = 1; steps <= 5; steps += 2) {
        reference(t, steps, after, ended);
        const uint32_t *kept = spills ? o.record : o.registers;
        fill(t, &o);
        execute(t, s->first, s->first_count, &o);
        for (uint32_t i = 0; i < steps; i++)
            execute(t, s->step, s->step_count, &o);
        if (!spills && memcmp(o.registers, after, t->s.variable_count * sizeof *after) != 0)
            return "other bits after the steps";
        if (memcmp(kept + t->s.variable_count, t->params, t->s.param_count * sizeof *kept) != 0)
            return "a param changes";
        execute(t, s->last, s->last_count, &o);
        for (uint32_t x = 0; x < t->s.variable_count; x++)
            if (t->variables[x].first.at == FP3_AT_NOWHERE && kept[x] != ended[x])
                return "other bits after the last part";
    }
    return NULL;
}

#endif
