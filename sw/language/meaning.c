/* SPDX-License-Identifier: Apache-2.0 */
#include "meaning.h"

#include "vector.h"

static const ode_value nothing = {0};

ode_value fp3_ode_leaves(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t first,
                         unsigned size) {
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++) {
        ode_value leaf = fp3_ode_leaf(p, at, op, first + i, 0);
        if (!leaf.size)
            return nothing;
        value.expr[i] = leaf.expr[0];
    }
    return value;
}

static int has_state(const ode_parser *p, const ode_symbol *s) {
    for (unsigned i = 0; s->class == ODE_DEFINITION && i < s->value.size; i++)
        if (p->has_state[s->value.expr[i]])
            return 1;
    return 0;
}

/* Whether it is defined as numbers, which may stand everywhere. */
static int is_number(const ode_parser *p, const ode_symbol *s) {
    int is = s->class == ODE_DEFINITION;
    for (unsigned i = 0; is && i < s->value.size; i++)
        is = p->is_number[s->value.expr[i]];
    return is;
}

/* Whether what a name stands for may be used here. Reports it if not. */
static int may_stand(ode_parser *p, fp3_token name, const ode_symbol *s) {
    if (s->class == ODE_RELATION) {
        fp3_ode_wrong(&p->in, name, "a value (this is a relation)");
        return 0;
    }
    if (s->class == ODE_KIND || s->class == ODE_WORD) {
        fp3_ode_wrong(&p->in, name, "a value (a word of a kind is one of a neighbour, as in o.x)");
        return 0;
    }
    if (s->class == ODE_INDEX || is_number(p, s))
        return 1;
    if (s->class == ODE_INVARIANT)
        fp3_ode_wrong(&p->in, name, "a name that is defined (this is an invariant)");
    else if (p->context == ODE_IN_INDEX)
        fp3_ode_wrong(&p->in, name, "numbers and indices, which are known while the text is read");
    else if (p->context == ODE_IN_CONSTANT)
        fp3_ode_wrong(&p->in, name, "a number (only the start of a state may use params)");
    else if (p->context == ODE_IN_START && s->class != ODE_PARAM)
        fp3_ode_wrong(&p->in, name, "numbers and params, which are known before the start");
    else if (p->context == ODE_IN_EXACT && s->class == ODE_STATE)
        fp3_ode_wrong(&p->in, name, "t, params, or the start of a state, as in %.*s(0)",
                      (int)name.length, name.text);
    else if (p->context == ODE_IN_EXACT && has_state(p, s))
        fp3_ode_wrong(&p->in, name, "a definition without states (this is a closed form)");
    else
        return 1;
    return 0;
}

ode_value fp3_ode_stands_for(ode_parser *p, fp3_token name, const ode_symbol *s, unsigned start,
                             unsigned size) {
    if (p->skipping || !may_stand(p, name, s))
        return nothing;
    if (s->class == ODE_INDEX)
        return fp3_ode_leaf(p, name, FP3_EXPR_NUMBER, 0, (double)s->number);
    if (s->class == ODE_STATE || s->class == ODE_PARAM)
        return fp3_ode_leaves(p, name, s->class == ODE_STATE ? FP3_EXPR_STATE : FP3_EXPR_PARAM,
                              s->first + start, size);
    ode_value value = {.size = size};
    for (unsigned i = 0; i < size; i++)
        value.expr[i] = s->value.expr[start + i];
    return value;
}
