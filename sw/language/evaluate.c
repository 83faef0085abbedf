#include "evaluate.h"

#include <math.h>

unsigned fp3_ode_operands(fp3_expr_op op) {
    static const unsigned char operands[] = {
#define X(NAME, operands, host) operands,
        FP3_EXPR_OPS(X)
#undef X
    };
    return operands[op];
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
    case FP3_EXPR_SQRT:
        return sqrt(a);
    case FP3_EXPR_SIN:
        return sin(a);
    case FP3_EXPR_COS:
        return cos(a);
    case FP3_EXPR_MIN: /* like the instruction: b if one is a NaN */
        return a < b ? a : b;
    case FP3_EXPR_MAX:
        return b < a ? a : b;
    case FP3_EXPR_ABS:
        return fabs(a);
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
    case FP3_EXPR_SELECT:
        return a != 0 ? b : c;
    case FP3_EXPR_EXP:
        return exp(a);
    case FP3_EXPR_LOG:
        return log(a);
    case FP3_EXPR_TAN:
        return tan(a);
    case FP3_EXPR_ATAN:
        return atan(a);
    case FP3_EXPR_ASIN:
        return asin(a);
    case FP3_EXPR_ACOS:
        return acos(a);
    case FP3_EXPR_ATAN2:
        return atan2(a, b);
    case FP3_EXPR_SINH:
        return sinh(a);
    case FP3_EXPR_COSH:
        return cosh(a);
    case FP3_EXPR_TANH:
        return tanh(a);
    case FP3_EXPR_OP_COUNT:
        break;
    }
    return NAN;
}

void fp3_model_evaluate(const fp3_model *model, const fp3_point *point, double *values) {
    for (uint32_t i = 0; i < model->expr_count; i++)
        values[i] = fp3_ode_compute(&model->exprs[i], point, values);
}

static int is_other(double a, double b) { return a != b && !(isnan(a) && isnan(b)); }

int fp3_model_fire(const fp3_model *model, const double *params, double t, double *states,
                   double *values) {
    int has_changed = 0;
    for (uint32_t i = 0; i < model->event_count; i++) {
        const fp3_event *event = &model->events[i];
        fp3_model_evaluate(model, &(fp3_point){.states = states, .params = params, .t = t}, values);
        if (values[event->condition] == 0)
            continue;
        for (uint32_t j = 0; j < event->count; j++) {
            const fp3_assignment *a = &model->assignments[event->first + j];
            has_changed |= is_other(states[a->state], values[a->expr]);
            states[a->state] = values[a->expr];
        }
    }
    return has_changed;
}
