/* SPDX-License-Identifier: Apache-2.0 */
/* range.c - the text of a range is read as often as the range has numbers: each time its index
 * stands for the next one. */
#include "range.h"

#include <stdio.h>
#include <string.h>

#include "symbol.h"

int fp3_ode_at_range(const ode_parser *p) {
    ode_lexer ahead = p->in.lexer;
    return p->in.next.kind == FP3_TOKEN_NAME && fp3_token_is(fp3_ode_next(&ahead), "in");
}

void fp3_ode_range_begin(ode_parser *p, fp3_token name, ode_range *r, int is_range, long first,
                         long last) {
    const int is_new = fp3_ode_is_new_name(p, name, 1);
    *r = (ode_range){.name = name,
                     .symbol = FP3_NONE,
                     .value = first,
                     .last = last,
                     .is_good = is_range && is_new && !p->skipping,
                     .is_quiet = p->in.is_quiet,
                     .errors = p->in.report.count,
                     .note_length = strlen(p->in.note),
                     .lexer = p->in.lexer,
                     .next = p->in.next};
    if (p->index_count == ODE_INDICES)
        fp3_ode_over(&p->in, name, "at most %d indices, one within the other", ODE_INDICES);
    else if (is_new)
        r->symbol = fp3_ode_declare(p, name, ODE_INDEX, 0, (ode_value){.size = 1});
    p->index_count++;
}

static int close(ode_parser *p, const ode_range *r) {
    if (r->symbol != FP3_NONE)
        fp3_ode_undeclare(p, r->symbol);
    p->index_count--;
    p->in.is_quiet = r->is_quiet;
    p->in.note[r->note_length] = 0;
    return 0;
}

static void set_index(ode_parser *p, const ode_range *r) {
    if (r->symbol != FP3_NONE)
        p->symbols[r->symbol].number = r->value;
    snprintf(p->in.note + r->note_length, sizeof p->in.note - r->note_length, "%s%.*s = %ld",
             r->note_length ? ", " : "", (int)r->name.length, r->name.text, r->value);
}

/* From the end of a pass back to where the next one begins. 0: there is none. */
static int is_again(ode_parser *p, ode_range *r) {
    p->skipping -= r->skips;
    r->skips = 0;
    if (p->in.is_lost || !r->is_good || r->value >= r->last)
        return 0;
    if (p->in.report.count > r->errors)
        p->in.is_quiet = 1;
    p->repeated += (size_t)(p->in.next.text - r->next.text);
    if (p->repeated > ODE_REPEATED) {
        fp3_ode_over(&p->in, r->name, "sums and equations that repeat at most %d bytes of text",
                     ODE_REPEATED);
        return 0;
    }
    r->value++;
    p->in.lexer = r->lexer;
    p->in.next = r->next;
    return 1;
}

int fp3_ode_range_next(ode_parser *p, ode_range *r) {
    if (r->passes++ && !is_again(p, r))
        return close(p, r);
    if (!r->is_good || r->value > r->last)
        fp3_ode_range_skip(p, r);
    else
        set_index(p, r);
    return 1;
}

void fp3_ode_range_skip(ode_parser *p, ode_range *r) {
    p->skipping++;
    r->skips++;
}
