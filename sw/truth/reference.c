/* reference.c - what a step means: one operation after the other, in the order of the graph.
 *
 * A sum or a product of two FP32 numbers, in double and then rounded to FP32, is what FP32 gives: 53 bits
 * are at least 2 * 24 + 2 (Figueroa, "When is double rounding innocuous?", 1995).
 */
#include "reference.h"

#include <isa.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine/estimate.h"

typedef struct {
    const build *b;
    int is_exact;
    double *known, *variables, *next, *values;
} runner;

static double rounded(const runner *r, double x) { return r->is_exact ? x : (double)(float)x; }

static double estimate(uint32_t (*of)(uint32_t), double x) {
    float f = (float)x;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    bits = of(bits);
    memcpy(&f, &bits, sizeof bits);
    return f;
}

static double apply(const runner *r, uint32_t op, double a, double b, double c) {
    switch (op) {
    case FP3_OP_ADD:
        return rounded(r, a + b);
    case FP3_OP_SUB:
        return rounded(r, a - b);
    case FP3_OP_MUL:
        return rounded(r, a * b);
    case FP3_OP_MIN:
        return isless(a, b) ? a : b;
    case FP3_OP_MAX:
        return isless(b, a) ? a : b;
    case FP3_OP_ABS:
        return fabs(a);
    case FP3_OP_LT:
        return isless(a, b) ? 1 : 0;
    case FP3_OP_LE:
        return islessequal(a, b) ? 1 : 0;
    case FP3_OP_SEL:
        return c != 0 ? a : b; /* a NaN is not 0 */
    case FP3_OP_RCP:
        return r->is_exact ? 1 / a : estimate(fp3_estimate_rcp, a);
    default:
        if (r->is_exact) /* as the estimate: sqrt(0) is 0 times this */
            return a == 0 ? 0x1p63 : 1 / sqrt(a);
        return estimate(fp3_estimate_rsqrt, a);
    }
}

static void evaluate(const runner *r, const graph *g) {
    double *values = r->values;
    for (uint32_t i = 0; i < g->count; i++) {
        const graph_node *n = &g->nodes[i];
        if (n->op == NODE_KNOWN)
            values[i] = rounded(r, r->known[n->a]);
        else if (n->op == NODE_VARIABLE)
            values[i] = r->variables[n->a];
        else
            values[i] = apply(r, n->op, values[n->a], n->b == FP3_NONE ? 0 : values[n->b],
                              n->c == FP3_NONE ? 0 : values[n->c]);
    }
}

static void step(const runner *r) {
    const build *b = r->b;
    evaluate(r, &b->g);
    for (uint32_t i = 0; i < b->variable_count; i++)
        r->next[i] = r->values[b->variables[i].next];
    memcpy(r->variables, r->next, b->variable_count * sizeof *r->next);
}

/* A run without a step executes no last part. */
static void look(const runner *r, int is_run, double *states) {
    const build *b = r->b;
    evaluate(r, &b->last);
    for (uint32_t i = 0; i < b->variable_count; i++) {
        const variable *v = &b->variables[i];
        if (v->role == ROLE_STATE)
            states[v->state] = is_run && v->last != FP3_NONE ? r->values[v->last] : r->variables[i];
    }
}

fp3_status fp3_reference_run(const build *b, const double *params, double h, int is_exact,
                             double *start, const uint64_t *steps, size_t count, double *states,
                             fp3_error *error) {
    const uint32_t most = b->g.count > b->last.count ? b->g.count : b->last.count;
    runner r = {.b = b,
                .is_exact = is_exact,
                .known = calloc(b->known.count + 1u, sizeof *r.known),
                .variables = start,
                .next = calloc(b->variable_count + 1u, sizeof *r.next),
                .values = calloc(most + 1u, sizeof *r.values)};
    fp3_status status = r.known && r.next && r.values
                            ? fp3_known_evaluate(&b->known, params, h, r.known, error)
                            : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    uint64_t made = 0;
    for (size_t i = 0; !status && i < count; i++) {
        for (; made < steps[i]; made++)
            step(&r);
        look(&r, made > 0, states + i * b->model->state_count);
    }
    free(r.known);
    free(r.next);
    free(r.values);
    return status;
}
