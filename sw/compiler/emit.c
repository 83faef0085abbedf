/* SPDX-License-Identifier: Apache-2.0 */
/* emit.c - head, declarations, lines, comments. */
#include "emit.h"

#include "compiler/value/formula.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine/operation.h"

#define COMMENT_COLUMN 34
#define COMMENT_SIZE 256

static void put_declaration(FILE *out, const char *directive, const char *name,
                            const char *comment) {
    const int column = fprintf(out, "%-7s %s", directive, name);
    if (*comment)
        fprintf(out, "%*s# %s", column < 24 ? 24 - column : 1, "", comment);
    fputc('\n', out);
}

/* Bytes of a text up to a limit, where no character of UTF-8 is cut. */
static int room_for(const char *text, int limit) {
    int size = (int)strnlen(text, (size_t)limit + 1);
    if (size > limit)
        for (size = limit; size > 0 && ((unsigned char)text[size] & 0xc0) == 0x80;)
            size--;
    return size;
}

static void say_quantity(const fp3_quantity *q, char comment[COMMENT_SIZE]) {
    snprintf(comment, COMMENT_SIZE, "%.*s%s%s%.*s%s", room_for(q->doc, 120), q->doc,
             *q->doc && *q->dimension ? " " : "", *q->dimension ? "[" : "",
             room_for(q->dimension, 40), q->dimension, *q->dimension ? "]" : "");
}

static void put_state(const fp3_step *step, FILE *out, const variable *v, const char *name) {
    static const char *const meaning[] = {[ROLE_LOST] = "what updates of %s rounded away",
                                          [ROLE_BEFORE] = "%s one step ago",
                                          [ROLE_LOST_BEFORE] = "what was lost of %s one step ago",
                                          [ROLE_LOW] = "second word of %s",
                                          [ROLE_LOW_BEFORE] = "second word of %s one step ago"};
    char comment[COMMENT_SIZE];
    if (v->role == ROLE_STEPS) {
        put_declaration(out, ".state", name, "steps made: t is this times h");
        return;
    }
    if (v->role == ROLE_STOPPED) {
        put_declaration(out, ".state", name, "1: an event has stopped the object");
        return;
    }
    if (v->role == ROLE_SLEPT) {
        put_declaration(out, ".state", name, "the step after which the object sleeps; 0: awake");
        return;
    }
    const fp3_quantity *q = &step->model->states[v->state];
    if (v->role != ROLE_STATE) {
        const char *percent = strchr(meaning[v->role], '%');
        snprintf(comment, sizeof comment, "%.*s%s%s", (int)(percent - meaning[v->role]),
                 meaning[v->role], q->name, percent + 2);
    } else
        say_quantity(q, comment);
    put_declaration(out, ".state", name, comment);
}

static void put_kept(const fp3_step *step, FILE *out, const variable *v, const char *name) {
    if (v->next == FP3_NONE) { /* compiler/phases */
        put_declaration(out, ".temp", name, "from a part of the step to another");
        return;
    }
    const char *note = fp3_note_text(&step->notes, step->values.nodes[v->next].note);
    char comment[COMMENT_SIZE];
    snprintf(comment, sizeof comment, "for the next step, from %s", note ? note : "this one");
    put_declaration(out, ".temp", name, comment);
}

static void put_known(const fp3_step *step, FILE *out, const char *directive, uint32_t id,
                      const char *name) {
    const known *k = &step->known.list[id];
    char *text = fp3_formula_known(&step->known, id);
    char comment[COMMENT_SIZE] = "";
    if (k->op == KNOWN_MODEL && step->model->exprs[k->a].op == FP3_EXPR_PARAM) {
        const fp3_quantity *q = &step->model->params[step->model->exprs[k->a].index];
        say_quantity(q, comment);
    } else if (k->op == KNOWN_STEP)
        snprintf(comment, sizeof comment, "time step");
    else if (text)
        snprintf(comment, sizeof comment, "%s", text);
    put_declaration(out, directive, name, comment);
    free(text);
}

/* In the order of registers, as the assembler gives them out; each with its register if the number
 * of the register is its bank. */
static void put_declarations(const fp3_step *step, const conversion *c,
                             const fp3_schedule *schedule, const fp3_names *names, FILE *out) {
    for (uint32_t i = 0; i < schedule->registers; i++) {
        const fp3_ref of = fp3_code_owner(&c->code, i);
        char name[FP3_NAME_SIZE + 16];
        snprintf(name, sizeof name, c->code.param_registers ? "%s = r%" PRIu32 : "%s",
                 names->object[i], i);
        if (of.at == FP3_AT_VARIABLE && step->variables[of.index].role == ROLE_LIST)
            put_declaration(out, ".temp", name, "the list of neighbours");
        else if (of.at == FP3_AT_VARIABLE && step->variables[of.index].role == ROLE_WORST)
            put_declaration(out, ".worst", name, "of all objects");
        else if (of.at == FP3_AT_VARIABLE && step->variables[of.index].role != ROLE_CARRIED)
            put_state(step, out, &step->variables[of.index], name);
        else if (of.at == FP3_AT_VARIABLE)
            put_kept(step, out, &step->variables[of.index], name);
        else if (of.at == FP3_AT_PARAM)
            put_known(step, out, ".param", c->params[of.index], name);
        else if (*names->object[i])
            put_declaration(out, ".temp", name, "");
    }
    for (uint32_t i = 0; i < c->code.constant_count; i++)
        if (step->known.list[c->constants[i]].op != KNOWN_NUMBER)
            put_known(step, out, ".shared", c->constants[i], names->constant[i]);
}

static const char *operand_name(const fp3_names *names, uint32_t operand) {
    if (operand < FP3_BANK_SHARED_BASE)
        return names->object[operand];
    return names->constant[operand - FP3_BANK_SHARED_BASE];
}

static void put_line(const fp3_step *step, const fp3_names *names, const fp3_line *line,
                     FILE *out) {
    const fp3_operation *operation = fp3_operation_find(line->op);
    int column = fprintf(out, "    %-5s", operation->name);
    for (const char *letter = operation->operands; *letter; letter++) {
        const uint32_t operand = *letter == 'd' ? line->d : line->operand[*letter - 'a'];
        const char *comma = letter == operation->operands ? "" : ",";
        column += fp3_operation_counts(operation, *letter)
                      ? fprintf(out, "%s %" PRIu32, comma, operand)
                      : fprintf(out, "%s %s", comma, operand_name(names, operand));
    }
    const char *note = fp3_note_text(&step->notes, line->note);
    if (!fp3_operation_is_arithmetic(operation) && line->note == FP3_NONE_INDEX)
        note = line->op == FP3_OP_ST    ? "to its record"
               : operation->takes_field ? "to the entry"
                                        : "from its record";
    else if (line->from == FP3_NONE_INDEX)
        note = "a copy";
    if (note)
        fprintf(out, "%*s# %s%s", column < COMMENT_COLUMN ? COMMENT_COLUMN - column : 1, "", note,
                line->is_ahead ? " (of the next step)" : "");
    fputc('\n', out);
}

static void put_part(const fp3_step *step, const fp3_names *names, const char *label,
                     const fp3_line *lines, uint32_t count, FILE *out) {
    if (!count && strcmp(label, "step"))
        return;
    fprintf(out, "\n%s:\n", label);
    for (uint32_t i = 0; i < count; i++)
        put_line(step, names, &lines[i], out);
}

static void put_head(const fp3_step *step, const conversion *c, const fp3_schedule *schedule,
                     const fp3_options *options, const fp3_title *title, FILE *out) {
    const int is_plain = options->arithmetic == FP3_PLAIN;
    char words[FP3_WORDS_NAME_SIZE];
    fprintf(out, "# %s by %s%s%s, for configuration '%s'. Compiled by fp3.\n", step->model->name,
            title->integrator, is_plain ? "" : ", ",
            is_plain ? "" : fp3_arithmetic_of(options->arithmetic)->text, options->config->name);
    if (*step->model->doc)
        fprintf(out, "# %s\n", step->model->doc);
    fprintf(out, "#\n# Order %u. %" PRIu32 " operations in %" PRIu32 " instructions", title->order,
            c->operations, schedule->step_count);
    if (schedule->spills)
        fprintf(out, ", %" PRIu32 " of them loads and stores", schedule->spills);
    if (schedule->cycles > 0)
        fprintf(out, ", %.6g cycles per object-step (bound %.6g)", schedule->cycles,
                schedule->bound);
    fprintf(out, ".\n# Passes:");
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        if (fp3_has_pass(options, (fp3_pass)i))
            fprintf(out, " %s", fp3_pass_name((fp3_pass)i));
    fprintf(out, "\n\n");
    fprintf(out, ".words  %s\n", fp3_image_words_name(step->words, words));
}

fp3_status fp3_emit(const fp3_step *step, const conversion *c, const fp3_schedule *schedule,
                    const fp3_names *names, const fp3_options *options, const fp3_title *title,
                    char **text, fp3_error *error) {
    size_t size = 0;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return fp3_no_memory(error);
    put_head(step, c, schedule, options, title, out);
    put_declarations(step, c, schedule, names, out);
    put_part(step, names, "first", schedule->first, schedule->first_count, out);
    put_part(step, names, "step", schedule->step, schedule->step_count, out);
    put_part(step, names, "last", schedule->last, schedule->last_count, out);
    const int is_bad = ferror(out);
    if (fclose(out) || is_bad) {
        free(*text);
        *text = NULL;
        return fp3_no_memory(error);
    }
    return FP3_OK;
}
