/* cut.c - when each value is computed, where it is until it is used, and the sections that follow from both.
 *
 * `when` of a node is phase * SLOTS + slot. Straight code has even slots, loops have odd ones. */
#include "cut.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

#define SLOTS 16u
#define PHASES 64u

typedef struct {
    fp3_step *step;
    const dag *g;
    fp3_cut *cut;
    uint32_t states;
    uint32_t *when; /* of each node; of one in a loop: of what it reads from outside */
    char *is_body;  /* it depends on a neighbour */
    char *is_needed;
    uint32_t
        *shown; /* [phase * states + state]: node that neighbours see; FP3_NONE: nobody looks */
    uint32_t *
        holder; /* of each node: the variable that keeps it from its section on; FP3_NONE: none does */
    uint32_t *
        held; /* [phase * variables + variable]: node whose value it has there, from begin to end */
    uint32_t own;                              /* variables that the step had before */
    uint32_t slots[PHASES];                    /* the last slot of each phase, an even one */
    uint32_t minus_zero;                       /* node of the step */
    uint32_t pool[FP3_STATES_MAX], pool_count; /* variables that live within a phase */
    uint32_t taken[PHASES];                    /* of these, by what goes from section to section */
    int has_failed;
} cutter;

static fp3_status no_memory(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

static uint32_t *filled(size_t count) {
    uint32_t *list = malloc((count + 1) * sizeof *list);
    for (size_t i = 0; list && i <= count; i++)
        list[i] = FP3_NONE;
    return list;
}

static const dag_node *node_of(const cutter *c, uint32_t node) { return &c->g->nodes[node]; }

static int is_neighbours(uint32_t op) {
    return op == NODE_OTHER_STATE || op == NODE_OTHER_PARAM || op == NODE_FIELD;
}

/* Operands that are nodes. */
static unsigned operands(const cutter *c, uint32_t node, uint32_t list[3]) {
    const dag_node *n = node_of(c, node);
    unsigned count = 0;
    if (fp3_dag_is_leaf(c->g, node) || is_neighbours(n->op))
        return 0;
    if (n->op == NODE_TOTAL) {
        list[0] = n->a;
        return 1;
    }
    for (int i = 0; i < 3; i++)
        if (fp3_dag_operand(c->g, node, i) != FP3_NONE)
            list[count++] = fp3_dag_operand(c->g, node, i);
    return count;
}

static uint32_t phase_of(const cutter *c, uint32_t node) { return c->when[node] / SLOTS; }

/* The first slot in which straight code can read it. */
static uint32_t ready(const cutter *c, uint32_t node) {
    return c->when[node] + (node_of(c, node)->op == NODE_TOTAL);
}

/* ---- when ---- */

static int is_start(const cutter *c, uint32_t node, uint32_t state) {
    return node_of(c, node)->op == NODE_VARIABLE &&
           node_of(c, node)->a == fp3_step_find(c->step, ROLE_STATE, state);
}

/* Whether neighbours can see at this place in this phase what they have to. */
static int fits(const cutter *c, uint32_t place, uint32_t phase) {
    for (uint32_t i = 0; i < c->step->sight.count; i++) {
        const fp3_seen *s = &c->step->sight.list[i];
        const uint32_t there = c->shown[phase * c->states + s->state];
        const int is_there =
            phase == 0 ? is_start(c, s->node, s->state)
                       : is_start(c, s->node, s->state) || ready(c, s->node) / SLOTS < phase;
        if (s->place == place && (!is_there || (there != FP3_NONE && there != s->node)))
            return 0;
    }
    return 1;
}

static void show(const cutter *c, uint32_t place, uint32_t phase) {
    for (uint32_t i = 0; i < c->step->sight.count; i++) {
        const fp3_seen *s = &c->step->sight.list[i];
        if (s->place == place) {
            c->shown[phase * c->states + s->state] = s->node;
            c->cut->published |= UINT64_C(1) << s->state;
        }
    }
}

static fp3_status find_when(cutter *c, fp3_error *error) {
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t list[3];
        const unsigned count = operands(c, i, list);
        c->is_body[i] = (char)is_neighbours(node_of(c, i)->op);
        for (unsigned k = 0; k < count; k++) {
            const uint32_t then = c->is_body[list[k]] ? c->when[list[k]] : ready(c, list[k]);
            c->when[i] = then > c->when[i] ? then : c->when[i];
            c->is_body[i] |= c->is_body[list[k]];
        }
        if (node_of(c, i)->op != NODE_TOTAL)
            continue;
        uint32_t phase = c->when[i] / SLOTS;
        while (phase < PHASES && !fits(c, node_of(c, i)->c, phase))
            phase++;
        if (phase == PHASES || (c->when[i] | 1) % SLOTS > SLOTS - 3)
            return fp3_fail(
                error, FP3_E_LIMIT,
                "a step has more than %u phases, or sums of sums of neighbours deeper than %u",
                PHASES, SLOTS / 2 - 1);
        show(c, node_of(c, i)->c, phase);
        if (phase * SLOTS > c->when[i])
            c->when[i] = phase * SLOTS;
        c->when[i] |= 1;
        c->is_body[i] = 0;
    }
    return FP3_OK;
}

static void need(const cutter *c, uint32_t node) {
    if (node != FP3_NONE)
        c->is_needed[node] = 1;
}

static void find_needed(cutter *c) {
    for (uint32_t i = 0; i < c->own; i++)
        need(c, c->step->variables[i].next);
    for (uint32_t i = c->g->count; i-- > 0;) {
        uint32_t list[3];
        const unsigned count = c->is_needed[i] ? operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            need(c, list[k]);
        for (uint32_t k = 0; count && node_of(c, i)->op == NODE_TOTAL && k < c->step->sight.count;
             k++)
            if (c->step->sight.list[k].place == node_of(c, i)->c)
                need(c, c->step->sight.list[k].node); /* it comes before the sum */
    }
    c->cut->phase_count = 1;
    for (uint32_t i = 0; i < c->g->count; i++) {
        if (!c->is_needed[i] || c->is_body[i])
            continue;
        const uint32_t then = ready(c, i), phase = then / SLOTS;
        if (phase + 1 > c->cut->phase_count)
            c->cut->phase_count = phase + 1;
        if (then % SLOTS > c->slots[phase])
            c->slots[phase] = then % SLOTS;
    }
}

/* ---- where ---- */

static uint32_t new_variable(cutter *c, role role, uint32_t state) {
    if (c->step->variable_count >= 2 * FP3_STATES_MAX || !fp3_step_add(c->step, role, state)) {
        c->has_failed = 1;
        return 0;
    }
    return c->step->variable_count - 1;
}

static uint32_t *held(const cutter *c, uint32_t phase, uint32_t variable) {
    return &c->held[phase * c->own + variable];
}

static uint32_t state_of(const cutter *c, uint32_t variable) {
    return c->step->variables[variable].role == ROLE_STATE ? c->step->variables[variable].state
                                                           : FP3_NONE;
}

static int is_published(const cutter *c, uint32_t variable) {
    const uint32_t state = state_of(c, variable);
    return state != FP3_NONE && (c->cut->published >> state & 1);
}

/* The last phase in which something reads the variable as it was when the step began. */
static uint32_t last_use(const cutter *c, uint32_t variable) {
    uint32_t last = 0;
    const uint32_t start = fp3_dag_find(c->g, NODE_VARIABLE, variable, FP3_NONE, FP3_NONE);
    for (uint32_t i = 0; start != FP3_NONE && i < c->g->count; i++) {
        uint32_t list[3];
        const unsigned count = c->is_needed[i] && !c->is_body[i] ? operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            if ((list[k] == start || c->is_body[list[k]]) && phase_of(c, i) > last)
                last =
                    phase_of(c, i); /* of what is in a loop nothing is known here: it may read it */
    }
    return last;
}

/* What each variable holds in each phase. A published state holds what neighbours see; every other variable its
 * old value until nobody reads that any more. */
static void find_held(cutter *c) {
    const uint32_t phases = c->cut->phase_count;
    for (uint32_t v = 0; v < c->own; v++) {
        uint32_t now = fp3_dag_find(c->g, NODE_VARIABLE, v, FP3_NONE, FP3_NONE);
        const uint32_t next = c->step->variables[v].next;
        const uint32_t ends = is_published(c, v) || next == FP3_NONE ? phases : last_use(c, v);
        for (uint32_t p = 0; p < phases; p++) {
            if (is_published(c, v) && p > 0 && c->shown[p * c->states + state_of(c, v)] != FP3_NONE)
                now = c->shown[p * c->states + state_of(c, v)];
            if (!is_published(c, v) && next != FP3_NONE && p > ends && ready(c, next) / SLOTS < p)
                now = next;
            *held(c, p, v) = now;
        }
    }
}

/* The variable that holds it in this phase, or FP3_NONE. */
static uint32_t holds(const cutter *c, uint32_t node, uint32_t phase) {
    for (uint32_t v = 0; v < c->own; v++)
        if (*held(c, phase, v) == node)
            return v;
    return FP3_NONE;
}

/* It is read in this phase: if it is from an earlier one, and nobody holds it, it is kept. */
static void keep(cutter *c, uint32_t node, uint32_t phase) {
    const uint32_t from = node_of(c, node)->op == NODE_VARIABLE ? 0 : ready(c, node) / SLOTS;
    if (node_of(c, node)->op == NODE_KNOWN || from == phase || holds(c, node, phase) != FP3_NONE ||
        c->holder[node] != FP3_NONE)
        return;
    c->holder[node] = new_variable(c, ROLE_CARRIED, FP3_NONE);
}

/* What the loop of a sum reads from outside, one after the other. */
static void each_outside(cutter *c, uint32_t total,
                         void (*use)(cutter *c, uint32_t node, uint32_t total)) {
    const uint32_t term = node_of(c, total)->a;
    char *is_in = calloc(c->g->count + 1u, 1);
    if (!is_in) {
        c->has_failed = 1;
        return;
    }
    is_in[term] = 1;
    for (uint32_t i = term + 1; i-- > 0;) {
        uint32_t list[3];
        if (is_in[i] && !c->is_body[i] && !is_neighbours(node_of(c, i)->op))
            use(c, i, total);
        const unsigned count = is_in[i] && c->is_body[i] ? operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            is_in[list[k]] = 1;
    }
    free(is_in);
}

static void keep_for_loop(cutter *c, uint32_t node, uint32_t total) {
    keep(c, node, phase_of(c, total));
}

/* Which node a variable gets at the end of a phase; FP3_NONE: it keeps what it has. */
static uint32_t gets(const cutter *c, uint32_t phase, uint32_t variable) {
    const uint32_t now = *held(c, phase, variable);
    const uint32_t next = phase + 1 < c->cut->phase_count ? *held(c, phase + 1, variable)
                                                          : c->step->variables[variable].next;
    return next == now ? FP3_NONE : next;
}

static void find_kept(cutter *c) {
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t list[3];
        if (!c->is_needed[i] || c->is_body[i])
            continue;
        if (node_of(c, i)->op == NODE_TOTAL) {
            each_outside(c, i, keep_for_loop);
            continue;
        }
        const unsigned count = operands(c, i, list);
        for (unsigned k = 0; k < count; k++)
            keep(c, list[k], phase_of(c, i));
    }
    for (uint32_t p = 0; p < c->cut->phase_count; p++)
        for (uint32_t v = 0; v < c->own; v++)
            if (gets(c, p, v) != FP3_NONE)
                keep(c, gets(c, p, v), p);
}

/* A variable of the pool that nobody has taken in this phase. */
static uint32_t take(cutter *c, uint32_t *taken) {
    if (*taken == c->pool_count) {
        if (c->pool_count == FP3_STATES_MAX) {
            c->has_failed = 1;
            return 0;
        }
        c->pool[c->pool_count++] = new_variable(c, ROLE_CARRIED, FP3_NONE);
    }
    return c->pool[(*taken)++];
}

static void cross(cutter *c, uint32_t node, uint32_t phase) {
    if (c->holder[node] == FP3_NONE)
        c->holder[node] = take(c, &c->taken[phase]);
}

static void cross_for_loop(cutter *c, uint32_t node, uint32_t total) {
    const uint32_t op = node_of(c, node)->op;
    if (op != NODE_KNOWN && op != NODE_VARIABLE && phase_of(c, node) == phase_of(c, total))
        cross(c, node, phase_of(c, total));
}

/* What goes from one section of a phase to a later one. */
static void find_crossing(cutter *c) {
    memset(c->taken, 0, sizeof c->taken);
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t list[3];
        if (!c->is_needed[i] || c->is_body[i])
            continue;
        if (node_of(c, i)->op == NODE_TOTAL) {
            cross(c, i, phase_of(c, i));
            each_outside(c, i, cross_for_loop);
            continue;
        }
        const unsigned count = operands(c, i, list);
        for (unsigned k = 0; k < count; k++)
            if (!fp3_dag_is_leaf(c->g, list[k]) && phase_of(c, list[k]) == phase_of(c, i) &&
                c->when[list[k]] != c->when[i])
                cross(c, list[k], phase_of(c, i));
    }
    for (uint32_t p = 0; p < c->cut->phase_count; p++)
        for (uint32_t v = 0; v < c->own; v++) {
            const uint32_t node = gets(c, p, v);
            if (node != FP3_NONE && !fp3_dag_is_leaf(c->g, node) && phase_of(c, node) == p &&
                c->when[node] != p * SLOTS + c->slots[p])
                cross(c, node, p);
        }
}

/* ---- sections ---- */

typedef struct {
    cutter *c;
    fp3_section *s;
    uint32_t slot;
    uint32_t *made; /* of each node of the step: that of the section */
} builder;

static uint32_t put(builder *b, uint32_t node);

/* A node that has been computed before this section. */
static uint32_t from_outside(builder *b, uint32_t node) {
    cutter *c = b->c;
    const dag_node *n = node_of(c, node);
    if (n->op == NODE_KNOWN)
        return fp3_dag_known(&b->s->values, n->a);
    const uint32_t variable = holds(c, node, b->s->phase);
    return fp3_dag_variable(&b->s->values, variable != FP3_NONE ? variable : c->holder[node]);
}

static int is_here(const builder *b, uint32_t node) {
    const cutter *c = b->c;
    const uint32_t op = node_of(c, node)->op;
    if (fp3_dag_is_leaf(c->g, node) || op == NODE_TOTAL)
        return 0;
    return b->s->relation != FP3_NONE ? c->is_body[node]
                                      : c->when[node] == b->s->phase * SLOTS + b->slot;
}

/* Operands stand before the node: they are made, since nodes are put in their order. */
static uint32_t put(builder *b, uint32_t node) {
    const dag_node *n = node_of(b->c, node);
    if (!is_here(b, node))
        return from_outside(b, node);
    if (b->made[node] != FP3_NONE)
        return b->made[node];
    const uint32_t a = n->a == FP3_NONE ? FP3_NONE : put(b, n->a);
    const uint32_t second = n->b == FP3_NONE ? FP3_NONE : put(b, n->b);
    const uint32_t third = n->c == FP3_NONE ? FP3_NONE : put(b, n->c);
    b->s->values.note = n->note;
    b->made[node] = fp3_dag_make(&b->s->values, n->op, a, second, third);
    return b->made[node];
}

static void write(builder *b, uint32_t variable, uint32_t node) {
    if (b->s->next[variable] == FP3_NONE)
        b->s->next[variable] = node;
}

static fp3_status open_section(builder *b, cutter *c, uint32_t phase, uint32_t slot,
                               uint32_t relation, fp3_error *error) {
    fp3_section *more = realloc(c->cut->sections, (c->cut->section_count + 1u) * sizeof *more);
    if (!more)
        return no_memory(error);
    c->cut->sections = more;
    fp3_section *s = &more[c->cut->section_count++];
    *s = (fp3_section){.phase = phase, .relation = relation};
    fp3_dag_open(&s->values, &c->step->known, 0);
    s->next = filled(2 * FP3_STATES_MAX);
    s->loads = calloc(c->g->count + 1u, sizeof *s->loads);
    *b = (builder){.c = c, .s = s, .slot = slot, .made = filled(c->g->count)};
    return s->next && s->loads && b->made ? FP3_OK : no_memory(error);
}

/* Nodes in their order: a deep sum is not a deep recursion. */
static void put_all(builder *b) {
    const cutter *c = b->c;
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && b->s->relation == FP3_NONE && !c->is_body[i] && is_here(b, i))
            put(b, i);
}

static fp3_status straight(cutter *c, uint32_t phase, uint32_t slot, fp3_error *error) {
    builder b;
    fp3_status status = open_section(&b, c, phase, slot, FP3_NONE, error);
    if (status) {
        free(b.made);
        return status;
    }
    put_all(&b);
    for (uint32_t i = 0; i < c->g->count; i++) {
        const int is_total = node_of(c, i)->op == NODE_TOTAL;
        if (!c->is_needed[i] || c->is_body[i] || c->holder[i] == FP3_NONE)
            continue;
        if (is_total && c->when[i] == phase * SLOTS + slot + 1)
            write(&b, c->holder[i], from_outside(&b, c->minus_zero));
        else if (!is_total && is_here(&b, i))
            write(&b, c->holder[i], put(&b, i));
        else if (node_of(c, i)->op == NODE_VARIABLE && phase == 0 && slot == c->slots[0])
            write(&b, c->holder[i], fp3_dag_variable(&b.s->values, node_of(c, i)->a));
    }
    for (uint32_t v = 0; slot == c->slots[phase] && v < c->own; v++)
        if (gets(c, phase, v) != FP3_NONE)
            write(&b, v, put(&b, gets(c, phase, v)));
    free(b.made);
    return FP3_OK;
}

/* The variable that a word of the neighbour is loaded to. */
static uint32_t loaded(builder *b, uint32_t node, uint32_t *taken) {
    const dag_node *n = node_of(b->c, node);
    fp3_section *s = b->s;
    for (uint32_t i = 0; i < s->load_count; i++)
        if (s->loads[i].op == n->op && s->loads[i].index == n->a)
            return s->loads[i].variable;
    s->loads[s->load_count] = (fp3_loaded){take(b->c, taken), n->op, n->a};
    return s->loads[s->load_count++].variable;
}

static fp3_status loop(cutter *c, uint32_t phase, uint32_t slot, uint32_t relation,
                       fp3_error *error) {
    builder b;
    fp3_status status = open_section(&b, c, phase, slot, relation, error);
    uint32_t taken = c->taken[phase];
    char *is_in = calloc(c->g->count + 1u, 1);
    if (!is_in && !status)
        status = no_memory(error);
    for (uint32_t i = c->g->count; !status && i-- > 0;) {
        uint32_t list[3];
        const dag_node *n = node_of(c, i);
        const int is_total = n->op == NODE_TOTAL;
        if (is_total && c->is_needed[i] && c->when[i] == phase * SLOTS + slot && n->b == relation)
            is_in[n->a] = 1;
        const unsigned count = is_in[i] && c->is_body[i] ? operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            is_in[list[k]] = 1;
    }
    for (uint32_t i = 0; !status && i < c->g->count; i++) {
        const dag_node *n = node_of(c, i);
        if (is_in[i] && is_neighbours(n->op))
            b.made[i] = fp3_dag_variable(&b.s->values, loaded(&b, i, &taken));
        else if (is_in[i] && c->is_body[i])
            put(&b, i);
        if (n->op != NODE_TOTAL || !c->is_needed[i] || c->when[i] != phase * SLOTS + slot ||
            n->b != relation)
            continue;
        const uint32_t sum = fp3_dag_variable(&b.s->values, c->holder[i]);
        const uint32_t term = put(&b, n->a);
        b.s->values.note = n->note;
        write(&b, c->holder[i], fp3_dag_make(&b.s->values, FP3_OP_ADD, sum, term, FP3_NONE));
    }
    free(is_in);
    free(b.made);
    return status;
}

static int has_loop(const cutter *c, uint32_t when, uint32_t relation) {
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && node_of(c, i)->op == NODE_TOTAL && c->when[i] == when &&
            node_of(c, i)->b == relation)
            return 1;
    return 0;
}

static fp3_status make_sections(cutter *c, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t p = 0; p < c->cut->phase_count; p++)
        for (uint32_t slot = 0; !status && slot <= c->slots[p]; slot++) {
            if (slot % 2 == 0)
                status = straight(c, p, slot, error);
            for (uint32_t r = 0; !status && slot % 2 && r < c->step->model->relation_count; r++)
                if (has_loop(c, p * SLOTS + slot, r))
                    status = loop(c, p, slot, r, error);
        }
    return status;
}

static void make_lists(cutter *c) {
    for (uint32_t r = 0; r < c->step->model->relation_count; r++) {
        int is_used = 0;
        c->cut->list[r] = FP3_NONE;
        for (uint32_t i = 0; i < c->g->count; i++)
            is_used |= c->is_needed[i] && node_of(c, i)->op == NODE_TOTAL && node_of(c, i)->b == r;
        if (is_used)
            c->cut->list[r] = new_variable(c, ROLE_LIST, r);
    }
}

/* Params of neighbours are words of their records, so they are params of the program. */
static void know_params(cutter *c) {
    const fp3_model *model = c->step->model;
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t e = 0;
        if (!c->is_needed[i] || node_of(c, i)->op != NODE_OTHER_PARAM)
            continue;
        while (model->exprs[e].op != FP3_EXPR_PARAM || model->exprs[e].index != node_of(c, i)->a)
            e++; /* the language has made one beside that of the neighbour */
        fp3_known_model(&c->step->known, e);
    }
}

/* ---- the interface ---- */

static fp3_status make(cutter *c, fp3_error *error) {
    fp3_status status = find_when(c, error);
    if (status)
        return status;
    find_needed(c);
    know_params(c);
    c->held = filled((size_t)c->cut->phase_count * c->own);
    if (!c->held)
        return no_memory(error);
    find_held(c);
    find_kept(c);
    make_lists(c);
    find_crossing(c);
    c->cut->unused = new_variable(c, ROLE_CARRIED, FP3_NONE);
    if (!c->has_failed)
        status = make_sections(c, error);
    if (!status && c->has_failed)
        status =
            fp3_fail(error, FP3_E_LIMIT,
                     "a step keeps more than %d values from one phase to another", FP3_STATES_MAX);
    return status;
}

fp3_status fp3_cut_make(fp3_step *step, fp3_cut *cut, fp3_error *error) {
    const uint32_t minus_zero = fp3_dag_number(&step->values, -0.0);
    const size_t nodes = step->values.count;
    *cut = (fp3_cut){0};
    cutter c = {.step = step,
                .g = &step->values,
                .cut = cut,
                .states = step->model->state_count,
                .own = step->variable_count,
                .minus_zero = minus_zero,
                .when = calloc(nodes + 1, sizeof *c.when),
                .is_body = calloc(nodes + 1, 1),
                .is_needed = calloc(nodes + 1, 1),
                .holder = filled(nodes),
                .shown = filled((size_t)PHASES * step->model->state_count)};
    const int is_whole = c.when && c.is_body && c.is_needed && c.holder && c.shown;
    const fp3_status status = is_whole ? make(&c, error) : no_memory(error);
    free(c.when);
    free(c.is_body);
    free(c.is_needed);
    free(c.holder);
    free(c.shown);
    free(c.held);
    return status;
}

void fp3_cut_close(fp3_cut *cut) {
    for (uint32_t i = 0; i < cut->section_count; i++) {
        fp3_dag_close(&cut->sections[i].values);
        free(cut->sections[i].next);
        free(cut->sections[i].loads);
    }
    free(cut->sections);
    *cut = (fp3_cut){0};
}
