/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_steps.c - see kinds_steps.h. */
#include "kinds_steps.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

fp3_status fp3_kinds_refuse(const fp3_joined *group, uint32_t line, fp3_error *error,
                            const char *format, ...) {
    char text[256];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return fp3_fail_at(error, FP3_E_PROGRAM, group->program->source, line, 0, "group '%s': %s",
                       group->name, text);
}

int fp3_kinds_never_move(const fp3_model *m) {
    int is = !m->event_count && !m->projection_count && !m->relation_count;
    for (uint32_t i = 0; is && i < m->state_count; i++) {
        const fp3_expr *e = &m->exprs[m->states[i].derivative];
        is = e->op == FP3_EXPR_NUMBER && e->number == 0;
    }
    return is;
}

/* Tables of one name may be of different files. */
static int is_same_method(const fp3_integrator *a, const fp3_integrator *b) {
    return a->kind == b->kind && a->stages == b->stages && memcmp(a->a, b->a, sizeof a->a) == 0 &&
           memcmp(a->b, b->b, sizeof a->b) == 0 && memcmp(a->c, b->c, sizeof a->c) == 0 &&
           memcmp(a->substeps, b->substeps, sizeof a->substeps) == 0 &&
           memcmp(&a->recurrence, &b->recurrence, sizeof a->recurrence) == 0;
}

static const char *steps_of(const fp3_model *model) {
    return fp3_model_adapted(model) == FP3_NONE ? "makes steps of one length"
           : fp3_model_chooses_steps(model)     ? "chooses its steps by a tolerance"
                                                : "makes steps of one length up to events";
}

/* A group that never moves may make any. */
static fp3_status check_adaptive(const fp3_joined *g, uint32_t line, const fp3_joined *other,
                                 fp3_error *error) {
    const fp3_model *a = g->program->model, *b = other->program->model;
    const char *own = steps_of(a), *theirs = steps_of(b);
    return own == theirs || fp3_kinds_never_move(a) || fp3_kinds_never_move(b)
               ? FP3_OK
               : fp3_kinds_refuse(g, line, error,
                                  "it %s, and group '%s' %s: groups make the same steps, so give "
                                  "each a tolerance and an `until`, or `until` alone",
                                  own, other->name, theirs);
}

fp3_status fp3_kinds_check_steps(const fp3_joined *g, uint32_t line, const fp3_joined *other,
                                 fp3_error *error) {
    const fp3_program *a = g->program, *b = other->program;
    const int is_double = a->compiled->arithmetic == FP3_DOUBLE_SINGLE;
    const fp3_status status = check_adaptive(g, line, other, error);
    if (status)
        return status;
    if (is_double != (b->compiled->arithmetic == FP3_DOUBLE_SINGLE))
        return fp3_kinds_refuse(g, line, error,
                                "group '%s' is in double-single, and group '%s' is not: kinds that "
                                "see each other have words of one form",
                                is_double ? g->name : other->name,
                                is_double ? other->name : g->name);
    return is_same_method(a->integrator, b->integrator) || fp3_kinds_never_move(b->model)
               ? FP3_OK
               : fp3_kinds_refuse(g, line, error,
                                  "it steps by '%s', and group '%s' by '%s': kinds that see each "
                                  "other step by one method, since a stage of one needs the others "
                                  "at the same stage",
                                  a->integrator->name, other->name, b->integrator->name);
}

fp3_status fp3_kinds_check_all(const fp3_joined *list, size_t count, fp3_error *error) {
    const fp3_joined *first = NULL;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !first && i < count; i++)
        if (list[i].program->model && fp3_model_adapted(list[i].program->model) != FP3_NONE)
            first = &list[i];
    for (size_t i = 0; first && !status && i < count; i++)
        status = list[i].program->model
                     ? check_adaptive(&list[i], 0, first, error)
                     : fp3_kinds_refuse(first, 0, error,
                                        "its steps are not of one length, and beside it is a "
                                        "program that is no model: groups make the same steps");
    return status;
}
