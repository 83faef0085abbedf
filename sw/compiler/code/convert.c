/* SPDX-License-Identifier: Apache-2.0 */
/* convert.c - nodes become operations of the first, the step and the last part. */
#include "convert.h"
#include "base/bits.h"

#include "banks.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"

/* A part of the program: the nodes between its leaves and its roots. */
typedef struct {
    const fp3_step *step;
    conversion *made;
    fp3_part part;
    fp3_place own;           /* how operands name its operations */
    fp3_place variables;     /* and its variables */
    const uint32_t *carried; /* of each node: the variable that stands for it, or FP3_NONE */
    char *is_leaf;
    fp3_choice_of_node *choices;
    uint32_t *index; /* of each node's operation */
    fp3_op *ops;
    uint32_t count, operations;
} converter;

/* ---- places ---- */

/* 0: what it is rounded to stands for another number, and is refused where it is named. */
static int fits(double number) {
    float single;
    return !fp3_number_single(number, &single);
}

/* Numbers that are the same number in FP32 are one constant. */
static known_slot *same_number(const converter *c, const known *k) {
    const known_table *table = &c->step->known;
    for (uint32_t i = 0; k->op == KNOWN_NUMBER && i < table->count; i++)
        if (table->list[i].op == KNOWN_NUMBER && c->made->slots[i].at != FP3_AT_NOWHERE &&
            fits(k->number) && fits(table->list[i].number) &&
            fp3_bits_of((float)table->list[i].number) == fp3_bits_of((float)k->number))
            return &c->made->slots[i];
    return NULL;
}

/* Of h, of -0, which copies read, and of the limit below which objects sleep. */
#define SPARE_CONSTANTS 3

/* A number is in the image, and a step always has the name h: both have no other place. */
static int is_constant(const converter *c, const known *k) {
    const fp3_options *options = c->part.options;
    if (options->has_few_constants && k->op != KNOWN_STEP &&
        c->made->code.constant_count + SPARE_CONSTANTS >= options->config->registers)
        return 0;
    return k->op == KNOWN_NUMBER || k->op == KNOWN_STEP || options->shares_params ||
           (k->is_shared && fp3_has_pass(options, FP3_PASS_SHARE));
}

static fp3_ref place_known(const converter *c, uint32_t id, int is_constant) {
    known_slot *slot = &c->made->slots[id];
    fp3_step_code *code = &c->made->code;
    if (is_constant) {
        *slot = (known_slot){FP3_AT_CONSTANT, code->constant_count};
        c->made->constants[code->constant_count++] = id;
    } else {
        *slot = (known_slot){FP3_AT_PARAM, code->param_count};
        c->made->params[code->param_count++] = id;
    }
    return (fp3_ref){slot->at, slot->index};
}

static fp3_ref known_ref(const converter *c, uint32_t id) {
    const known *k = &c->step->known.list[id];
    known_slot *slot = &c->made->slots[id];
    const known_slot *same = slot->at == FP3_AT_NOWHERE ? same_number(c, k) : NULL;
    if (same)
        *slot = *same;
    return slot->at == FP3_AT_NOWHERE ? place_known(c, id, is_constant(c, k))
                                      : (fp3_ref){slot->at, slot->index};
}

/* The threshold of `sleep` is a constant: a value that is in a register of the object is a
 * constant, too. */
static fp3_ref constant_ref(const converter *c, uint32_t id) {
    const fp3_ref there = known_ref(c, id);
    return there.at == FP3_AT_CONSTANT ? there : place_known(c, id, 1);
}

static fp3_ref ref(const converter *c, uint32_t node) {
    if (node == FP3_NONE)
        return (fp3_ref){FP3_AT_NOWHERE, 0};
    if (c->carried && c->carried[node] != FP3_NONE)
        return (fp3_ref){c->variables, c->carried[node]};
    const dag_node *n = &c->part.g->nodes[node];
    if (n->op == NODE_KNOWN)
        return known_ref(c, n->a);
    if (n->op == NODE_VARIABLE)
        return (fp3_ref){c->variables, n->a};
    assert(c->choices[node].operations); /* what is read is executed, and was before its readers */
    return (fp3_ref){c->own, c->index[node]};
}

/* ---- parts ---- */

static fp3_status open_part(converter *c, fp3_error *error) {
    const dag *g = c->part.g;
    const size_t count = g->count + 1u;
    c->part.uses = calloc(count, sizeof *c->part.uses);
    c->part.is_leaf = c->is_leaf = calloc(count, 1);
    c->choices = calloc(count, sizeof *c->choices);
    c->index = calloc(count, sizeof *c->index);
    c->ops = calloc(count, sizeof *c->ops);
    if (!c->part.uses || !c->is_leaf || !c->choices || !c->index || !c->ops)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < g->count; i++)
        c->is_leaf[i] = fp3_dag_is_leaf(g, i) || (c->carried && c->carried[i] != FP3_NONE);
    return FP3_OK;
}

static void close_part(converter *c) {
    free(c->part.uses);
    free(c->is_leaf);
    free(c->choices);
    free(c->index);
}

static void make_ops(converter *c) {
    for (uint32_t i = 0; i < c->part.g->count; i++) {
        const fp3_choice_of_node *choice = &c->choices[i];
        if (!choice->operations)
            continue;
        c->operations += choice->operations;
        c->index[i] = c->count;
        c->ops[c->count] = (fp3_op){.op = choice->op, .note = c->part.g->nodes[i].note};
        c->ops[c->count].a = ref(c, choice->operand[0]);
        c->ops[c->count].b = ref(c, choice->operand[1]);
        c->ops[c->count].c = ref(c, choice->operand[2]);
        c->count++;
    }
}

/* Roots are nodes of variables: root(v) says where, and *to gets what the code calls it. */
static fp3_status convert_part(converter *c, uint32_t (*root)(const variable *v),
                               fp3_ref *(*to)(fp3_variable *v), fp3_error *error) {
    const fp3_step *step = c->step;
    fp3_status status = open_part(c, error);
    for (uint32_t i = 0; !status && i < step->variable_count; i++)
        if (root(&step->variables[i]) != FP3_NONE)
            c->part.uses[root(&step->variables[i])]++;
    if (!status)
        status = fp3_choices_make(&c->part, c->choices, error);
    if (!status)
        make_ops(c);
    for (uint32_t i = 0; !status && i < step->variable_count; i++)
        if (root(&step->variables[i]) != FP3_NONE)
            *to(&c->made->code.variables[i]) = ref(c, root(&step->variables[i]));
    close_part(c);
    return status;
}

static uint32_t next_root(const variable *v) { return v->next; }
static uint32_t first_root(const variable *v) { return v->first; }
static uint32_t last_root(const variable *v) { return v->last; }
static fp3_ref *next_ref(fp3_variable *v) { return &v->next; }
static fp3_ref *first_ref(fp3_variable *v) { return &v->first; }
static fp3_ref *last_ref(fp3_variable *v) { return &v->last; }

static uint32_t *find_carried(const fp3_step *step) {
    uint32_t *carried = malloc((step->values.count + 1u) * sizeof *carried);
    for (uint32_t i = 0; carried && i < step->values.count; i++)
        carried[i] = FP3_NONE;
    for (uint32_t i = 0; carried && i < step->variable_count; i++)
        if (step->variables[i].role == ROLE_CARRIED)
            carried[step->variables[i].first] = i;
    return carried;
}

/* Known values get their places in the order in which the step, the first and the last part use
 * them. Parts that run once may wait, so their operations are not chained. */
static fp3_status convert_parts(const fp3_part *part, fp3_chain_nodes chain, const fp3_step *step,
                                const uint32_t *carried, conversion *made, fp3_error *error) {
    converter c = {.step = step, .made = made, .part = *part, .variables = FP3_AT_VARIABLE};
    c.part.g = &step->values;
    c.part.one = chain.one;
    c.part.minus_zero = chain.minus_zero;
    converter first = c, last = c;
    first.part.one = last.part.one = FP3_NONE;
    last.part.g = &step->last;
    c.own = FP3_AT_OP, first.own = FP3_AT_FIRST, last.own = FP3_AT_LAST;
    c.carried = carried;
    last.variables = FP3_AT_NEXT;
    fp3_status status = convert_part(&c, next_root, next_ref, error);
    made->code.step = c.ops;
    made->code.step_count = c.count;
    made->operations = c.operations;
    if (!status && step->tested != FP3_NONE && part->options->config->sleep)
        made->least = constant_ref(&c, step->least).index;
    if (!status)
        status = convert_part(&first, first_root, first_ref, error);
    made->code.first = first.ops;
    made->code.first_count = first.count;
    if (!status)
        status = convert_part(&last, last_root, last_ref, error);
    made->code.last = last.ops;
    made->code.last_count = last.count;
    if (!status && part->options->config->dual)
        status = fp3_banks_split(&made->code, ref(&c, chain.one).index,
                                 ref(&c, chain.minus_zero).index, error);
    return status;
}

fp3_status fp3_convert_open(const fp3_step *step, conversion *made, fp3_error *error) {
    const size_t slots = step->known.count + 1u;
    *made = (conversion){.slots = calloc(slots, sizeof *made->slots),
                         .params = calloc(slots, sizeof *made->params),
                         .constants = calloc(slots, sizeof *made->constants)};
    made->code.variables = calloc(step->variable_count + 1u, sizeof *made->code.variables);
    made->code.variable_count = step->variable_count;
    made->code.minus_zero = FP3_NONE_INDEX;
    return made->slots && made->params && made->constants && made->code.variables
               ? FP3_OK
               : fp3_no_memory(error);
}

void fp3_convert_end(const fp3_step *step, conversion *made) {
    for (uint32_t i = 0; i < made->code.constant_count; i++) {
        const known *k = &step->known.list[made->constants[i]];
        if (k->op == KNOWN_NUMBER && fp3_bits_of((float)k->number) == fp3_bits_of((float)-0.0))
            made->code.minus_zero = i;
    }
}

void fp3_convert_seen(const fp3_step *step, const fp3_options *options, conversion *all) {
    for (uint32_t p = 0; step->coupling && p < step->model->param_count; p++)
        for (uint32_t word = 0; step->coupling->params >> p & 1 && word < step->known.words; word++)
            fp3_convert_param(step, options, all, p, word);
}

fp3_status fp3_convert(const fp3_step *step, const fp3_options *options, chain_policy policy,
                       fp3_chain_nodes chain, conversion *made, fp3_error *error) {
    fp3_status status = fp3_convert_open(step, made, error);
    made->code.allow_ahead = fp3_has_pass(options, FP3_PASS_AHEAD);
    made->code.may_spill = options->may_spill;
    if (step->tested != FP3_NONE && options->config->sleep) {
        made->code.tested = UINT64_C(1) << step->tested;
        made->code.slept = UINT64_C(1) << fp3_step_find(step, ROLE_SLEPT, FP3_NONE);
    }
    uint32_t *carried = find_carried(step);
    const fp3_part part = {.options = options, .policy = policy};
    if (!status)
        status = carried ? convert_parts(&part, chain, step, carried, made, error)
                         : fp3_no_memory(error);
    free(carried);
    if (!status)
        fp3_convert_seen(step, options, made);
    if (!status)
        fp3_convert_end(step, made);
    return status;
}

/* ---- a step in sections ---- */

static converter of_section(const fp3_step *step, const fp3_options *options, conversion *all) {
    return (converter){.step = step,
                       .made = all,
                       .part = {.g = &step->values,
                                .options = options,
                                .policy = CHAIN_ALL,
                                .one = FP3_NONE,
                                .minus_zero = FP3_NONE},
                       .own = FP3_AT_OP,
                       .variables = FP3_AT_VARIABLE};
}

fp3_status fp3_convert_section(const fp3_step *section, const fp3_options *options, conversion *all,
                               fp3_step_code *code, fp3_error *error) {
    converter c = of_section(section, options, all);
    fp3_variable *variables = calloc(section->variable_count + 1u, sizeof *variables);
    if (!variables)
        return fp3_no_memory(error);
    memset(all->code.variables, 0, section->variable_count * sizeof *variables);
    const fp3_status status = convert_part(&c, next_root, next_ref, error);
    memcpy(variables, all->code.variables, section->variable_count * sizeof *variables);
    *code = (fp3_step_code){.step = c.ops,
                            .step_count = c.count,
                            .variables = variables,
                            .variable_count = section->variable_count,
                            .minus_zero = FP3_NONE_INDEX};
    all->operations += c.operations;
    return status;
}

uint32_t fp3_convert_param(const fp3_step *step, const fp3_options *options, conversion *all,
                           uint32_t param, uint32_t word) {
    const converter c = of_section(step, options, all);
    const known *list = step->known.list;
    uint32_t id = 0; /* the cut has made it known */
    while (list[id].op != KNOWN_MODEL || step->model->exprs[list[id].a].op != FP3_EXPR_PARAM ||
           step->model->exprs[list[id].a].index != param)
        id++;
    for (uint32_t first = id; word && (list[id].op != KNOWN_LOW || list[id].a != first);)
        id = (id + 1) % step->known.count;
    return known_ref(&c, id).index;
}

void fp3_convert_close(conversion *made) {
    free(made->slots);
    free(made->params);
    free(made->constants);
    free(made->code.first);
    free(made->code.step);
    free(made->code.last);
    free(made->code.variables);
    free(made->code.param_registers);
    *made = (conversion){0};
}
