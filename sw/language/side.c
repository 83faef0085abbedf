/* SPDX-License-Identifier: Apache-2.0 */
#include "side.h"

#include <string.h>

#include "expression.h"
#include "vector.h"

ode_value fp3_ode_right_side(ode_parser *p, ode_context context, unsigned size) {
    fp3_token equals = p->in.next;
    fp3_ode_expect(&p->in, "=", "'='");
    ode_value value = fp3_ode_expression(p, context);
    if (p->in.is_lost)
        return (ode_value){0}; /* only a part of it was read */
    if (!value.size || !size || value.size == size)
        return value;
    fp3_ode_wrong(&p->in, equals, "%s on both sides (on the right is %s)", fp3_ode_shape(size),
                  fp3_ode_shape(value.size));
    return (ode_value){0};
}

ode_equation fp3_ode_equation(const ode_parser *p, fp3_token at, uint32_t expr) {
    ode_equation made = {.at = at, .expr = expr};
    memcpy(made.note, p->in.note, sizeof made.note);
    return made;
}

const ode_symbol *fp3_ode_target(ode_parser *p, fp3_token name, unsigned *start, unsigned *size) {
    const ode_symbol *s = fp3_ode_part(p, name, start, size);
    if (s && s->class == ODE_STATE && !p->skipping)
        return s;
    if (s && s->class != ODE_STATE)
        fp3_ode_wrong(&p->in, name, "a state (line %u declares something else)",
                      s->at.location.line);
    *size = 0;
    return NULL;
}
