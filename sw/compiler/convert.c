/* convert.c - what a step, its first and its last part execute; half, twice and chained products. */
#include "convert.h"

#include <isa.h>
#include <stdlib.h>
#include <string.h>

/* A part of the program: the nodes between its leaves and its roots. */
typedef struct {
    const build *b;
    const graph *g;
    const fp3_config *config;
    chain_policy policy;
    conversion *made;
    fp3_place own;            /* what its operations are called */
    fp3_place variables;      /* and what its variables are */
    const uint32_t *carried;  /* of each node: the variable that stands for it, or FP3_NONE */
    uint32_t *uses;           /* of each node; 0: not needed */
    uint32_t *index;          /* of each node's operation */
    uint32_t *ready;          /* cycles from the beginning, as if nothing else were to do */
    uint32_t *due;            /* by when its users need it, counted in the same way */
    uint32_t one, minus_zero; /* nodes; FP3_NONE: nothing goes the chain's way */
    uint32_t operations;
    char *is_absorbed; /* a product that an addition takes in */
    fp3_op *ops;
    uint32_t count;
} part;

static int has_pass(const build *b, fp3_pass pass) { return (b->passes & FP3_PASS(pass)) != 0; }

static uint32_t *operand(graph_node *n, int i) { return i == 0 ? &n->a : i == 1 ? &n->b : &n->c; }

static int is_leaf(const part *p, uint32_t node) {
    return p->g->nodes[node].op >= NODE_KNOWN || (p->carried && p->carried[node] != FP3_NONE);
}

static void count_uses(part *p) {
    for (uint32_t i = p->g->count; i-- > 0;) {
        graph_node n = p->g->nodes[i];
        for (int j = 0; p->uses[i] && !is_leaf(p, i) && j < 3; j++)
            if (*operand(&n, j) != FP3_NONE)
                p->uses[*operand(&n, j)]++;
    }
}

/* ---- half, twice, chains ---- */

static uint32_t latency(const part *p, uint32_t op) {
    const fp3_config *c = p->config;
    return op == FP3_OP_ADD || op == FP3_OP_SUB ? c->add_latency
           : op == FP3_OP_MUL                   ? c->mul_latency
                                                : c->add_latency + c->mul_latency;
}

static int is_free_product(const part *p, uint32_t node) {
    return !is_leaf(p, node) && p->g->nodes[node].op == FP3_OP_MUL && p->uses[node] == 1;
}

/* The scaled form of op whose second operand is this product, or 0. */
static uint32_t scaled(const part *p, uint32_t op, uint32_t product, uint32_t *other) {
    if (!p->config->scale || !has_pass(p->b, FP3_PASS_SCALE) || !is_free_product(p, product))
        return 0;
    const graph_node *n = &p->g->nodes[product];
    for (int i = 0; i < 2; i++) {
        *other = i ? n->a : n->b;
        const uint32_t factor = i ? n->b : n->a;
        if (fp3_graph_is_number(p->g, factor, 2))
            return op == FP3_OP_ADD ? FP3_OP_ADDT : FP3_OP_SUBT;
        if (fp3_graph_is_number(p->g, factor, 0.5))
            return op == FP3_OP_ADD ? FP3_OP_ADDH : FP3_OP_SUBH;
    }
    return 0;
}

static uint32_t later(uint32_t a, uint32_t b) { return a > b ? a : b; }

static int is_chained(const part *p, uint32_t product, uint32_t base) {
    if (!p->config->chain || !has_pass(p->b, FP3_PASS_CHAIN) || p->policy == CHAIN_NONE ||
        !is_free_product(p, product))
        return 0;
    const graph_node *n = &p->g->nodes[product];
    return p->policy != CHAIN_EARLY || p->config->interleave ||
           p->ready[base] <= later(p->ready[n->a], p->ready[n->b]);
}

/* What becomes of node i = x +/- y, where it may take y in. */
static int absorb(part *p, uint32_t i, uint32_t x, uint32_t y, fp3_op *op, uint32_t at[3]) {
    const graph_node *n = &p->g->nodes[i];
    uint32_t other = 0;
    const uint32_t scale = scaled(p, n->op, y, &other);
    if (scale) {
        op->op = scale;
        at[0] = x, at[1] = other, at[2] = FP3_NONE;
    } else if (is_chained(p, y, x)) {
        op->op = n->op == FP3_OP_ADD ? FP3_OP_MADD : FP3_OP_MSUB;
        at[0] = p->g->nodes[y].a, at[1] = p->g->nodes[y].b, at[2] = x;
    } else
        return 0;
    p->is_absorbed[y] = 1;
    return 1;
}

/* Of two products the later one is taken in: the other has to be there when it begins. */
static int absorb_one(part *p, uint32_t i, fp3_op *op, uint32_t at[3]) {
    const graph_node *n = &p->g->nodes[i];
    if (n->op != FP3_OP_ADD && n->op != FP3_OP_SUB)
        return 0;
    const int turned = n->op == FP3_OP_ADD && p->ready[n->a] > p->ready[n->b];
    const uint32_t first = turned ? n->a : n->b, second = turned ? n->b : n->a;
    return absorb(p, i, second, first, op, at) ||
           (n->op == FP3_OP_ADD && absorb(p, i, first, second, op, at));
}

static int has_slack(const part *p, uint32_t i) {
    const uint32_t chain = p->config->add_latency + p->config->mul_latency;
    return p->policy == CHAIN_LONG || p->due[i] >= p->ready[i] + chain;
}

/* a + b as a + 1 b and a b as -0 + a b: the same bits and flags, as late as a chain. */
static void lengthen(const part *p, uint32_t i, fp3_op *op, uint32_t at[3]) {
    const graph_node *n = &p->g->nodes[i];
    if (p->policy < CHAIN_SLACK || p->one == FP3_NONE || !has_slack(p, i))
        return;
    if (n->op == FP3_OP_ADD || n->op == FP3_OP_SUB) {
        op->op = n->op == FP3_OP_ADD ? FP3_OP_MADD : FP3_OP_MSUB;
        at[0] = n->b, at[1] = p->one, at[2] = n->a;
    } else if (n->op == FP3_OP_MUL) {
        op->op = FP3_OP_MADD;
        at[2] = p->minus_zero;
    }
}

/* What the node is executed as; how many operations that stands for. */
static uint32_t choose(part *p, uint32_t i, fp3_op *op, uint32_t at[3]) {
    const graph_node *n = &p->g->nodes[i];
    op->op = n->op;
    op->note = n->note;
    at[0] = n->a, at[1] = n->b, at[2] = n->c;
    if (absorb_one(p, i, op, at))
        return 2;
    lengthen(p, i, op, at);
    return 1;
}

/* ---- places ---- */

static uint32_t number_bits(double number) {
    const float f = (float)number;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

/* Numbers that are one number in FP32 are one constant. */
static known_slot *same_number(const part *p, const known *k) {
    const known_table *table = &p->b->known;
    for (uint32_t i = 0; k->op == KNOWN_NUMBER && i < table->count; i++)
        if (table->list[i].op == KNOWN_NUMBER && p->made->slots[i].at != FP3_AT_NOWHERE &&
            number_bits(table->list[i].number) == number_bits(k->number))
            return &p->made->slots[i];
    return NULL;
}

static fp3_ref known_ref(part *p, uint32_t id) {
    const known *k = &p->b->known.list[id];
    known_slot *slot = &p->made->slots[id];
    fp3_step *step = &p->made->step;
    if (slot->at == FP3_AT_NOWHERE) {
        const known_slot *same = same_number(p, k);
        if (same)
            *slot = *same;
        else if (k->is_shared) {
            *slot = (known_slot){FP3_AT_CONSTANT, step->constant_count};
            p->made->constants[step->constant_count++] = id;
        } else {
            *slot = (known_slot){FP3_AT_PARAM, step->param_count};
            p->made->params[step->param_count++] = id;
        }
    }
    return (fp3_ref){slot->at, slot->index};
}

static fp3_ref ref(part *p, uint32_t node) {
    if (node == FP3_NONE)
        return (fp3_ref){FP3_AT_NOWHERE, 0};
    if (p->carried && p->carried[node] != FP3_NONE)
        return (fp3_ref){p->variables, p->carried[node]};
    const graph_node *n = &p->g->nodes[node];
    if (n->op == NODE_KNOWN)
        return known_ref(p, n->a);
    if (n->op == NODE_VARIABLE)
        return (fp3_ref){p->variables, n->a};
    return (fp3_ref){p->own, p->index[node]};
}

/* ---- parts ---- */

static int open_part(part *p) {
    const size_t count = p->g->count + 1u;
    p->uses = calloc(count, sizeof *p->uses);
    p->index = calloc(count, sizeof *p->index);
    p->ready = calloc(count, sizeof *p->ready);
    p->due = calloc(count, sizeof *p->due);
    p->is_absorbed = calloc(count, 1);
    p->ops = calloc(count, sizeof *p->ops);
    return p->uses && p->index && p->ready && p->due && p->is_absorbed && p->ops;
}

static void close_part(part *p) {
    free(p->uses);
    free(p->index);
    free(p->ready);
    free(p->due);
    free(p->is_absorbed);
}

static void find_ready(part *p) {
    for (uint32_t i = 0; i < p->g->count; i++) {
        graph_node n = p->g->nodes[i];
        if (!p->uses[i] || is_leaf(p, i))
            continue;
        for (int j = 0; j < 3; j++)
            if (*operand(&n, j) != FP3_NONE)
                p->ready[i] = later(p->ready[i], p->ready[*operand(&n, j)]);
        p->ready[i] += latency(p, n.op);
    }
}

/* As late as the longest path through the part allows. */
static void find_due(part *p) {
    uint32_t longest = 0;
    for (uint32_t i = 0; i < p->g->count; i++)
        longest = later(longest, p->ready[i]);
    for (uint32_t i = 0; i < p->g->count; i++)
        p->due[i] = longest;
    for (uint32_t i = p->g->count; i-- > 0;) {
        graph_node n = p->g->nodes[i];
        for (int j = 0; p->uses[i] && !is_leaf(p, i) && j < 3; j++) {
            const uint32_t at = *operand(&n, j), due = p->due[i] - latency(p, n.op);
            if (at != FP3_NONE && due < p->due[at])
                p->due[at] = due;
        }
    }
}

/* The operations of a part, roots counted as used by the caller. Which products are taken in is decided by
 * their users, which come after them: first who, then what. */
static void make_ops(part *p) {
    count_uses(p);
    find_ready(p);
    find_due(p);
    for (uint32_t i = p->g->count; i-- > 0;) {
        fp3_op op;
        uint32_t at[3];
        if (p->uses[i] && !is_leaf(p, i) && !p->is_absorbed[i])
            choose(p, i, &op, at);
    }
    for (uint32_t i = 0; i < p->g->count; i++) {
        fp3_op op = {0};
        uint32_t at[3];
        if (!p->uses[i] || is_leaf(p, i) || p->is_absorbed[i])
            continue;
        p->operations += choose(p, i, &op, at);
        op.a = ref(p, at[0]);
        op.b = ref(p, at[1]);
        op.c = ref(p, at[2]);
        p->index[i] = p->count;
        p->ops[p->count++] = op;
    }
}

static uint32_t *find_carried(const build *b) {
    uint32_t *carried = malloc((b->g.count + 1u) * sizeof *carried);
    for (uint32_t i = 0; carried && i < b->g.count; i++)
        carried[i] = FP3_NONE;
    for (uint32_t i = 0; carried && i < b->variable_count; i++)
        if (b->variables[i].role == ROLE_CARRIED)
            carried[b->variables[i].first] = i;
    return carried;
}

static void convert_step(part *p) {
    const build *b = p->b;
    for (uint32_t i = 0; i < b->variable_count; i++)
        p->uses[b->variables[i].next]++;
    make_ops(p);
    for (uint32_t i = 0; i < b->variable_count; i++)
        p->made->step.variables[i].next = ref(p, b->variables[i].next);
    p->made->step.step = p->ops;
    p->made->step.step_count = p->count;
    p->made->operations = p->operations;
}

static void convert_first(part *p) {
    const build *b = p->b;
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == ROLE_CARRIED)
            p->uses[b->variables[i].first]++;
    make_ops(p);
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == ROLE_CARRIED)
            p->made->step.variables[i].first = ref(p, b->variables[i].first);
    p->made->step.first = p->ops;
    p->made->step.first_count = p->count;
}

static void convert_last(part *p) {
    const build *b = p->b;
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].last != FP3_NONE)
            p->uses[b->variables[i].last]++;
    make_ops(p);
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].last != FP3_NONE)
            p->made->step.variables[i].last = ref(p, b->variables[i].last);
    p->made->step.last = p->ops;
    p->made->step.last_count = p->count;
}

static int convert_parts(const build *b, const fp3_config *config, chain_policy policy,
                         conversion *made, const uint32_t *carried) {
    part parts[] = {
        {.g = &b->g, .own = FP3_AT_OP, .variables = FP3_AT_VARIABLE, .carried = carried},
        {.g = &b->g, .own = FP3_AT_FIRST, .variables = FP3_AT_VARIABLE},
        {.g = &b->last, .own = FP3_AT_LAST, .variables = FP3_AT_NEXT}};
    static void (*const convert[])(part *) = {convert_step, convert_first, convert_last};
    int is_open = 1;
    for (int i = 0; i < 3; i++) {
        parts[i].b = b;
        parts[i].config = config;
        parts[i].policy = policy;
        parts[i].made = made;
        parts[i].one = i ? FP3_NONE : b->one; /* what runs once may wait */
        parts[i].minus_zero = b->minus_zero;
        is_open = open_part(&parts[i]) && is_open;
        if (is_open)
            convert[i](&parts[i]);
        else
            free(parts[i].ops);
        close_part(&parts[i]);
    }
    return is_open;
}

fp3_status fp3_convert(const build *b, const fp3_config *config, chain_policy policy,
                       conversion *made, fp3_error *error) {
    const size_t known = b->known.count + 1u;
    *made = (conversion){.slots = calloc(known, sizeof *made->slots),
                         .params = calloc(known, sizeof *made->params),
                         .constants = calloc(known, sizeof *made->constants)};
    made->step.variables = calloc(b->variable_count + 1u, sizeof *made->step.variables);
    made->step.variable_count = b->variable_count;
    made->step.minus_zero = FP3_NONE_INDEX;
    made->step.allow_ahead = has_pass(b, FP3_PASS_AHEAD);
    uint32_t *carried = find_carried(b);
    const int is_made = made->slots && made->params && made->constants && made->step.variables &&
                        carried && convert_parts(b, config, policy, made, carried);
    free(carried);
    if (!is_made)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; i < made->step.constant_count; i++)
        if (b->known.list[made->constants[i]].op == KNOWN_NUMBER &&
            number_bits(b->known.list[made->constants[i]].number) == number_bits(-0.0))
            made->step.minus_zero = i;
    return FP3_OK;
}

void fp3_convert_close(conversion *made) {
    free(made->slots);
    free(made->params);
    free(made->constants);
    free(made->step.first);
    free(made->step.step);
    free(made->step.last);
    free(made->step.variables);
    *made = (conversion){0};
}
