/* SPDX-License-Identifier: Apache-2.0 */
/* notes.c - a list of lines. */
#include "notes.h"

#include "compiler/value/formula.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void fp3_notes_close(fp3_notes *notes) {
    for (uint32_t i = 0; i < notes->count; i++)
        free(notes->list[i].text);
    free(notes->list);
    *notes = (fp3_notes){0};
}

uint32_t fp3_note(fp3_notes *notes, const char *format, ...) {
    if (!notes->is_on)
        return FP3_NONE;
    if (notes->count == notes->room) {
        const uint32_t room = notes->room ? 2 * notes->room : 64;
        fp3_noted *list = realloc(notes->list, room * sizeof *list);
        if (!list) {
            notes->has_failed = 1;
            return FP3_NONE;
        }
        notes->list = list;
        notes->room = room;
    }
    va_list arguments;
    va_start(arguments, format);
    notes->list[notes->count] = (fp3_noted){0};
    if (vasprintf(&notes->list[notes->count].text, format, arguments) < 0) {
        notes->list[notes->count].text = NULL;
        notes->has_failed = 1;
    }
    va_end(arguments);
    return notes->count++;
}

/* What an expression is the value of: "v'", the name of a definition, or nothing. */
static const char *subject_of(const fp3_model *model, uint32_t expr, const char **tick) {
    *tick = "'";
    for (uint32_t i = 0; i < model->state_count; i++)
        if (model->states[i].derivative == expr)
            return model->states[i].name;
    *tick = "";
    for (uint32_t i = 0; i < model->definition_count; i++)
        if (model->definitions[i].expr == expr)
            return model->definitions[i].name;
    return NULL;
}

uint32_t fp3_note_expr(fp3_notes *notes, const fp3_model *model, uint32_t expr, const char *place) {
    const fp3_expr *e = &model->exprs[expr];
    if (!notes->is_on || e->is_known || e->op == FP3_EXPR_STATE || e->op == FP3_EXPR_TIME ||
        e->op == FP3_EXPR_STEP || e->op == FP3_EXPR_BEFORE)
        return FP3_NONE;
    char *text = fp3_formula_expr(model, expr);
    if (!text) {
        notes->has_failed = 1;
        return FP3_NONE;
    }
    const char *tick, *of = subject_of(model, expr, &tick);
    const uint32_t made =
        fp3_note(notes, "%s: %s%s%s%s", place, of ? of : "", tick, of ? " = " : "", text);
    free(text);
    if (made != FP3_NONE) {
        notes->list[made].line = model->exprs[expr].line;
        notes->list[made].column = model->exprs[expr].column;
    }
    return made;
}

const char *fp3_note_text(const fp3_notes *notes, uint32_t note) {
    return note < notes->count ? notes->list[note].text : NULL;
}

fp3_noted fp3_note_at(const fp3_notes *notes, uint32_t note) {
    return note < notes->count ? notes->list[note] : (fp3_noted){0};
}
