/* SPDX-License-Identifier: Apache-2.0 */
/* range.h - "i in 1..4", a name for each whole number from 1 to 4: what is read again for each of
 * them. expression.h reads ranges. */
#ifndef FP3_ODE_RANGE_H
#define FP3_ODE_RANGE_H

#include "parser.h"

typedef struct {
    fp3_token name;
    uint32_t symbol; /* FP3_NONE: its name cannot be one */
    long value, last;
    int is_good;  /* 0: the range is wrong, or skipped: of no number */
    int is_quiet; /* before it */
    unsigned passes, skips, errors;
    size_t note_length;
    ode_lexer lexer; /* behind "1..4" */
    fp3_token next;
} ode_range;

/* Whether one is next: a name and `in`. */
int fp3_ode_at_range(const ode_parser *p);
/* Where both ends have been read; is_range: they are good. */
void fp3_ode_range_begin(ode_parser *p, fp3_token name, ode_range *range, int is_range, long first,
                         long last);
/* Goes to where the text for the next number begins. 0: that was the last one, or there was an
 * error. */
int fp3_ode_range_next(ode_parser *p, ode_range *range);
/* The text that follows does not count. */
void fp3_ode_range_skip(ode_parser *p, ode_range *range);

#endif
