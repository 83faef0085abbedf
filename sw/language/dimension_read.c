/* SPDX-License-Identifier: Apache-2.0 */
#include "dimension_read.h"

#include <string.h>

/* The power behind a unit's name, 1 where there is none. */
static int power_here(ode_parser *p) {
    if (!fp3_ode_accept(&p->in, "^"))
        return 1;
    int sign = fp3_ode_accept(&p->in, "-") ? -1 : 1;
    const char *digits = p->in.next.text;
    size_t length = p->in.next.length;
    int is_good = p->in.next.kind == FP3_TOKEN_NUMBER && length <= 2;
    for (size_t i = 0; is_good && i < length; i++)
        is_good = digits[i] >= '0' && digits[i] <= '9';
    if (!is_good) {
        fp3_ode_lost(&p->in, "an integer from -99 to 99 as the power of a unit");
        return 1;
    }
    int power = length == 2 ? 10 * (digits[0] - '0') + digits[1] - '0' : digits[0] - '0';
    fp3_ode_advance(&p->in);
    return sign * power;
}

static void factor(ode_parser *p, ode_dimension *dimension, int sign) {
    fp3_token name = p->in.next;
    if (name.kind == FP3_TOKEN_NUMBER && fp3_token_is(name, "1")) {
        fp3_ode_advance(&p->in);
        return;
    }
    char text[FP3_NAME_SIZE] = "";
    if (name.kind != FP3_TOKEN_NAME || name.length >= sizeof text ||
        memchr(name.text, '.', name.length)) {
        fp3_ode_lost(&p->in, "a unit such as m, 1/s or kg*m/s^2");
        return;
    }
    memcpy(text, name.text, name.length);
    fp3_ode_advance(&p->in);
    int done =
        fp3_ode_dimension_multiply(&p->dimension_names, dimension, text, sign * power_here(p));
    if (done == 0)
        fp3_ode_wrong(&p->in, name, "at most %d different units in a model", ODE_DIMENSION_NAMES);
    else if (done < 0)
        fp3_ode_wrong(&p->in, name, "a unit with smaller powers");
}

static void append(char text[ODE_DIMENSION_SOURCE_SIZE], fp3_token t) {
    size_t used = strlen(text);
    if (used + t.length < ODE_DIMENSION_SOURCE_SIZE)
        memcpy(text + used, t.text, t.length);
    else /* too long: the caller reports a text that fills its room */
        memset(text + used, '?', ODE_DIMENSION_SOURCE_SIZE - 1 - used);
}

void fp3_ode_dimension_read(ode_parser *p, ode_dimension *dimension,
                            char text[ODE_DIMENSION_SOURCE_SIZE]) {
    fp3_token open = p->in.next;
    *dimension = (ode_dimension){.kind = ODE_DIMENSION_ANY};
    memset(text, 0, ODE_DIMENSION_SOURCE_SIZE);
    if (!fp3_ode_accept(&p->in, "["))
        return;
    dimension->kind = ODE_DIMENSION_KNOWN;
    ode_lexer from = p->in.lexer;
    fp3_token first = p->in.next;
    int sign = 1;
    for (;;) {
        factor(p, dimension, sign);
        if (fp3_ode_at(&p->in, "*") || fp3_ode_at(&p->in, "/"))
            sign = fp3_ode_at(&p->in, "*") ? 1 : -1;
        else
            break;
        fp3_ode_advance(&p->in);
    }
    if (!fp3_ode_at(&p->in, "]"))
        fp3_ode_lost(&p->in, "'*', '/' or ']'");
    if (p->in.is_lost)
        return;
    for (fp3_token t = first; t.text < p->in.next.text; t = fp3_ode_next(&from))
        append(text, t);
    if (strlen(text) == ODE_DIMENSION_SOURCE_SIZE - 1)
        fp3_ode_wrong(&p->in, open, "a unit of fewer than %d characters",
                      ODE_DIMENSION_SOURCE_SIZE - 1);
    fp3_ode_advance(&p->in);
}
