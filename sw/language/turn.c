/* SPDX-License-Identifier: Apache-2.0 */
#include "turn.h"

int fp3_turn_can(fp3_expr_op op) {
    return op == FP3_EXPR_LESS || op == FP3_EXPR_LESS_EQUAL || op == FP3_EXPR_EQUAL ||
           op == FP3_EXPR_MIN || op == FP3_EXPR_MAX || op == FP3_EXPR_ABS;
}

static int is_linear(const fp3_model *model, const char *kind, const fp3_expr *e) {
    if (e->is_known || e->op == FP3_EXPR_TIME)
        return 1;
    const int a = e->operand[0] != FP3_NONE && kind[e->operand[0]] & FP3_TURN_LINEAR;
    const int b = e->operand[1] != FP3_NONE && kind[e->operand[1]] & FP3_TURN_LINEAR;
    switch (e->op) {
    case FP3_EXPR_NEGATE:
        return a;
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
        return a && b;
    case FP3_EXPR_MUL:
        return a && b &&
               (model->exprs[e->operand[0]].is_known || model->exprs[e->operand[1]].is_known);
    case FP3_EXPR_DIV:
        return a && model->exprs[e->operand[1]].is_known;
    default:
        return 0;
    }
}

void fp3_turn_kinds(const fp3_model *model, char *kind) {
    const int dependence = FP3_TURN_TIME | FP3_TURN_STATE;
    const int use = FP3_TURN_RATE | FP3_TURN_CONDITION;
    for (uint32_t i = 0; i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        int is = e->op == FP3_EXPR_TIME    ? FP3_TURN_TIME
                 : e->op == FP3_EXPR_STATE ? FP3_TURN_STATE
                                           : 0;
        for (int k = 0; k < 3; k++)
            if (e->operand[k] != FP3_NONE)
                is |= kind[e->operand[k]] & dependence;
        kind[i] = (char)(is | (is_linear(model, kind, e) ? FP3_TURN_LINEAR : 0));
    }
    for (uint32_t i = 0; i < model->state_count; i++)
        kind[model->states[i].derivative] |= FP3_TURN_RATE;
    for (uint32_t i = 0; i < model->event_count; i++) /* `armed` turns where the condition does */
        kind[model->events[i].condition] |= FP3_TURN_CONDITION;
    for (uint32_t i = model->expr_count; i-- > 0;)
        for (int k = 0; k < 3; k++)
            if (model->exprs[i].operand[k] != FP3_NONE)
                kind[model->exprs[i].operand[k]] |= kind[i] & use;
}

int fp3_turn_is_of_time(const fp3_model *model, const char *kind, uint32_t expr) {
    return fp3_turn_can(model->exprs[expr].op) &&
           (kind[expr] & (FP3_TURN_TIME | FP3_TURN_STATE)) == FP3_TURN_TIME;
}

int fp3_turn_is_linear(const fp3_model *model, const char *kind, uint32_t expr) {
    const fp3_expr *e = &model->exprs[expr];
    return fp3_turn_is_of_time(model, kind, expr) && kind[e->operand[0]] & FP3_TURN_LINEAR &&
           (e->op == FP3_EXPR_ABS || kind[e->operand[1]] & FP3_TURN_LINEAR);
}
