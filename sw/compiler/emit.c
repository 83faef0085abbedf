/* emit.c - names, declarations, lines, comments. */
#include "emit.h"

#include <fp3/asm.h>
#include <inttypes.h>
#include <isa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine/operation.h"

#define COMMENT_COLUMN 34
#define COMMENT_SIZE 256

/* ---- names ---- */

static int is_taken(const emit_names *names, const fp3_model *model, const char *name) {
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

/* `wanted`, or with a number behind it what nothing else is called. */
static void name_it(const emit_names *names, const fp3_model *model, const char *wanted,
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

static void wanted_name(const build *b, uint32_t id, const char *prefix,
                        char wanted[FP3_NAME_SIZE + 16]) {
    const known *k = &b->known.list[id];
    const known *below = k->op == KNOWN_DIV ? &b->known.list[k->b] : NULL;
    const fp3_model *model = b->model;
    const size_t size = FP3_NAME_SIZE + 16;
    if (k->op == KNOWN_STEP)
        snprintf(wanted, size, "h");
    else if (k->op == KNOWN_MODEL && model->exprs[k->a].op == FP3_EXPR_PARAM)
        snprintf(wanted, size, "%s", model->params[model->exprs[k->a].index].name);
    else if (k->op == KNOWN_MODEL && definition_name(model, k->a))
        snprintf(wanted, size, "%s", definition_name(model, k->a));
    else if (below && fp3_known_is(&b->known, k->a, 1) && below->op == KNOWN_STEP)
        snprintf(wanted, size, "over_h");
    else if (below && fp3_known_is(&b->known, k->a, 1) && below->op == KNOWN_MODEL &&
             model->exprs[below->a].op == FP3_EXPR_PARAM)
        snprintf(wanted, size, "over_%s", model->params[model->exprs[below->a].index].name);
    else
        snprintf(wanted, size, "%s%" PRIu32, prefix, id);
}

/* What the first operation that reads a constant is for. */
static const char *reader_of(const build *b, const fp3_step *step, uint32_t constant) {
    const fp3_op *parts[] = {step->first, step->step, step->last};
    const uint32_t counts[] = {step->first_count, step->step_count, step->last_count};
    for (int part = 0; part < 3; part++)
        for (uint32_t i = 0; i < counts[part]; i++) {
            const fp3_op *op = &parts[part][i];
            const fp3_ref *refs[] = {&op->a, &op->b, &op->c};
            for (int j = 0; j < 3; j++)
                if (refs[j]->at == FP3_AT_CONSTANT && refs[j]->index == constant &&
                    op->note < b->note_count)
                    return b->notes[op->note];
        }
    return "the model";
}

static fp3_status number_name(const build *b, const fp3_step *step, uint32_t constant,
                              double number, char name[FP3_NAME_SIZE], fp3_error *error) {
    const float f = (float)number;
    uint32_t bits;
    if (!isfinite(f))
        return fp3_fail(error, FP3_E_PROGRAM, "%s: found %.9g, expected a finite FP32 number",
                        reader_of(b, step, constant), number);
    memcpy(&bits, &f, sizeof bits);
    fp3_number_text(bits, name);
    return FP3_OK;
}

static void variable_name(const build *b, const emit_names *names, uint32_t i,
                          char name[FP3_NAME_SIZE]) {
    static const char *const suffix[] = {
        [ROLE_LOST] = "_lost", [ROLE_BEFORE] = "_before", [ROLE_LOST_BEFORE] = "_lost_before"};
    const variable *v = &b->variables[i];
    char wanted[FP3_NAME_SIZE + 16];
    if (v->role == ROLE_CARRIED)
        snprintf(wanted, sizeof wanted, "kept%" PRIu32, i);
    else
        snprintf(wanted, sizeof wanted, "%s%s", b->model->states[v->state].name, suffix[v->role]);
    name_it(names, b->model, wanted, name);
}

static fp3_status name_constants(const build *b, const conversion *c, emit_names *names,
                                 fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->step.constant_count; i++) {
        const uint32_t id = c->constants[i];
        char wanted[FP3_NAME_SIZE + 16], *name = names->constant[names->constant_count];
        wanted_name(b, id, "c", wanted);
        if (b->known.list[id].op == KNOWN_NUMBER)
            status = number_name(b, &c->step, i, b->known.list[id].number, name, error);
        else
            name_it(names, b->model, wanted, name);
        names->constant_count++;
    }
    if (!status) /* what copies add, if any */
        snprintf(names->constant[names->constant_count++], FP3_NAME_SIZE, "-0.0");
    return status;
}

fp3_status fp3_emit_names(const build *b, const conversion *c, const fp3_schedule *schedule,
                          emit_names *names, fp3_error *error) {
    *names = (emit_names){.object = calloc(schedule->registers + 1u, sizeof *names->object),
                          .constant = calloc(c->step.constant_count + 2u, sizeof *names->constant)};
    if (!names->object || !names->constant)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; i < schedule->registers; i++) {
        char *name = names->object[i], wanted[FP3_NAME_SIZE + 16];
        const uint32_t param = i - b->variable_count;
        if (i < b->variable_count && b->variables[i].role == ROLE_STATE)
            memcpy(name, b->model->states[b->variables[i].state].name, FP3_NAME_SIZE);
        else if (i < b->variable_count)
            variable_name(b, names, i, name);
        else if (param < c->step.param_count) {
            wanted_name(b, c->params[param], "p", wanted);
            name_it(names, b->model, wanted, name);
        } else {
            snprintf(wanted, sizeof wanted, "t%" PRIu32, param - c->step.param_count);
            name_it(names, b->model, wanted, name);
        }
        names->object_count++;
    }
    return name_constants(b, c, names, error);
}

void fp3_emit_names_close(emit_names *names) {
    free(names->object);
    free(names->constant);
    *names = (emit_names){0};
}

/* ---- text ---- */

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
             *q->doc && *q->unit ? " " : "", *q->unit ? "[" : "", room_for(q->unit, 40), q->unit,
             *q->unit ? "]" : "");
}

static void put_state(const build *b, FILE *out, const variable *v, const char *name) {
    static const char *const meaning[] = {[ROLE_LOST] = "what updates of %s rounded away",
                                          [ROLE_BEFORE] = "%s one step ago",
                                          [ROLE_LOST_BEFORE] = "what was lost of %s one step ago"};
    const fp3_quantity *q = &b->model->states[v->state];
    char comment[COMMENT_SIZE];
    if (v->role != ROLE_STATE) {
        const char *percent = strchr(meaning[v->role], '%');
        snprintf(comment, sizeof comment, "%.*s%s%s", (int)(percent - meaning[v->role]),
                 meaning[v->role], q->name, percent + 2);
    } else
        say_quantity(q, comment);
    put_declaration(out, ".state", name, comment);
}

static void put_kept(const build *b, FILE *out, const variable *v, const char *name) {
    const uint32_t note = b->g.nodes[v->next].note;
    char comment[COMMENT_SIZE];
    snprintf(comment, sizeof comment, "for the next step, from %s",
             note < b->note_count ? b->notes[note] : "this one");
    put_declaration(out, ".temp", name, comment);
}

static void put_known(const build *b, FILE *out, const char *directive, uint32_t id,
                      const char *name) {
    const known *k = &b->known.list[id];
    char *text = fp3_known_text(&b->known, id);
    char comment[COMMENT_SIZE] = "";
    if (k->op == KNOWN_MODEL && b->model->exprs[k->a].op == FP3_EXPR_PARAM) {
        const fp3_quantity *q = &b->model->params[b->model->exprs[k->a].index];
        say_quantity(q, comment);
    } else if (k->op == KNOWN_STEP)
        snprintf(comment, sizeof comment, "time step");
    else if (text)
        snprintf(comment, sizeof comment, "%s", text);
    put_declaration(out, directive, name, comment);
    free(text);
}

/* In the order of registers, as the assembler gives them out. */
static void put_declarations(const build *b, const conversion *c, const fp3_schedule *schedule,
                             const emit_names *names, FILE *out) {
    for (uint32_t i = 0; i < schedule->registers; i++) {
        const uint32_t param = i - b->variable_count;
        if (i < b->variable_count && b->variables[i].role != ROLE_CARRIED)
            put_state(b, out, &b->variables[i], names->object[i]);
        else if (i < b->variable_count)
            put_kept(b, out, &b->variables[i], names->object[i]);
        else if (param < c->step.param_count)
            put_known(b, out, ".param", c->params[param], names->object[i]);
        else
            put_declaration(out, ".temp", names->object[i], "");
    }
    for (uint32_t i = 0; i < c->step.constant_count; i++)
        if (b->known.list[c->constants[i]].op != KNOWN_NUMBER)
            put_known(b, out, ".shared", c->constants[i], names->constant[i]);
}

static const char *name_of(const emit_names *names, uint32_t operand) {
    if (operand < FP3_BANK_SHARED_BASE)
        return names->object[operand];
    return names->constant[operand - FP3_BANK_SHARED_BASE];
}

static void put_line(const build *b, const emit_names *names, const fp3_line *line, FILE *out) {
    const fp3_operation *operation = fp3_operation_find(line->op);
    int column = fprintf(out, "    %-5s", operation->name);
    for (const char *letter = operation->operands; *letter; letter++) {
        const uint32_t operand = *letter == 'd' ? line->d : line->operand[*letter - 'a'];
        column += fprintf(out, "%s %s", letter == operation->operands ? "" : ",",
                          name_of(names, operand));
    }
    const char *note = line->note < b->note_count ? b->notes[line->note] : NULL;
    if (line->from == FP3_NONE_INDEX)
        note = "a copy";
    if (note)
        fprintf(out, "%*s# %s%s", column < COMMENT_COLUMN ? COMMENT_COLUMN - column : 1, "", note,
                line->is_ahead ? " (of the next step)" : "");
    fputc('\n', out);
}

static void put_part(const build *b, const emit_names *names, const char *label,
                     const fp3_line *lines, uint32_t count, FILE *out) {
    if (!count && strcmp(label, "step"))
        return;
    fprintf(out, "\n%s:\n", label);
    for (uint32_t i = 0; i < count; i++)
        put_line(b, names, &lines[i], out);
}

fp3_status fp3_emit(const build *b, const conversion *c, const fp3_schedule *schedule,
                    const emit_names *names, const char *head, char **text, fp3_error *error) {
    size_t size = 0;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    fprintf(out, "%s\n", head);
    put_declarations(b, c, schedule, names, out);
    put_part(b, names, "first", schedule->first, schedule->first_count, out);
    put_part(b, names, "step", schedule->step, schedule->step_count, out);
    put_part(b, names, "last", schedule->last, schedule->last_count, out);
    const int is_bad = ferror(out);
    if (fclose(out) || is_bad) {
        free(*text);
        *text = NULL;
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    return FP3_OK;
}
