/* SPDX-License-Identifier: Apache-2.0 */
#include "repeat.h"

#include "expression.h"

/* Both words are names as well: what follows tells. */
static int is_begin(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "repeat") && !fp3_ode_at(&p->in, "=") && !fp3_ode_at(&p->in, "'") &&
           !fp3_ode_at(&p->in, "''") && !fp3_ode_at(&p->in, "[");
}

static int is_end(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "end") && fp3_ode_at_end(&p->in);
}

int fp3_ode_is_repeat(const ode_parser *p, fp3_token first) {
    return is_begin(p, first) || is_end(p, first);
}

static void begin(ode_parser *p, fp3_token keyword) {
    const fp3_token at = p->in.next;
    long times = 0;
    const int is_open = fp3_token_exists(p->repeat_at);
    if (is_open)
        fp3_ode_wrong(&p->in, keyword, "`end` first (line %u has a `repeat`)",
                      p->repeat_at.location.line);
    if (!fp3_ode_whole(p, &times))
        return;
    if (times < 1 || times > FP3_REPEAT_MAX)
        fp3_ode_wrong(&p->in, at, "a number of times from 1 to %d", FP3_REPEAT_MAX);
    if (is_open || p->in.is_over)
        return;
    p->repeat_at = keyword;
    p->repeats[p->repeat_count] = (fp3_repeat){
        .first = p->projection_count, .times = (uint32_t)times, .line = keyword.location.line};
}

static void end(ode_parser *p, fp3_token keyword) {
    fp3_repeat *r = &p->repeats[p->repeat_count];
    if (!fp3_token_exists(p->repeat_at)) {
        fp3_ode_wrong(&p->in, keyword, "a `repeat` before it");
        return;
    }
    r->count = p->projection_count - r->first;
    if (!r->count)
        fp3_ode_wrong(&p->in, keyword, "a projection between `repeat` and `end`");
    else
        p->repeat_count++; /* there are no more than projections */
    p->repeat_at = (fp3_token){0};
}

void fp3_ode_repeat(ode_parser *p, fp3_token first) {
    if (is_end(p, first))
        end(p, first);
    else
        begin(p, first);
}

int fp3_ode_may_repeat(ode_parser *p, fp3_token first) {
    if (!fp3_token_exists(p->repeat_at) || fp3_token_is(first, "project") ||
        fp3_token_is(first, "for") || fp3_ode_is_repeat(p, first))
        return 1;
    fp3_ode_wrong(&p->in, first, "project, for or end (line %u has a `repeat`)",
                  p->repeat_at.location.line);
    fp3_ode_give_up(&p->in, first);
    return 0;
}

void fp3_ode_repeat_check(ode_parser *p) {
    if (fp3_token_exists(p->repeat_at))
        fp3_ode_wrong(&p->in, p->repeat_at, "an `end` behind the projections that are repeated");
}
