/* SPDX-License-Identifier: Apache-2.0 */
#include "quantity.h"

#include <string.h>

#include "symbol.h"
#include "vector.h"

static char *copied(ode_parser *p, const char *text) {
    char *copy = strdup(text);
    p->out_of_memory |= !copy;
    return copy;
}

void fp3_ode_add_quantity(ode_parser *p, fp3_token at, ode_class class, unsigned size,
                          int is_shared, const ode_constant *constant, const char *doc) {
    ode_quantity *array = class == ODE_STATE ? p->states : p->params;
    uint32_t *count = class == ODE_STATE ? &p->state_count : &p->param_count;
    if (*count + size > ODE_QUANTITIES) {
        fp3_ode_over(&p->in, at, "at most %d %s", ODE_QUANTITIES,
                     class == ODE_STATE ? "states" : "params, shared ones included");
        return;
    }
    fp3_ode_declare(p, at, class, *count, (ode_value){.size = size});
    for (unsigned i = 0; i < size; i++) {
        ode_quantity *q = &array[(*count)++];
        *q = (ode_quantity){.at = at, .dimension = constant->dimension};
        fp3_ode_scalar_name(at, size, i, q->quantity.name);
        q->quantity.dimension = copied(p, constant->dimension_text);
        q->quantity.doc = copied(p, doc);
        q->quantity.value = constant->value[i];
        q->quantity.start = constant->expr[i];
        q->quantity.is_shared = is_shared;
        q->quantity.derivative = q->quantity.velocity = q->quantity.exact = FP3_NONE;
        q->quantity.line = at.location.line;
    }
}
