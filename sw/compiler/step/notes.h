/* SPDX-License-Identifier: Apache-2.0 */
/* notes.h - what each operation is for, in words: the comments of the assembly. */
#ifndef FP3_NOTES_H
#define FP3_NOTES_H

#include <fp3/model.h>

#define FP3_PLACE_SIZE 24

typedef struct {
    char *text;
    uint32_t line, column; /* of the expression that it is about; line 0: none */
} fp3_noted;

typedef struct {
    fp3_noted *list;
    uint32_t count, room;
    int is_on;      /* else every note is FP3_NONE */
    int has_failed; /* out of memory */
} fp3_notes;

void fp3_notes_close(fp3_notes *notes);

__attribute__((format(printf, 2, 3))) uint32_t fp3_note(fp3_notes *notes, const char *format, ...);
/* For an expression at this place ("k2"). FP3_NONE: it needs no words. */
uint32_t fp3_note_expr(fp3_notes *notes, const fp3_model *model, uint32_t expr, const char *place);

/* NULL: there is none. */
const char *fp3_note_text(const fp3_notes *notes, uint32_t note);

/* The same with its place; all zero, if there is none. */
fp3_noted fp3_note_at(const fp3_notes *notes, uint32_t note);

#endif
