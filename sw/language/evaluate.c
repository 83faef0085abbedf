/* SPDX-License-Identifier: Apache-2.0 */
#include "evaluate.h"

#include "function_rows.h"

#include <math.h>
#include <string.h>

unsigned fp3_ode_operands(fp3_expr_op op) {
    static const unsigned char operands[] = {
#define X(NAME, operands, host) operands,
        FP3_EXPR_OPS(X)
#undef X
    };
    return operands[op];
}

int fp3_ode_has_constants(fp3_expr_op op) {
    enum { INSTRUCTIONS, POLYNOMIAL, POLYNOMIAL_2 };
    static const unsigned char made[FP3_EXPR_OP_COUNT] = {
#define X(OP, name, MADE, ...) [FP3_EXPR_##OP] = (MADE),
        FP3_FUNCTION_ROWS(X)
#undef X
            [FP3_EXPR_POWER] = POLYNOMIAL,
    };
    return made[op] != INSTRUCTIONS;
}

double fp3_ode_compute(const fp3_expr *e, const fp3_point *point, const double *values) {
    double v[3] = {0};
    for (unsigned i = 0; i < fp3_ode_operands(e->op); i++)
        v[i] = values[e->operand[i]];
    double a = v[0], b = v[1], c = v[2];
    switch (e->op) {
    case FP3_EXPR_NUMBER:
        return e->number;
    case FP3_EXPR_STATE:
        return point->states[e->index];
    case FP3_EXPR_PARAM:
        return point->params[e->index];
    case FP3_EXPR_TIME:
        return point->t;
    case FP3_EXPR_INITIAL:
        return point->initial ? point->initial[e->index] : NAN;
    case FP3_EXPR_NEGATE:
        return -a;
    case FP3_EXPR_ADD:
        return a + b;
    case FP3_EXPR_SUB:
        return a - b;
    case FP3_EXPR_MUL:
        return a * b;
    case FP3_EXPR_DIV:
        return a / b;
    case FP3_EXPR_POWER:
        return pow(a, b);
    case FP3_EXPR_LESS:
        return a < b;
    case FP3_EXPR_LESS_EQUAL:
        return a <= b;
    case FP3_EXPR_EQUAL:
        return a == b;
    case FP3_EXPR_AND:
        return a != 0 && b != 0;
    case FP3_EXPR_OR:
        return a != 0 || b != 0;
    case FP3_EXPR_NOT:
        return a == 0;
#define X(OP, name, MADE, UNIT, VALUE, ...)                                                        \
    case FP3_EXPR_##OP:                                                                            \
        return VALUE;
        FP3_FUNCTION_ROWS(X)
#undef X
    case FP3_EXPR_OTHER_STATE: /* an object alone has no known neighbours */
    case FP3_EXPR_OTHER_PARAM:
    case FP3_EXPR_FIELD:
    case FP3_EXPR_TOTAL:
    case FP3_EXPR_LEAST:
    case FP3_EXPR_MOST:
    case FP3_EXPR_STEP: /* nor a step */
    case FP3_EXPR_BEFORE:
    case FP3_EXPR_OBJECTS: /* nor all objects */
    case FP3_EXPR_PAIRS:
    case FP3_EXPR_OP_COUNT:
        break;
    }
    return NAN;
}

static void compute_each(const fp3_expr *e, const double *const operand[3], size_t count,
                         double *column) {
    const fp3_expr alike = {.op = e->op, .number = e->number, .operand = {0, 1, 2}};
    for (size_t i = 0; i < count; i++) {
        double v[3] = {0};
        for (unsigned k = 0; k < fp3_ode_operands(e->op); k++)
            v[k] = operand[k][i];
        column[i] = fp3_ode_compute(&alike, NULL, v);
    }
}

void fp3_ode_compute_column(const fp3_expr *e, const double *params, const double *values,
                            size_t count, double *column) {
    const double *operand[3] = {0};
    for (unsigned k = 0; k < fp3_ode_operands(e->op); k++)
        operand[k] = values + e->operand[k] * count;
    const double *a = operand[0], *b = operand[1];
    switch (e->op) {
    case FP3_EXPR_PARAM:
        memcpy(column, params + e->index * count, count * sizeof *column);
        break;
#define X(OP, VALUE)                                                                               \
    case FP3_EXPR_##OP:                                                                            \
        for (size_t i = 0; i < count; i++)                                                         \
            column[i] = (VALUE);                                                                   \
        break;
        X(NUMBER, e->number)
        X(NEGATE, -a[i])
        X(ADD, a[i] + b[i])
        X(SUB, a[i] - b[i])
        X(MUL, a[i] * b[i])
        X(DIV, a[i] / b[i])
#undef X
    default:
        compute_each(e, operand, count, column);
    }
}

void fp3_model_evaluate(const fp3_model *model, const fp3_point *point, double *values) {
    for (uint32_t i = 0; i < model->expr_count; i++)
        values[i] = fp3_ode_compute(&model->exprs[i], point, values);
}

static int is_other(double a, double b) { return a != b && !(isnan(a) && isnan(b)); }

/* The set of events that happen where their conditions are not 0. */
static uint64_t find_armed(const fp3_model *model, const fp3_point *before, double *values) {
    uint64_t armed = 0;
    int is_evaluated = 0;
    for (uint32_t i = 0; i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        const int is_edge = event->armed != FP3_NONE;
        if (is_edge && before && !is_evaluated) {
            fp3_model_evaluate(model, before, values);
            is_evaluated = 1;
        }
        if (!is_edge || (before && values[event->armed] != 0))
            armed |= UINT64_C(1) << i;
    }
    return armed;
}

int fp3_model_fire(const fp3_model *model, const fp3_point *before, const double *params, double t,
                   double *states, double *values) {
    const uint64_t armed = find_armed(model, before, values);
    int fired = 0;
    for (uint32_t i = 0; i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        fp3_model_evaluate(model, &(fp3_point){.states = states, .params = params, .t = t}, values);
        if (values[event->condition] == 0 || !(armed >> i & 1))
            continue;
        for (uint32_t j = 0; j < event->count; j++) {
            const fp3_assignment *a = &model->assignments[event->first + j];
            fired |= is_other(states[a->state], values[a->expr]) ? FP3_FIRE_CHANGED : 0;
            states[a->state] = values[a->expr];
        }
        fired |= event->stops ? FP3_FIRE_STOPPED : 0;
    }
    return fired;
}
