/* SPDX-License-Identifier: Apache-2.0 */
/* cut.c - the sections of a step, as the plan has them. */
#include "cut.h"

#include "compiler/pairs/double_single.h"
#include "sink.h"
#include "tell.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>

/* ---- sections ---- */

typedef struct {
    fp3_cut_plan *c;
    fp3_section *s;
    uint32_t slot;
    uint32_t *made; /* of each node of the step: that of the section */
} builder;

static uint32_t put(builder *b, uint32_t node);

/* A node that has been computed before this section. */
static uint32_t from_outside(builder *b, uint32_t node) {
    fp3_cut_plan *c = b->c;
    const dag_node *n = fp3_cut_node(c, node);
    if (n->op == NODE_KNOWN)
        return fp3_dag_known(&b->s->values, n->a);
    const uint32_t variable = fp3_cut_holds(c, node, b->s->phase);
    return fp3_dag_variable(&b->s->values, variable != FP3_NONE ? variable : c->holder[node]);
}

static int is_here(const builder *b, uint32_t node) {
    const fp3_cut_plan *c = b->c;
    const uint32_t op = fp3_cut_node(c, node)->op;
    if (fp3_dag_is_leaf(c->g, node) || fp3_dag_is_fold(op) || op == NODE_WORST)
        return 0;
    return b->s->relation != FP3_NONE ? c->is_body[node]
                                      : c->when[node] == b->s->phase * FP3_CUT_SLOTS + b->slot;
}

/* Operands stand before the node: they are made, since nodes are put in their order. */
static uint32_t put(builder *b, uint32_t node) {
    const dag_node *n = fp3_cut_node(b->c, node);
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
    assert(b->s->next[variable] == FP3_NONE);
    b->s->next[variable] = node;
}

static fp3_status open_section(builder *b, fp3_cut_plan *c, fp3_cut *cut, uint32_t phase,
                               uint32_t slot, uint32_t relation, fp3_error *error) {
    fp3_section *more = realloc(cut->sections, (cut->section_count + 1u) * sizeof *more);
    if (!more)
        return fp3_no_memory(error);
    cut->sections = more;
    fp3_section *s = &more[cut->section_count++];
    *s = (fp3_section){.phase = phase, .relation = relation};
    fp3_dag_open(&s->values, &c->step->known, 0);
    s->next = fp3_cut_filled(2 * FP3_STATES_MAX);
    s->loads = calloc(c->g->count + c->step->kept_count + 1u, sizeof *s->loads);
    s->stores = calloc(c->step->kept_count + 1u, sizeof *s->stores);
    *b = (builder){.c = c, .s = s, .slot = slot, .made = fp3_cut_filled(c->g->count)};
    return s->next && s->loads && s->stores && b->made ? FP3_OK : fp3_no_memory(error);
}

/* Nodes in their order: a deep sum is not a deep recursion. */
static void put_all(builder *b) {
    const fp3_cut_plan *c = b->c;
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && b->s->relation == FP3_NONE && !c->is_body[i] && is_here(b, i))
            put(b, i);
}

static fp3_status straight(fp3_cut_plan *c, fp3_cut *cut, uint32_t phase, uint32_t slot,
                           fp3_error *error) {
    builder b = {0};
    fp3_status status = open_section(&b, c, cut, phase, slot, FP3_NONE, error);
    if (status) {
        free(b.made);
        return status;
    }
    put_all(&b);
    for (uint32_t i = 0; i < c->g->count; i++) {
        const int is_total = fp3_dag_is_fold(fp3_cut_node(c, i)->op);
        if (!c->is_held[i])
            continue;
        if (is_total && c->when[i] == phase * FP3_CUT_SLOTS + slot + 1)
            write(&b, c->holder[i], put(&b, fp3_cut_node(c, i)->b));
        else if (fp3_cut_node(c, i)->op == NODE_WORST) {
            if (slot == c->slots[phase] && c->when[i] == (phase + 1) * FP3_CUT_SLOTS)
                write(&b, c->holder[i], put(&b, fp3_cut_node(c, i)->a));
        } else if (!is_total && is_here(&b, i))
            write(&b, c->holder[i], put(&b, i));
        else if (fp3_cut_node(c, i)->op == NODE_VARIABLE && phase == 0 && slot == c->slots[0])
            write(&b, c->holder[i], fp3_dag_variable(&b.s->values, fp3_cut_node(c, i)->a));
    }
    for (uint32_t v = 0; slot == c->slots[phase] && v < c->own; v++)
        if (fp3_cut_gets(c, phase, v) != FP3_NONE)
            write(&b, v, put(&b, fp3_cut_gets(c, phase, v)));
    free(b.made);
    return FP3_OK;
}

/* The variable that a word of the neighbour is loaded to: nothing is kept there while the loop
 * runs. */
static uint32_t loaded(builder *b, uint32_t op, uint32_t index, uint32_t word) {
    fp3_cut_plan *c = b->c;
    fp3_section *s = b->s;
    const uint32_t now = s->phase * FP3_CUT_SLOTS + b->slot;
    uint32_t at = 0;
    for (uint32_t i = 0; i < s->load_count; i++)
        if (s->loads[i].op == op && s->loads[i].index == index && s->loads[i].word == word)
            return s->loads[i].variable;
    for (uint32_t used = 0; at < c->pool_count; at++, used = 0) {
        for (uint32_t i = 0; i < s->load_count; i++)
            used |= s->loads[i].variable == c->pool[at];
        if (!used && !fp3_cut_is_taken(c, c->pool[at], now - 1, now + 1))
            break;
    }
    const uint32_t variable = at < c->pool_count ? c->pool[at] : fp3_cut_pool(c);
    s->loads[s->load_count++] = (fp3_loaded){variable, op, index, word};
    return variable;
}

/* Whether the loop over a relation writes this field. */
static int keeps(const fp3_cut_plan *c, const fp3_kept *kept, uint32_t when, uint32_t relation) {
    return c->kept == when && kept->relation == relation;
}

/* The variable to which a field is loaded becomes what is written. */
static void keep(builder *b, const fp3_kept *kept) {
    fp3_section *s = b->s;
    const uint32_t variable = loaded(b, NODE_FIELD, kept->field, kept->word);
    write(b, variable, put(b, kept->node));
    s->stores[s->store_count++] = (fp3_loaded){variable, NODE_FIELD, kept->field, kept->word};
}

/* What a fold has when a term has joined it. */
static void grow(builder *b, uint32_t fold) {
    const fp3_cut_plan *c = b->c;
    dag *g = &b->s->values;
    const uint32_t sum = fp3_dag_variable(g, c->holder[fold]);
    const uint32_t term = put(b, fp3_cut_node(c, fold)->a);
    g->note = fp3_cut_node(c, fold)->note;
    /* A least or a most is operand b: a term that is equal or a NaN leaves it alone, in every
     * bit. */
    const uint32_t op = fp3_cut_fold_op(c, fold);
    write(b, c->holder[fold],
          op == FP3_OP_ADD ? fp3_dag_make(g, op, sum, term, FP3_NONE)
                           : fp3_dag_make(g, op, term, sum, FP3_NONE));
}

/* Likewise, of pairs. */
static void grow_pair(builder *b, uint32_t fold) {
    const fp3_cut_plan *c = b->c;
    dag *g = &b->s->values;
    const fp3_pair sum = {fp3_dag_variable(g, c->holder[fold]),
                          fp3_dag_variable(g, c->holder[fold + 1])};
    const uint32_t low = put(b, fp3_cut_node(c, fold + 1)->a);
    const fp3_pair term = {put(b, fp3_cut_node(c, fold)->a),
                           fp3_dag_is_number(g, low, 0) ? FP3_NONE : low};
    const uint32_t op = fp3_cut_fold_op(c, fold);
    fp3_pair now;
    g->note = fp3_cut_node(c, fold)->note;
    if (op == FP3_OP_ADD)
        now = fp3_pair_add(g, sum, term);
    else
        now = fp3_pair_select(g,
                              op == FP3_OP_MIN ? fp3_pair_less(g, term, sum).high
                                               : fp3_pair_less(g, sum, term).high,
                              term, sum);
    write(b, c->holder[fold], now.high);
    write(b, c->holder[fold + 1], now.low);
}

static fp3_status loop(fp3_cut_plan *c, fp3_cut *cut, uint32_t phase, uint32_t slot,
                       uint32_t relation, fp3_error *error) {
    builder b = {0};
    fp3_status status = open_section(&b, c, cut, phase, slot, relation, error);
    char *is_in = calloc(c->g->count + 1u, 1);
    if (!is_in && !status)
        status = fp3_no_memory(error);
    const uint32_t now = phase * FP3_CUT_SLOTS + slot;
    for (uint32_t k = 0; !status && k < c->step->kept_count; k++)
        if (keeps(c, &c->step->kept[k], now, relation))
            is_in[c->step->kept[k].node] = 1;
    for (uint32_t i = c->g->count; !status && i-- > 0;) {
        uint32_t list[FP3_CUT_OPERANDS];
        const dag_node *n = fp3_cut_node(c, i);
        const int is_total = fp3_dag_is_fold(n->op);
        if (is_total && c->is_needed[i] && c->when[i] == phase * FP3_CUT_SLOTS + slot &&
            fp3_dag_relation(c->g, i) == relation)
            is_in[n->a] = 1;
        const unsigned count = is_in[i] && c->is_body[i] ? fp3_cut_operands(c, i, list) : 0;
        for (unsigned k = 0; k < count; k++)
            is_in[list[k]] = 1;
    }
    for (uint32_t i = 0; !status && i < c->g->count; i++) {
        const dag_node *n = fp3_cut_node(c, i);
        if (is_in[i] && fp3_cut_is_neighbours(n->op))
            b.made[i] = fp3_dag_variable(&b.s->values, loaded(&b, n->op, n->a, n->c));
        else if (is_in[i] && c->is_body[i])
            put(&b, i);
        if (!fp3_dag_is_fold(n->op) || n->op == NODE_SECOND || !c->is_needed[i] ||
            c->when[i] != phase * FP3_CUT_SLOTS + slot || fp3_dag_relation(c->g, i) != relation)
            continue;
        if (fp3_dag_has_second(c->g, i))
            grow_pair(&b, i);
        else
            grow(&b, i);
    }
    for (uint32_t k = 0; !status && k < c->step->kept_count; k++)
        if (keeps(c, &c->step->kept[k], now, relation))
            keep(&b, &c->step->kept[k]);
    free(is_in);
    free(b.made);
    return status;
}

static int has_loop(const fp3_cut_plan *c, uint32_t when, uint32_t relation) {
    for (uint32_t i = 0; i < c->g->count; i++)
        if (c->is_needed[i] && fp3_dag_is_fold(fp3_cut_node(c, i)->op) && c->when[i] == when &&
            fp3_dag_relation(c->g, i) == relation)
            return 1;
    for (uint32_t k = 0; k < c->step->kept_count; k++)
        if (keeps(c, &c->step->kept[k], when, relation))
            return 1;
    return 0;
}

static fp3_status make_sections(fp3_cut_plan *c, fp3_cut *cut, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t p = 0; p < c->phase_count; p++)
        for (uint32_t slot = 0; !status && slot <= c->slots[p]; slot++) {
            if (slot % 2 == 0)
                status = straight(c, cut, p, slot, error);
            for (uint32_t r = 0; !status && slot % 2 && r < c->step->model->relation_count; r++)
                if (has_loop(c, p * FP3_CUT_SLOTS + slot, r))
                    status = loop(c, cut, p, slot, r, error);
        }
    return status;
}

static void make_lists(fp3_cut_plan *c, fp3_cut *cut) {
    for (uint32_t r = 0; r < c->step->model->relation_count; r++) {
        int is_used = 0;
        if (cut->list[r] != FP3_NONE)
            continue;
        for (uint32_t i = 0; i < c->g->count; i++)
            is_used |= c->is_needed[i] && fp3_dag_is_fold(fp3_cut_node(c, i)->op) &&
                       fp3_dag_relation(c->g, i) == r;
        for (uint32_t k = 0; k < c->step->kept_count; k++)
            is_used |= c->step->kept[k].relation == r;
        if (is_used)
            cut->list[r] = fp3_cut_variable(c, ROLE_LIST, r);
    }
}

/* How many of the words of a field it loads. */
static uint32_t has_field(const fp3_section *s, uint32_t field) {
    uint32_t words = 0;
    for (uint32_t i = 0; i < s->load_count; i++)
        words += s->loads[i].op == NODE_FIELD && s->loads[i].index == field;
    return words;
}

/* A loop leaves out a field that another one over the same list reads, or a word of one. */
static int needs_unused(const fp3_cut *cut, uint32_t words) {
    for (uint32_t i = 0; i < cut->section_count; i++)
        for (uint32_t j = 0; j < cut->section_count; j++)
            for (uint32_t k = 0; k < cut->sections[j].load_count; k++)
                if (cut->sections[i].relation == cut->sections[j].relation &&
                    cut->sections[j].loads[k].op == NODE_FIELD &&
                    has_field(&cut->sections[i], cut->sections[j].loads[k].index) < words)
                    return 1;
    return 0;
}

/* ---- the interface ---- */

/* What the step has is the segment's, and the other way round. */
static void exchange(fp3_step *step, fp3_segment *s, uint32_t variables) {
    const dag values = step->values;
    const fp3_sight sight = step->sight;
    step->values = s->values;
    step->sight = s->sight;
    s->values = values;
    s->sight = sight;
    for (uint32_t i = 0; i < variables; i++) {
        const uint32_t next = step->variables[i].next;
        step->variables[i].next = s->next[i];
        s->next[i] = next;
    }
}

/* Whether nothing is left for the end of a step in segments. */
static int is_nothing(const fp3_cut_plan *plan) {
    const fp3_step *step = plan->step;
    int is = step->segment_count && !step->kept_count && !step->sight.count;
    for (uint32_t i = 0; is && i < plan->own; i++)
        is = step->variables[i].next == FP3_NONE ||
             step->variables[i].next == fp3_dag_find(plan->g, NODE_VARIABLE, i, FP3_NONE, FP3_NONE);
    return is;
}

/* What the step has now: its phases behind those that were cut before. times: as of fp3_segment. */
static fp3_status cut_part(fp3_cut_plan *plan, uint32_t times, fp3_cut *cut, fp3_error *error) {
    const uint32_t first = cut->section_count;
    plan->base = cut->phase_count;
    fp3_status status = fp3_cut_plan_make(plan, error);
    if (!status)
        status = fp3_cut_tell(plan, error);
    if (!status)
        status = make_sections(plan, cut, error);
    if (status)
        return status;
    for (uint32_t i = first; i < cut->section_count; i++)
        cut->sections[i].phase += plan->base;
    make_lists(plan, cut);
    cut->published |= plan->published;
    cut->phase_count += plan->phase_count;
    if (times) {
        cut->times[plan->base] = (uint8_t)times;
        cut->returns |= UINT64_C(1) << (cut->phase_count - 1);
    }
    return FP3_OK;
}

static fp3_status cut_segments(fp3_cut_plan *plan, fp3_cut *cut, fp3_error *error) {
    fp3_step *step = plan->step;
    const uint32_t kept_count = step->kept_count;
    fp3_status status = FP3_OK;
    step->kept_count = 0; /* what entries remember comes last */
    for (uint32_t i = 0; !status && i < step->segment_count; i++) {
        fp3_segment *s = &step->segments[i];
        exchange(step, s, plan->own);
        status = cut_part(plan, s->times, cut, error);
        exchange(step, s, plan->own);
        fp3_cut_plan_close(plan);
    }
    step->kept_count = kept_count;
    return status;
}

fp3_status fp3_cut_make(fp3_step *step, fp3_cut *cut, fp3_error *error) {
    fp3_cut_plan plan = {.step = step, .g = &step->values, .own = step->variable_count};
    if (fp3_model_adapted(step->model) != FP3_NONE)
        plan.refine = fp3_cut_sink;
    *cut = (fp3_cut){0};
    for (uint32_t r = 0; r < FP3_RELATIONS_MAX; r++)
        cut->list[r] = FP3_NONE;
    fp3_status status = cut_segments(&plan, cut, error);
    if (!status && !is_nothing(&plan))
        status = cut_part(&plan, 0, cut, error);
    if (!status)
        cut->unused = needs_unused(cut, step->known.words)
                          ? fp3_cut_variable(&plan, ROLE_CARRIED, FP3_NONE)
                          : FP3_NONE;
    if (!status)
        status = fp3_cut_fits(&plan, error);
    fp3_cut_plan_close(&plan);
    return status;
}

void fp3_cut_close(fp3_cut *cut) {
    for (uint32_t i = 0; i < cut->section_count; i++) {
        fp3_dag_close(&cut->sections[i].values);
        free(cut->sections[i].next);
        free(cut->sections[i].loads);
        free(cut->sections[i].stores);
    }
    free(cut->sections);
    *cut = (fp3_cut){0};
}
