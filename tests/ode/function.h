/* function.h - a function of x, of a, of a parameter n and of root, which is sqrt(x), as the
 * compiler makes it: compiled as a step of y' = f(x), and its operations carried out one by one. */
#ifndef FP3_TESTS_FUNCTION_H
#define FP3_TESTS_FUNCTION_H

#include <base/bits.h>
#include <compiler/compiled.h>
#include <fp3/compile.h>
#include <fp3/isa.h>
#include <machine/execute.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_MAX = 400 };

static inline void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(1);
}

/* ---- what is computed ---- */

typedef struct {
    fp3_model *model;
    fp3_compiled *compiled;
    const dag *g;
    uint32_t root;
    uint32_t known_bits[NODES_MAX]; /* of each node that is one */
    uint32_t x, a;                  /* which variables */
} program;

static inline void evaluate_known(program *p, double n) {
    const fp3_step *step = &((const fp3_compilation *)p->compiled->self)->reference;
    fp3_error error;
    double *known = calloc(step->known.count + 1u, sizeof *known);
    if (!known || fp3_known_evaluate(&step->known, &n, 1, 0, known, &error))
        fail("known values", "not computed");
    for (uint32_t i = 0; i < p->g->count; i++)
        if (p->g->nodes[i].op == NODE_KNOWN)
            p->known_bits[i] = fp3_bits_of((float)known[p->g->nodes[i].a]);
    free(known);
}

/* What the machine does beside f is what it does for y' = x: see own_instructions. */
static inline void make(program *p, const char *expression, double n, const char *config) {
    char source[512], *report = NULL;
    fp3_error error;
    fp3_integrator *euler = NULL;
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    snprintf(source, sizeof source,
             "param n = 1\nstate x = 1\nstate y = 0\nstate a = 1\nstep 1\nspan 1\nroot = sqrt(x)\n"
             "x' = 0\na' = 0\ny' = %s\n",
             expression);
    *p = (program){0};
    if (fp3_model_read(source, strlen(source), expression, &p->model, &report, &error) ||
        fp3_integrator_find("euler", &euler, &error) ||
        fp3_compile(p->model, euler, &def, &p->compiled, &error))
        fail(expression, error.text);
    fp3_integrator_free(&euler);
    const fp3_step *step = &((const fp3_compilation *)p->compiled->self)->reference;
    p->g = &step->values;
    if (p->g->count > NODES_MAX)
        fail(expression, "too many operations");
    p->x = fp3_step_find(step, ROLE_STATE, 0);
    p->a = fp3_step_find(step, ROLE_STATE, 2);
    p->root = step->variables[fp3_step_find(step, ROLE_STATE, 1)].next;
    evaluate_known(p, n);
}

static inline void end(program *p);

/* Of f alone, with all products chained, and no copy of a state. */
static inline unsigned own_instructions(const char *expression) {
    program full, bare;
    make(&full, expression, 0, "many_full");
    make(&bare, "x", 0, "many_full");
    const fp3_compiled *with = full.compiled, *without = bare.compiled;
    const unsigned count =
        with->instructions - with->copies - (without->instructions - without->copies);
    end(&full);
    end(&bare);
    return count;
}

static inline void end(program *p) {
    fp3_compiled_free(&p->compiled);
    fp3_model_free(&p->model);
}

/* y is -0: then y + 1 f is f. */
static inline uint32_t leaf_bits(const program *p, uint32_t node, float x) {
    const dag_node *n = &p->g->nodes[node];
    return n->op == NODE_KNOWN ? p->known_bits[node] : n->a == p->x ? fp3_bits_of(x) : 0x80000000u;
}

/* The bits of every node, of these x and a. */
static inline void execute_all(const program *p, const fp3_config *config, uint32_t x, uint32_t a,
                               uint32_t *flags, uint32_t value[NODES_MAX]) {
    uint32_t raised;
    *flags = 0;
    for (uint32_t i = 0; i < p->g->count; i++) {
        const dag_node *n = &p->g->nodes[i];
        if (n->op >= NODE_KNOWN) {
            value[i] =
                n->op == NODE_VARIABLE && n->a == p->a ? a : leaf_bits(p, i, fp3_value_of(x));
            continue;
        }
        const uint32_t operand[3] = {value[n->a], n->b == FP3_NONE ? 0 : value[n->b],
                                     n->c == FP3_NONE ? 0 : value[n->c]};
        value[i] = fp3_execute(config, n->op, operand, &raised);
        *flags |= raised;
    }
}

/* The bits of f of these x and a. */
static inline uint32_t execute_on(const program *p, const fp3_config *config, uint32_t x,
                                  uint32_t a, uint32_t *flags) {
    uint32_t value[NODES_MAX] = {0};
    execute_all(p, config, x, a, flags, value);
    return value[p->root];
}

static inline float by_execute(const program *p, float x, uint32_t *flags) {
    static const fp3_config ieee = {.nearest = 1, .subnormal = 1, .fraction = 23, .flags = 1};
    return fp3_value_of(execute_on(p, &ieee, fp3_bits_of(x), 0, flags));
}

#endif
