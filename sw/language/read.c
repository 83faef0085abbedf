/* SPDX-License-Identifier: Apache-2.0 */
/* read.c - sources become models, and constant expressions numbers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/host.h"
#include "base/number.h"
#include "constant.h"
#include "finish.h"
#include "function.h"
#include "keyword.h"
#include "repeat.h"
#include "statement.h"
#include "symbol.h"

enum { DEFAULT_STEPS = 1000 }; /* in the span of a model that does not say it */

static const char name_bytes[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

/* The name of a model that does not say it: that of its file. */
static void default_name(const char *path, char name[FP3_NAME_SIZE]) {
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    size_t length = strcspn(base, ".");
    if (length > FP3_NAME_SIZE - 2)
        length = FP3_NAME_SIZE - 2;
    memset(name, 0, FP3_NAME_SIZE);
    for (size_t i = 0; i < length; i++)
        name[i] = strchr(name_bytes, base[i]) ? base[i] : '_';
    if (fp3_name_valid(name))
        return;
    memmove(name + 1, name, length);
    name[0] = '_';
}

/* A copy of an array, with room for at least one element; NULL when out of memory. */
static void *copy(const void *array, uint32_t count, size_t element) {
    void *made = calloc((size_t)count + 1, element);
    if (made)
        memcpy(made, array, count * element);
    return made;
}

static fp3_quantity *take_quantities(ode_quantity *from, uint32_t count) {
    fp3_quantity *made = calloc((size_t)count + 1, sizeof *made);
    for (uint32_t i = 0; made && i < count; i++) {
        made[i] = from[i].quantity;
        from[i].quantity.dimension = from[i].quantity.doc = NULL;
    }
    return made;
}

static fp3_event *take_events(const ode_event *events, uint32_t count) {
    fp3_event *made = calloc(count + 1u, sizeof *made);
    for (uint32_t i = 0; made && i < count; i++) {
        const ode_event *e = &events[i];
        made[i] =
            (fp3_event){e->condition, e->first, e->count, e->at.location.line, e->armed, e->stops};
    }
    return made;
}

static fp3_assignment *take_assignments(const ode_parser *p) {
    fp3_assignment *made = calloc(p->assignment_count + 1u, sizeof *made);
    for (uint32_t i = 0; made && i < p->assignment_count; i++)
        made[i] = (fp3_assignment){p->assignments[i].state, p->assignments[i].to.expr};
    return made;
}

static fp3_memory *take_memories(const ode_parser *p) {
    fp3_memory *made = calloc(p->memory_count + 1u, sizeof *made);
    for (uint32_t i = 0; made && i < p->memory_count; i++) {
        const ode_memory *m = &p->memories[i];
        made[i] = (fp3_memory){m->relation, m->field, m->to.expr, m->to.at.location.line};
    }
    return made;
}

static fp3_model *take_model(ode_parser *p, const char *path) {
    fp3_model *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    memcpy(m->name, p->model_name, sizeof m->name);
    if (!fp3_token_exists(p->model_at))
        default_name(path, m->name);
    m->doc = p->model_doc ? p->model_doc : calloc(1, 1);
    p->model_doc = NULL;
    memcpy(m->time_unit, p->time_unit, sizeof m->time_unit);
    m->step = p->step.value;
    m->span = fp3_token_exists(p->span.at) ? p->span.value : DEFAULT_STEPS * m->step;
    m->state_count = p->state_count;
    m->param_count = p->param_count;
    m->definition_count = p->definition_count;
    m->invariant_count = p->invariant_count;
    m->group_invariant_count = p->group_invariant_count;
    m->expr_count = p->expr_count;
    m->states = take_quantities(p->states, p->state_count);
    m->params = take_quantities(p->params, p->param_count);
    m->definitions = copy(p->definitions, p->definition_count, sizeof *p->definitions);
    m->invariants = copy(p->invariants, p->invariant_count, sizeof *p->invariants);
    m->group_invariants =
        copy(p->group_invariants, p->group_invariant_count, sizeof *p->group_invariants);
    m->events = take_events(p->events, p->event_count);
    m->projections = take_events(p->projections, p->projection_count);
    m->projection_count = p->projection_count;
    m->repeats = copy(p->repeats, p->repeat_count, sizeof *p->repeats);
    m->repeat_count = p->repeat_count;
    m->assignments = take_assignments(p);
    m->event_count = p->event_count;
    m->assignment_count = p->assignment_count;
    m->exprs = copy(p->exprs, p->expr_count, sizeof *p->exprs);
    m->relations = copy(p->relations, p->relation_count, sizeof *p->relations);
    m->fields = take_quantities(p->fields, p->field_count);
    m->relation_count = p->relation_count;
    m->field_count = p->field_count;
    m->memories = take_memories(p);
    m->memory_count = p->memory_count;
    m->kinds = copy(p->kinds, p->kind_count, sizeof *p->kinds);
    m->kind_count = p->kind_count;
    if (!m->doc || !m->states || !m->params || !m->definitions || !m->invariants || !m->events ||
        !m->projections || !m->assignments || !m->exprs || !m->relations || !m->fields ||
        !m->memories || !m->kinds || !m->repeats || !m->group_invariants)
        fp3_model_free(&m);
    return m;
}

static void free_texts(ode_quantity *quantities, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        free(quantities[i].quantity.dimension);
        free(quantities[i].quantity.doc);
    }
}

static void free_parser(ode_parser *p) {
    free_texts(p->states, p->state_count);
    free_texts(p->params, p->param_count);
    free_texts(p->fields, p->field_count);
    free(p->model_doc);
    free(p);
}

static fp3_status take_result(ode_parser *p, const char *name, fp3_model **model, char **report,
                              fp3_error *error) {
    if (!p->out_of_memory && p->in.report.count > 0) {
        return fp3_report_fail(&p->in.report, report, error);
    } else if (!p->out_of_memory && (*model = take_model(p, name))) {
        return FP3_OK;
    }
    return fp3_no_memory(error);
}

static fp3_status too_long(const char *name, size_t size, char **report, fp3_error *error) {
    fp3_error made;
    char path[201];
    snprintf(path, sizeof path, "%s", name);
    fp3_fail_at(&made, FP3_E_PROGRAM, path, 1, 1, "found %zu bytes, expected at most %d", size,
                ODE_SOURCE_MAX);
    size_t length = strlen(made.text);
    *report = calloc(length + 2, 1);
    if (!*report)
        return fp3_no_memory(error);
    memcpy(*report, made.text, length);
    (*report)[length] = '\n';
    if (error)
        *error = made;
    return FP3_E_PROGRAM;
}

static void parse(ode_parser *p) {
    while (p->in.next.kind != FP3_TOKEN_END_OF_FILE && !fp3_report_full(&p->in.report)) {
        if (fp3_ode_at_end(&p->in)) {
            fp3_ode_advance(&p->in);
            continue;
        }
        const unsigned line = p->in.next.location.line;
        fp3_ode_statement(p);
        if (p->in.is_over)
            return;
        if (p->in.is_lost)
            fp3_ode_recover(&p->in, line);
    }
    if (fp3_report_full(&p->in.report))
        return;
    fp3_ode_repeat_check(p);
    fp3_ode_finish(p);
}

fp3_status fp3_model_read(const char *source, size_t size, const char *name, fp3_model **model,
                          char **report, fp3_error *error) {
    *model = NULL;
    *report = NULL;
    if (size > ODE_SOURCE_MAX)
        return too_long(name, size, report, error);
    ode_parser *p = fp3_ode_make();
    if (!p)
        return fp3_no_memory(error);
    FP3_HOST;
    fp3_ode_open(&p->in, source, size, name);
    parse(p);
    fp3_status status = take_result(p, name, model, report, error);
    free_parser(p);
    return status;
}

fp3_status fp3_model_load(const char *path, fp3_model **model, char **report, fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    *model = NULL;
    *report = NULL;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (!status)
        status = fp3_model_read(text, size, path, model, report, error);
    free(text);
    return status;
}
