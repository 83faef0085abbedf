/* SPDX-License-Identifier: Apache-2.0 */
/* names.c - registers and constants by names that stand once. */
#include "names.h"
#include "base/bits.h"

#include <fp3/image.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"

static int is_taken(const fp3_names *names, const fp3_model *model, const char *name) {
    for (uint32_t i = 0; i < names->object_count; i++)
        if (strcmp(names->object[i], name) == 0)
            return 1;
    for (uint32_t i = 0; i < names->constant_count; i++)
        if (strcmp(names->constant[i], name) == 0)
            return 1;
    for (uint32_t i = 0; i < model->state_count; i++)
        if (strcmp(model->states[i].name, name) == 0)
            return 1;
    return 0;
}

/* `wanted`, or that with a number behind it, so that nothing else has the name. */
static void name_it(const fp3_names *names, const fp3_model *model, const char *wanted,
                    char name[FP3_NAME_SIZE]) {
    char made[FP3_NAME_SIZE];
    snprintf(made, sizeof made, "%.*s", FP3_NAME_SIZE - 6, wanted);
    if (fp3_name_valid(wanted))
        snprintf(made, sizeof made, "%s", wanted);
    for (unsigned i = 2; is_taken(names, model, made); i++)
        snprintf(made, sizeof made, "%.*s%u", FP3_NAME_SIZE - 6, wanted, i % 100000);
    memcpy(name, made, sizeof made);
}

static const char *definition_name(const fp3_model *model, uint32_t expr) {
    for (uint32_t i = 0; i < model->definition_count; i++)
        if (model->definitions[i].expr == expr)
            return model->definitions[i].name;
    return NULL;
}

static void name_of_value(const fp3_step *step, uint32_t id, const char *prefix,
                          char wanted[FP3_NAME_SIZE + 16]) {
    const known *k = &step->known.list[id];
    const known *below = k->op == KNOWN_DIV ? &step->known.list[k->b] : NULL;
    const fp3_model *model = step->model;
    const size_t size = FP3_NAME_SIZE + 16;
    if (k->op == KNOWN_STEP)
        snprintf(wanted, size, "h");
    else if (k->op == KNOWN_MODEL && model->exprs[k->a].op == FP3_EXPR_PARAM)
        snprintf(wanted, size, "%s", model->params[model->exprs[k->a].index].name);
    else if (k->op == KNOWN_MODEL && definition_name(model, k->a))
        snprintf(wanted, size, "%s", definition_name(model, k->a));
    else if (below && fp3_known_is(&step->known, k->a, 1) && below->op == KNOWN_STEP)
        snprintf(wanted, size, "over_h");
    else if (below && fp3_known_is(&step->known, k->a, 1) && below->op == KNOWN_MODEL &&
             model->exprs[below->a].op == FP3_EXPR_PARAM)
        snprintf(wanted, size, "over_%s", model->params[model->exprs[below->a].index].name);
    else
        snprintf(wanted, size, "%s%" PRIu32, prefix, id);
}

/* A word of a pair, or a half of one, is called after the value. */
static void wanted_name(const fp3_step *step, uint32_t id, const char *prefix,
                        char wanted[FP3_NAME_SIZE + 16]) {
    const known *k = &step->known.list[id];
    name_of_value(step, k->op >= KNOWN_LOW ? k->a : id, prefix, wanted);
    const size_t length = strnlen(wanted, FP3_NAME_SIZE - 7);
    if (k->op >= KNOWN_LOW)
        strcpy(wanted + length, k->op == KNOWN_LOW    ? "_low"
                                : k->op == KNOWN_HEAD ? "_head"
                                                      : "_tail");
}

/* What the first operation that reads a constant is for. */
static uint32_t reader_of(const fp3_step *step, const fp3_step_code *code, uint32_t constant) {
    const fp3_op *parts[] = {code->first, code->step, code->last};
    const uint32_t counts[] = {code->first_count, code->step_count, code->last_count};
    for (int part = 0; part < 3; part++)
        for (uint32_t i = 0; i < counts[part]; i++) {
            const fp3_op *op = &parts[part][i];
            const fp3_ref *refs[] = {&op->a, &op->b, &op->c};
            for (int j = 0; j < 3; j++)
                if (refs[j]->at == FP3_AT_CONSTANT && refs[j]->index == constant &&
                    fp3_note_text(&step->notes, op->note))
                    return op->note;
        }
    return FP3_NONE;
}

static fp3_status number_name(const fp3_step *step, const fp3_step_code *code, uint32_t constant,
                              double number, char name[FP3_NAME_SIZE], fp3_error *error) {
    float f;
    const char *expected = fp3_number_single(number, &f);
    if (!expected && !isfinite(f))
        expected = "a finite number";
    if (expected) {
        const uint32_t note = reader_of(step, code, constant);
        const fp3_noted at = fp3_note_at(&step->notes, note);
        return fp3_fail_at(error, FP3_E_PROGRAM, NULL, at.line, at.column,
                           "%s: found %.9g, expected %s", at.text ? at.text : "the model", number,
                           expected);
    }
    fp3_number_text(fp3_bits_of(f), name);
    return FP3_OK;
}

static void variable_name(const fp3_step *step, const fp3_names *names, uint32_t i,
                          char name[FP3_NAME_SIZE]) {
    static const char *const suffix[] = {[ROLE_LOST] = "_lost",
                                         [ROLE_BEFORE] = "_before",
                                         [ROLE_LOST_BEFORE] = "_lost_before",
                                         [ROLE_LOW] = "_low",
                                         [ROLE_LOW_BEFORE] = "_low_before"};
    static const char *const compared[FP3_COMPARISONS] = {
        [FP3_COMPARED_LIMIT] = "limit",   [FP3_COMPARED_ERROR] = "error",
        [FP3_COMPARED_AHEAD] = "ahead",   [FP3_COMPARED_LATE] = "late",
        [FP3_COMPARED_BEGINS] = "begins", [FP3_COMPARED_FROM] = "from",
        [FP3_COMPARED_TO] = "to"};
    const variable *v = &step->variables[i];
    char wanted[FP3_NAME_SIZE + 16];
    if (v->role == ROLE_STEPS)
        snprintf(wanted, sizeof wanted, "%s", FP3_NAME_STEPS);
    else if (v->role == ROLE_SLEPT)
        snprintf(wanted, sizeof wanted, "slept");
    else if (v->role == ROLE_STOPPED)
        snprintf(wanted, sizeof wanted, "stopped");
    else if (v->role == ROLE_CARRIED)
        snprintf(wanted, sizeof wanted, "kept%" PRIu32, i);
    else if (v->role == ROLE_WORST)
        snprintf(wanted, sizeof wanted, "worst_%s", compared[v->state]);
    else if (v->role == ROLE_LIST)
        snprintf(wanted, sizeof wanted, "%s", step->model->relations[v->state].name);
    else
        snprintf(wanted, sizeof wanted, "%s%s", step->model->states[v->state].name,
                 suffix[v->role]);
    name_it(names, step->model, wanted, name);
}

static fp3_status name_constants(const fp3_step *step, const conversion *c, fp3_names *names,
                                 fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->code.constant_count; i++) {
        const uint32_t id = c->constants[i];
        char wanted[FP3_NAME_SIZE + 16], *name = names->constant[names->constant_count];
        wanted_name(step, id, "c", wanted);
        if (step->known.list[id].op == KNOWN_NUMBER)
            status = number_name(step, &c->code, i, step->known.list[id].number, name, error);
        else
            name_it(names, step->model, wanted, name);
        names->constant_count++;
    }
    if (!status) /* what copies add, if any */
        snprintf(names->constant[names->constant_count++], FP3_NAME_SIZE, "-0.0");
    return status;
}

/* Whether any line writes it. */
static int is_written(const fp3_schedule *s, uint32_t reg) {
    const fp3_line *const parts[] = {s->first, s->step, s->last};
    const uint32_t counts[] = {s->first_count, s->step_count, s->last_count};
    for (int part = 0; part < 3; part++)
        for (uint32_t i = 0; i < counts[part]; i++)
            if (parts[part][i].d == reg)
                return 1;
    return 0;
}

fp3_status fp3_names_make(const fp3_step *step, const conversion *c, const fp3_schedule *schedule,
                          fp3_names *names, fp3_error *error) {
    *names = (fp3_names){.object = calloc(schedule->registers + 1u, sizeof *names->object),
                         .constant = calloc(c->code.constant_count + 2u, sizeof *names->constant)};
    if (!names->object || !names->constant)
        return fp3_no_memory(error);
    uint32_t temps = 0;
    for (uint32_t i = 0; i < schedule->registers; i++) {
        char *name = names->object[i], wanted[FP3_NAME_SIZE + 16];
        const fp3_ref of = fp3_code_owner(&c->code, i);
        if (of.at == FP3_AT_VARIABLE && step->variables[of.index].role == ROLE_STATE)
            memcpy(name, step->model->states[step->variables[of.index].state].name, FP3_NAME_SIZE);
        else if (of.at == FP3_AT_VARIABLE)
            variable_name(step, names, of.index, name);
        else if (of.at == FP3_AT_PARAM) {
            wanted_name(step, c->params[of.index], "p", wanted);
            name_it(names, step->model, wanted, name);
        } else if (is_written(schedule,
                              i)) { /* there may be gaps where sums and products are apart */
            snprintf(wanted, sizeof wanted, "t%" PRIu32, temps++);
            name_it(names, step->model, wanted, name);
        }
        names->object_count++;
    }
    return name_constants(step, c, names, error);
}

void fp3_names_close(fp3_names *names) {
    free(names->object);
    free(names->constant);
    *names = (fp3_names){0};
}
