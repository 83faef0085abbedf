/* SPDX-License-Identifier: Apache-2.0 */
/* plan.c - see plan.h. */
#include "plan.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

uint32_t *fp3_cut_filled(size_t count) {
    uint32_t *list = malloc((count + 1) * sizeof *list);
    for (size_t i = 0; list && i <= count; i++)
        list[i] = FP3_NONE;
    return list;
}

int fp3_cut_is_neighbours(uint32_t op) {
    return op == NODE_OTHER_STATE || op == NODE_OTHER_PARAM || op == NODE_FIELD;
}

uint32_t fp3_cut_fold_op(const fp3_cut_plan *c, uint32_t fold) {
    static const uint32_t ops[] = {FP3_OP_ADD, FP3_OP_MIN, FP3_OP_MAX};
    return ops[fp3_cut_node(c, fold)->op - NODE_TOTAL];
}

/* Operands that are nodes. */
unsigned fp3_cut_operands(const fp3_cut_plan *c, uint32_t node, uint32_t list[FP3_CUT_OPERANDS]) {
    const dag_node *n = fp3_cut_node(c, node);
    unsigned count = 0;
    if (fp3_dag_is_leaf(c->g, node) || fp3_cut_is_neighbours(n->op))
        return 0;
    const int last = fp3_dag_is_fold(n->op) || n->op == NODE_WORST ? 1 : 2;
    for (int i = 0; i <= last; i++)
        if (fp3_dag_operand(c->g, node, i) != FP3_NONE)
            list[count++] = fp3_dag_operand(c->g, node, i);
    for (int i = 0; fp3_dag_is_fold(n->op) && fp3_dag_has_second(c->g, node) && i <= last; i++)
        list[count++] = fp3_dag_operand(c->g, node + 1, i);
    return count;
}

static uint32_t phase_of(const fp3_cut_plan *c, uint32_t node) {
    return c->when[node] / FP3_CUT_SLOTS;
}

/* The first slot in which straight code can read it. */
static uint32_t ready(const fp3_cut_plan *c, uint32_t node) {
    return c->when[node] + (uint32_t)fp3_dag_is_fold(fp3_cut_node(c, node)->op);
}

/* It comes from all objects, when the phase begins. */
static int is_worst(const fp3_cut_plan *c, uint32_t node) {
    return fp3_cut_node(c, node)->op == NODE_WORST;
}

/* ---- when ---- */

static int is_start(const fp3_cut_plan *c, const fp3_seen *s) {
    return fp3_cut_node(c, s->node)->op == NODE_VARIABLE &&
           fp3_cut_node(c, s->node)->a == fp3_step_word(c->step, s->state, s->word);
}

/* The node that neighbours see of a word of a state in this phase. */
static uint32_t *shown(const fp3_cut_plan *c, uint32_t phase, uint32_t state, uint32_t word) {
    return &c->shown[phase * c->words + word * c->step->model->state_count + state];
}

/* Whether neighbours can see at this place in this phase what comes before a node. What comes later
 * is not read by it. */
static int fits(const fp3_cut_plan *c, uint32_t place, uint32_t phase, uint32_t before) {
    for (uint32_t i = 0; i < c->step->sight.count; i++) {
        const fp3_seen *s = &c->step->sight.list[i];
        const uint32_t there = *shown(c, phase, s->state, s->word);
        const int is_there =
            is_start(c, s) || (phase > 0 && ready(c, s->node) / FP3_CUT_SLOTS < phase);
        if (s->place == place && s->node < before &&
            (!is_there || (there != FP3_NONE && there != s->node)))
            return 0;
    }
    return 1;
}

static void show(fp3_cut_plan *c, uint32_t place, uint32_t phase, uint32_t before) {
    for (uint32_t i = 0; i < c->step->sight.count; i++) {
        const fp3_seen *s = &c->step->sight.list[i];
        if (s->place == place && s->node < before) {
            *shown(c, phase, s->state, s->word) = s->node;
            c->published |= UINT64_C(1) << s->state;
        }
    }
}

static fp3_status too_many(fp3_error *error) {
    return fp3_fail(error, FP3_E_LIMIT, "a step has more than %u phases", FP3_CUT_PHASES);
}

/* The earliest phase for what is seen at this place, as other kinds ask for it. */
static uint32_t least_phase(const fp3_cut_plan *c, uint32_t place) {
    const uint32_t number = fp3_step_place(c->step, place);
    const uint32_t asked =
        c->step->coupling && number != FP3_NONE ? c->step->coupling->phase[number] : 0;
    return asked > c->base ? asked - c->base : 0;
}

/* The phase that begins with what all objects have compared, which they had at a time. */
static uint32_t compared(const fp3_cut_plan *c, uint32_t node) {
    const fp3_coupling *of = c->step->coupling;
    const uint32_t least = of ? of->behind[fp3_cut_node(c, node)->c] : 0;
    const uint32_t own = c->base + phase_of(c, node);
    return (own > least ? own : least) - c->base + 1;
}

/* The first time from `when` on for loops at a place; 0: there is none. What has no slot in a phase
 * goes on in the next one. */
static uint32_t loops_at(const fp3_cut_plan *c, uint32_t place, uint32_t when, uint32_t before) {
    uint32_t phase = when / FP3_CUT_SLOTS;
    const uint32_t first = phase, least = least_phase(c, place);
    const int is_full = (when | 1) % FP3_CUT_SLOTS > FP3_CUT_SLOTS - 3;
    if (phase < least)
        phase = least;
    while (phase < FP3_CUT_PHASES &&
           ((phase == first && is_full) || !fits(c, place, phase, before)))
        phase++;
    return phase == FP3_CUT_PHASES ? 0 : (phase > first ? phase * FP3_CUT_SLOTS : when) | 1;
}

/* ---- what objects of other kinds see ---- */

static void handle(fp3_cut_plan *c, uint32_t place, uint32_t phase, uint32_t before) {
    const uint32_t number = fp3_step_place(c->step, place);
    show(c, place, phase, before);
    if (number == FP3_NONE || !(c->step->shown >> number & 1))
        return;
    if (!(c->handled >> number & 1) || phase > c->phase_of[number])
        c->phase_of[number] = phase;
    c->handled |= UINT64_C(1) << number;
}

/* Whether what is seen there comes before a node. */
static int is_made(const fp3_cut_plan *c, uint32_t place, uint32_t before) {
    for (uint32_t i = 0; i < c->step->sight.count; i++)
        if (c->step->sight.list[i].place == place && c->step->sight.list[i].node >= before)
            return 0;
    return 1;
}

/* Shows the places before `end`, as far as their values come before a node. */
static fp3_status show_until(fp3_cut_plan *c, uint32_t end, uint32_t before, fp3_error *error) {
    for (uint32_t place = 0; place < FP3_LAST_PLACE && place < end; place++) {
        uint32_t phase = least_phase(c, place);
        if (!((c->step->shown & ~c->handled) >> place & 1) || place == c->step->kept_place ||
            !is_made(c, place, before))
            continue;
        while (phase < FP3_CUT_PHASES && !fits(c, place, phase, before))
            phase++;
        if (phase == FP3_CUT_PHASES)
            return too_many(error);
        handle(c, place, phase, before);
    }
    return FP3_OK;
}

static fp3_status find_when(fp3_cut_plan *c, fp3_error *error) {
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t list[FP3_CUT_OPERANDS];
        const unsigned count = fp3_cut_operands(c, i, list);
        c->is_body[i] = (char)fp3_cut_is_neighbours(fp3_cut_node(c, i)->op);
        if (fp3_cut_node(c, i)->op == NODE_SECOND) {
            c->when[i] = c->when[i - 1];
            continue;
        }
        for (unsigned k = 0; k < count; k++) {
            const uint32_t then = c->is_body[list[k]] ? c->when[list[k]] : ready(c, list[k]);
            c->when[i] = then > c->when[i] ? then : c->when[i];
            c->is_body[i] |= c->is_body[list[k]];
        }
        if (is_worst(c, i))
            c->when[i] = compared(c, i) * FP3_CUT_SLOTS;
        if (phase_of(c, i) >= FP3_CUT_PHASES)
            return too_many(error);
        if (!fp3_dag_is_fold(fp3_cut_node(c, i)->op))
            continue;
        const uint32_t place = fp3_dag_place(c->g, i);
        const fp3_status status = show_until(c, place, i, error);
        if (status)
            return status;
        c->when[i] = loops_at(c, place, c->when[i], i);
        if (!c->when[i])
            return too_many(error);
        handle(c, place, phase_of(c, i), i);
        c->is_body[i] = 0;
    }
    return show_until(c, FP3_LAST_PLACE, c->g->count, error);
}

/* Fields are written when nothing reads them any more. */
static fp3_status find_kept(fp3_cut_plan *c, fp3_error *error) {
    const fp3_step *step = c->step;
    uint32_t when = 0;
    for (uint32_t k = 0; k < step->kept_count; k++) {
        const fp3_kept *kept = &step->kept[k];
        const uint32_t then = c->is_body[kept->node] ? c->when[kept->node] : ready(c, kept->node);
        when = then > when ? then : when;
        for (uint32_t i = 0; i < c->g->count; i++)
            if (fp3_dag_is_fold(fp3_cut_node(c, i)->op) &&
                fp3_dag_relation(c->g, i) == kept->relation && c->when[i] > when)
                when = c->when[i];
    }
    c->kept = loops_at(c, step->kept_place, when, c->g->count);
    if (!c->kept)
        return too_many(error);
    handle(c, step->kept_place, c->kept / FP3_CUT_SLOTS, c->g->count);
    return FP3_OK;
}

static void count_phases(fp3_cut_plan *c, uint32_t then) {
    const uint32_t phase = then / FP3_CUT_SLOTS;
    if (phase + 1 > c->phase_count)
        c->phase_count = phase + 1;
    if (then % FP3_CUT_SLOTS > c->slots[phase])
        c->slots[phase] = then % FP3_CUT_SLOTS;
}

/* What the loops that write fields are made of, and what is computed before them. */
static void mark_kept(fp3_cut_plan *c) {
    for (uint32_t k = 0; k < c->step->kept_count; k++)
        c->in_kept[c->step->kept[k].node] = 1;
    for (uint32_t i = c->g->count; i-- > 0;) {
        uint32_t list[FP3_CUT_OPERANDS];
        const unsigned count = c->in_kept[i] && c->is_body[i] ? fp3_cut_operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            c->in_kept[list[k]] = 1;
    }
}

static void need(const fp3_cut_plan *c, uint32_t node) {
    if (node != FP3_NONE)
        c->is_needed[node] = 1;
}

static void find_needed(fp3_cut_plan *c) {
    for (uint32_t i = 0; i < c->own; i++)
        need(c, c->step->variables[i].next);
    for (uint32_t k = 0; k < c->step->kept_count; k++)
        need(c, c->step->kept[k].node);
    for (uint32_t k = 0; c->step->kept_count && k < c->step->sight.count; k++)
        if (c->step->sight.list[k].place == c->step->kept_place)
            need(c, c->step->sight.list[k].node);
    for (uint32_t k = 0; k < c->step->sight.count; k++) {
        const uint32_t place = fp3_step_place(c->step, c->step->sight.list[k].place);
        if (place != FP3_NONE && c->handled >> place & 1)
            need(c, c->step->sight.list[k].node);
    }
    for (uint32_t i = c->g->count; i-- > 0;) {
        uint32_t list[FP3_CUT_OPERANDS];
        const unsigned count = c->is_needed[i] ? fp3_cut_operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            need(c, list[k]);
        if (count && fp3_cut_node(c, i)->op == NODE_SECOND)
            need(c, i - 1); /* a fold of pairs needs both words */
        else if (count && fp3_dag_is_fold(fp3_cut_node(c, i)->op) && fp3_dag_has_second(c->g, i))
            need(c, i + 1);
        for (uint32_t k = 0;
             count && fp3_dag_is_fold(fp3_cut_node(c, i)->op) && k < c->step->sight.count; k++)
            if (c->step->sight.list[k].place == fp3_dag_place(c->g, i))
                need(c, c->step->sight.list[k].node); /* it comes before the sum */
    }
}

static void count_all(fp3_cut_plan *c) {
    c->phase_count = 1;
    for (uint32_t i = 0; i < c->g->count; i++) {
        if (!c->is_needed[i] || c->is_body[i])
            continue;
        count_phases(c, ready(c, i));
    }
    if (c->step->kept_count)
        count_phases(c, c->kept + 1);
    for (uint32_t i = 0; i < FP3_PLACES; i++)
        if (c->handled >> i & 1) /* else the end of the step would be there already */
            count_phases(c, c->phase_of[i] * FP3_CUT_SLOTS);
}

/* ---- where ---- */

uint32_t fp3_cut_variable(fp3_cut_plan *c, role role, uint32_t state) {
    if (c->step->variable_count >= 2 * FP3_STATES_MAX || !fp3_step_add(c->step, role, state)) {
        c->has_failed = 1;
        return 0;
    }
    return c->step->variable_count - 1;
}

static uint32_t *held(const fp3_cut_plan *c, uint32_t phase, uint32_t variable) {
    return &c->held[phase * c->own + variable];
}

/* Of a word that neighbours may see. */
static uint32_t state_of(const fp3_cut_plan *c, uint32_t variable) {
    const role role = c->step->variables[variable].role;
    return role == ROLE_STATE || role == ROLE_LOW ? c->step->variables[variable].state : FP3_NONE;
}

static int is_published(const fp3_cut_plan *c, uint32_t variable) {
    const uint32_t state = state_of(c, variable);
    return state != FP3_NONE && (c->published >> state & 1);
}

/* The last phase in which something reads the variable as it was when the step began. */
static uint32_t last_use(const fp3_cut_plan *c, uint32_t variable) {
    uint32_t last = 0;
    const uint32_t start = fp3_dag_find(c->g, NODE_VARIABLE, variable, FP3_NONE, FP3_NONE);
    for (uint32_t i = 0; start != FP3_NONE && i < c->g->count; i++) {
        uint32_t list[FP3_CUT_OPERANDS];
        const unsigned count = c->is_needed[i] && !c->is_body[i] ? fp3_cut_operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            if ((list[k] == start || c->is_body[list[k]]) && phase_of(c, i) > last)
                last =
                    phase_of(c, i); /* of what is in a loop nothing is known here: it may read it */
    }
    if (start != FP3_NONE && c->in_kept[start] && c->kept / FP3_CUT_SLOTS > last)
        last = c->kept / FP3_CUT_SLOTS;
    return last;
}

/* What each variable holds in each phase. A published state holds what neighbours see; every other
 * variable its old value until it has no more readers. */
static void find_held(fp3_cut_plan *c) {
    const uint32_t phases = c->phase_count;
    for (uint32_t v = 0; v < c->own; v++) {
        uint32_t now = fp3_dag_find(c->g, NODE_VARIABLE, v, FP3_NONE, FP3_NONE);
        const uint32_t next = c->step->variables[v].next;
        const uint32_t ends = is_published(c, v) || next == FP3_NONE ? phases : last_use(c, v);
        for (uint32_t p = 0; p < phases; p++) {
            const uint32_t seen =
                is_published(c, v)
                    ? *shown(c, p, state_of(c, v), c->step->variables[v].role == ROLE_LOW)
                    : FP3_NONE;
            if (p > 0 && seen != FP3_NONE)
                now = seen;
            if (!is_published(c, v) && next != FP3_NONE && p > ends &&
                ready(c, next) / FP3_CUT_SLOTS < p)
                now = next;
            *held(c, p, v) = now;
        }
    }
}

/* The variable that holds it in this phase, or FP3_NONE. */
uint32_t fp3_cut_holds(const fp3_cut_plan *c, uint32_t node, uint32_t phase) {
    for (uint32_t v = 0; v < c->own; v++)
        if (*held(c, phase, v) == node)
            return v;
    return FP3_NONE;
}

/* The value is read at this time. If it is from another section, and no variable holds it there, a
 * variable has to keep it. */
static void use(fp3_cut_plan *c, uint32_t node, uint32_t when) {
    const uint32_t op = fp3_cut_node(c, node)->op, phase = when / FP3_CUT_SLOTS;
    const int is_here =
        op != NODE_VARIABLE && op != NODE_WORST && !fp3_dag_is_fold(op) && c->when[node] == when;
    if (op == NODE_KNOWN || is_here || fp3_cut_holds(c, node, phase) != FP3_NONE)
        return;
    c->is_held[node] = 1;
    if (when > c->until[node])
        c->until[node] = when;
}

/* What the loop of a sum reads from outside. */
static void use_outside(fp3_cut_plan *c, uint32_t term, uint32_t when) {
    char *is_in = calloc(c->g->count + 1u, 1);
    if (!is_in) {
        c->has_failed = 1;
        return;
    }
    is_in[term] = 1;
    for (uint32_t i = term + 1; i-- > 0;) {
        uint32_t list[FP3_CUT_OPERANDS];
        if (is_in[i] && !c->is_body[i] && !fp3_cut_is_neighbours(fp3_cut_node(c, i)->op))
            use(c, i, when);
        const unsigned count = is_in[i] && c->is_body[i] ? fp3_cut_operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            is_in[list[k]] = 1;
    }
    free(is_in);
}

/* Which node a variable gets at the end of a phase; FP3_NONE: it keeps what it has. */
uint32_t fp3_cut_gets(const fp3_cut_plan *c, uint32_t phase, uint32_t variable) {
    const uint32_t now = *held(c, phase, variable);
    const uint32_t next = phase + 1 < c->phase_count ? *held(c, phase + 1, variable)
                                                     : c->step->variables[variable].next;
    return next == now ? FP3_NONE : next;
}

static uint32_t end_of(const fp3_cut_plan *c, uint32_t phase) {
    return phase * FP3_CUT_SLOTS + c->slots[phase];
}

/* The section that writes the variable which keeps a node: a sum begins before its loop, and the
 * value of a variable at the beginning of the step is copied at the end of the first phase. */
static uint32_t written(const fp3_cut_plan *c, uint32_t node) {
    return fp3_dag_is_fold(fp3_cut_node(c, node)->op)   ? c->when[node] - 1
           : fp3_cut_node(c, node)->op == NODE_VARIABLE ? end_of(c, 0)
           : is_worst(c, node)                          ? end_of(c, phase_of(c, node) - 1)
                                                        : c->when[node];
}

static void find_uses(fp3_cut_plan *c) {
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t list[FP3_CUT_OPERANDS];
        if (!c->is_needed[i] || c->is_body[i])
            continue;
        if (fp3_dag_is_fold(fp3_cut_node(c, i)->op)) {
            c->is_held[i] = 1; /* the fold grows there, from its start on */
            use(c, fp3_cut_node(c, i)->b, c->when[i] - 1);
            if (c->when[i] > c->until[i])
                c->until[i] = c->when[i];
            use_outside(c, fp3_cut_node(c, i)->a, c->when[i]);
            continue;
        }
        const unsigned count = fp3_cut_operands(c, i, list);
        for (unsigned k = 0; k < count; k++)
            use(c, list[k], is_worst(c, i) ? written(c, i) : c->when[i]);
    }
    for (uint32_t k = 0; k < c->step->kept_count; k++)
        use_outside(c, c->step->kept[k].node, c->kept);
    for (uint32_t p = 0; p < c->phase_count; p++)
        for (uint32_t v = 0; v < c->own; v++)
            if (fp3_cut_gets(c, p, v) != FP3_NONE)
                use(c, fp3_cut_gets(c, p, v), end_of(c, p));
}

int fp3_cut_is_taken(const fp3_cut_plan *c, uint32_t variable, uint32_t from, uint32_t to) {
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_held[i] && c->holder[i] == variable && written(c, i) < to && from < c->until[i])
            return 1;
    return 0;
}

uint32_t fp3_cut_pool(fp3_cut_plan *c) {
    if (c->pool_count == 2 * FP3_STATES_MAX) {
        c->has_failed = 1;
        return 0;
    }
    return c->pool[c->pool_count++] = fp3_cut_variable(c, ROLE_CARRIED, FP3_NONE);
}

/* A variable that keeps nothing from the end of one section to the end of another. */
static uint32_t free_one(fp3_cut_plan *c, uint32_t from, uint32_t to) {
    uint32_t n = 0;
    while (n < c->pool_count && fp3_cut_is_taken(c, c->pool[n], from, to))
        n++;
    return n < c->pool_count ? c->pool[n] : fp3_cut_pool(c);
}

static void find_holders(fp3_cut_plan *c) {
    for (uint32_t when = 0; when < FP3_CUT_PHASES * FP3_CUT_SLOTS; when++)
        for (uint32_t i = 0; !c->has_failed && i < c->g->count; i++)
            if (c->is_held[i] && written(c, i) == when)
                c->holder[i] = is_worst(c, i)
                                   ? fp3_cut_variable(c, ROLE_WORST, fp3_cut_node(c, i)->c)
                                   : free_one(c, when, c->until[i]);
}

/* Params of neighbours are words of their records, so they are params of the program. */
static void know_params(fp3_cut_plan *c) {
    const fp3_model *model = c->step->model;
    for (uint32_t i = 0; i < c->g->count; i++) {
        uint32_t e = 0;
        if (!c->is_needed[i] || fp3_cut_node(c, i)->op != NODE_OTHER_PARAM)
            continue;
        while (model->exprs[e].op != FP3_EXPR_PARAM ||
               model->exprs[e].index != fp3_cut_node(c, i)->a)
            e++; /* the language has made one beside that of the neighbour */
        fp3_known_seen(&c->step->known, e);
    }
}

/* ---- the interface ---- */

fp3_status fp3_cut_fits(const fp3_cut_plan *c, fp3_error *error) {
    return c->has_failed ? fp3_fail(error, FP3_E_LIMIT,
                                    "a step keeps more than %d values from one part to another",
                                    2 * FP3_STATES_MAX)
                         : FP3_OK;
}

static fp3_status make(fp3_cut_plan *c, fp3_error *error) {
    fp3_status status = find_when(c, error);
    if (!status && c->step->kept_count)
        status = find_kept(c, error);
    if (status)
        return status;
    find_needed(c);
    if (c->refine)
        status = c->refine(c, error);
    if (status)
        return status;
    count_all(c);
    if (c->base + c->phase_count > FP3_CUT_PHASES)
        return too_many(error);
    mark_kept(c);
    know_params(c);
    c->held = fp3_cut_filled((size_t)c->phase_count * c->own);
    if (!c->held)
        return fp3_no_memory(error);
    find_held(c);
    find_uses(c);
    find_holders(c);
    return fp3_cut_fits(c, error);
}

fp3_status fp3_cut_plan_make(fp3_cut_plan *c, fp3_error *error) {
    c->g = &c->step->values;
    const size_t nodes = c->g->count;
    c->words = 2 * c->step->model->state_count;
    c->published = c->handled = 0;
    memset(c->slots, 0, sizeof c->slots);
    c->when = calloc(nodes + 1, sizeof *c->when);
    c->is_body = calloc(nodes + 1, 1);
    c->is_needed = calloc(nodes + 1, 1);
    c->is_held = calloc(nodes + 1, 1);
    c->in_kept = calloc(nodes + 1, 1);
    c->holder = fp3_cut_filled(nodes);
    c->until = calloc(nodes + 1, sizeof *c->until);
    c->shown = fp3_cut_filled((size_t)FP3_CUT_PHASES * c->words);
    return c->when && c->is_body && c->is_needed && c->is_held && c->holder && c->until &&
                   c->shown && c->in_kept
               ? make(c, error)
               : fp3_no_memory(error);
}

void fp3_cut_plan_close(fp3_cut_plan *c) {
    free(c->when);
    free(c->is_body);
    free(c->is_needed);
    free(c->is_held);
    free(c->in_kept);
    free(c->holder);
    free(c->until);
    free(c->shown);
    free(c->held);
    c->when = c->holder = c->until = c->shown = c->held = NULL;
    c->is_body = c->is_needed = c->is_held = c->in_kept = NULL;
}
