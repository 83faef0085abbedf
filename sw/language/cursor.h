/* SPDX-License-Identifier: Apache-2.0 */
/* cursor.h - where a source is read: the next token, and what happens after an error.
 *
 * After a syntax error the cursor is lost: the next token is one that nothing accepts, and no
 * further error is reported until fp3_ode_recover finds the next statement. So a function that
 * reads may simply go on.
 */
#ifndef FP3_ODE_CURSOR_H
#define FP3_ODE_CURSOR_H

#include "base/report.h"
#include "lexer.h"

enum { FP3_NOTE_SIZE = 64 };

typedef struct {
    ode_lexer lexer;
    fp3_token next;
    fp3_report report;
    int is_lost;
    int is_quiet;             /* the same text is read again, and its error is reported */
    fp3_token lost_at;        /* the token of that error */
    int is_over;              /* a limit is reached: nothing more is read */
    char note[FP3_NOTE_SIZE]; /* "i = 3, j = 1": the indices, behind each error; "" without one */
} ode_cursor;

/* At the first token of a source; name is for the report. */
void fp3_ode_open(ode_cursor *cursor, const char *source, size_t size, const char *name);
void fp3_ode_advance(ode_cursor *cursor);
int fp3_ode_at(const ode_cursor *cursor, const char *symbol_or_word);
int fp3_ode_at_end(const ode_cursor *cursor); /* of a line or the file */
/* Steps over it if it is next. */
int fp3_ode_accept(ode_cursor *cursor, const char *symbol_or_word);
/* Steps over it, or is lost: the format says what is expected. */
__attribute__((format(printf, 3, 4))) void fp3_ode_expect(ode_cursor *cursor, const char *symbol,
                                                          const char *format, ...);

/* An error that does not stop the reading. Each says what is expected instead of the token. */
__attribute__((format(printf, 3, 4))) void fp3_ode_wrong(ode_cursor *cursor, fp3_token at,
                                                         const char *format, ...);
/* A syntax error at the next token: nothing more of this statement is read. */
__attribute__((format(printf, 2, 3))) void fp3_ode_lost(ode_cursor *cursor, const char *format,
                                                        ...);
/* The same at a token that has been read. */
__attribute__((format(printf, 3, 4))) void fp3_ode_lost_at(ode_cursor *cursor, fp3_token at,
                                                           const char *format, ...);
/* A limit is reached: nothing more of the source is read. */
__attribute__((format(printf, 3, 4))) void fp3_ode_over(ode_cursor *cursor, fp3_token at,
                                                        const char *format, ...);
/* Nothing more of this statement is read. The error at this token is reported already. */
void fp3_ode_give_up(ode_cursor *cursor, fp3_token at);
/* Goes from where the cursor was lost to the next statement. line is where the statement began that
 * could not be read. */
void fp3_ode_recover(ode_cursor *cursor, unsigned line);

#endif
