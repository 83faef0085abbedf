/* SPDX-License-Identifier: Apache-2.0 */
/* remember.c - the left side of `remember` is a field of the neighbour's entry. */
#include "remember.h"

#include "expression.h"
#include "neighbour.h"
#include "side.h"
#include "symbol.h"
#include "vector.h"

int fp3_ode_is_remember(const ode_parser *p, fp3_token first) {
    return fp3_token_is(first, "remember") && fp3_ode_at_range(p);
}

static const ode_memory *memory_of(const ode_parser *p, uint32_t field) {
    for (uint32_t i = 0; i < p->memory_count; i++)
        if (p->memories[i].field == field)
            return &p->memories[i];
    return NULL;
}

/* "o.s": a whole field. */
static const ode_quantity *target(ode_parser *p, uint32_t relation, uint32_t neighbour) {
    const fp3_token name = p->in.next;
    const fp3_relation *r = &p->relations[relation];
    fp3_token part;
    const ode_symbol *s = name.kind == FP3_TOKEN_NAME ? fp3_ode_find(p, name) : NULL;
    if (!s || neighbour == FP3_NONE || s != &p->symbols[neighbour]) {
        fp3_ode_lost(&p->in, "a field of the neighbour, as in o.s = 0");
        return NULL;
    }
    fp3_ode_advance(&p->in);
    if (!fp3_ode_neighbours_part(p, name, &part))
        return NULL;
    const ode_quantity *field = fp3_ode_field(p, r, part);
    if (!field || !fp3_token_same(field->at, part)) {
        fp3_ode_lost_at(&p->in, name,
                        field ? "the whole field '%s', not a component of it"
                              : "a field that '%s' declares",
                        field ? "s" : r->name);
        return NULL;
    }
    const ode_memory *other = memory_of(p, (uint32_t)(field - p->fields));
    if (other)
        fp3_ode_wrong(&p->in, name, "another field (line %u gives this one a value)",
                      other->to.at.location.line);
    return other ? NULL : field;
}

/* "o.s = expression". What is farther away than the reach is remembered as a new pair is. */
static void assignment(ode_parser *p, uint32_t relation, uint32_t neighbour) {
    const fp3_token at = p->in.next;
    const ode_quantity *field = target(p, relation, neighbour);
    if (p->in.is_lost)
        return;
    p->is_in_sum = p->is_in_remember = 1;
    ode_value value = fp3_ode_right_side(p, ODE_IN_EQUATION, field ? field->size : 0);
    p->is_in_sum = p->is_in_remember = 0;
    const fp3_relation *r = &p->relations[relation];
    if (!field || !value.size || p->in.is_lost || (r->kind == FP3_NEAR && r->reach == FP3_NONE))
        return;
    ode_value nothing = {.size = value.size};
    const ode_value zero = fp3_ode_leaf(p, at, FP3_EXPR_NUMBER, 0, 0);
    for (unsigned i = 0; i < value.size; i++)
        nothing.expr[i] = zero.expr[0];
    value = fp3_ode_where_near(p, at, relation, value, nothing);
    const uint32_t first = (uint32_t)(field - p->fields);
    for (unsigned i = 0; i < value.size; i++)
        p->memories[p->memory_count++] =
            (ode_memory){relation, first + i, fp3_ode_equation(p, at, value.expr[i])};
}

void fp3_ode_remember(ode_parser *p) {
    const fp3_token name = p->in.next;
    if (!fp3_ode_at_neighbours(p)) {
        fp3_ode_lost(&p->in, "neighbours, as in `remember o in touch: o.s = 0`");
        return;
    }
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, "in", "in");
    const uint32_t relation = fp3_ode_find(p, p->in.next)->first;
    if (p->relations[relation].kind == FP3_ALL) {
        fp3_ode_lost(&p->in,
                     "links or near objects: `all` keeps nothing; near with a reach that takes "
                     "all does, as in near %s(x, 1000, s = 0)",
                     p->relations[relation].name);
        return;
    }
    fp3_ode_advance(&p->in);
    fp3_ode_expect(&p->in, ":", "':' and a field, as in o.s = 0");
    uint32_t neighbour = FP3_NONE;
    if (fp3_ode_is_new_name(p, name, 1))
        neighbour = fp3_ode_declare(p, name, ODE_NEIGHBOUR, relation, (ode_value){.size = 1});
    do
        assignment(p, relation, neighbour);
    while (!p->in.is_lost && fp3_ode_accept(&p->in, ","));
    if (neighbour != FP3_NONE)
        fp3_ode_undeclare(p, neighbour);
}

void fp3_ode_check_memories(ode_parser *p) {
    for (uint32_t i = 0; !p->in.report.count && i < p->relation_count; i++) {
        const fp3_relation *r = &p->relations[i];
        for (uint32_t k = r->first_field; k < r->first_field + r->field_count; k++)
            if (r->kind == FP3_NEAR && p->fields[k].size && !memory_of(p, k))
                fp3_ode_wrong(&p->in, p->fields[k].at,
                              "a line `remember` that gives this field of near objects a value");
    }
}
