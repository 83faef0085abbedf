/* SPDX-License-Identifier: Apache-2.0 */
#include "keyword.h"

#include "base/nearest.h"

/* Those that begin a statement come first. */
static const char *const words[] = {
    "model", "param", "shared", "state", "step", "span", "exact", "invariant", "when", "for",
    "links", "near",  "all",    "kind",  "and",  "or",   "not",   "in",        "t",    "pi"};
enum { WORDS = sizeof words / sizeof *words, STATEMENTS = 14 };

static int is_one_of(fp3_token name, unsigned count) {
    for (unsigned i = 0; i < count; i++)
        if (fp3_token_is(name, words[i]))
            return 1;
    return 0;
}

int fp3_ode_begins_statement(fp3_token name) { return is_one_of(name, STATEMENTS); }

int fp3_ode_is_keyword(fp3_token name) { return is_one_of(name, WORDS); }

void fp3_ode_nearest_statement(fp3_token name, const char **best) {
    for (unsigned i = 0; i < STATEMENTS; i++)
        fp3_nearest(name, words[i], best);
}
