/* executed_pairs.h - the compiler's arithmetic with pairs of floats, executed as the machine does,
 * and random operands for it. */
#ifndef EXECUTED_PAIRS_H
#define EXECUTED_PAIRS_H

#include <base/bits.h>
#include <compiler/pairs/double_single.h>
#include <fp3/isa.h>
#include <machine/execute.h>

#include <float.h>
#include <fp3/compile.h>
#include <fp3/isa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __float128 quad;

#define U2 0x1p-48

/* An operation: variables 0 .. 3 are the words of its operands. */
typedef struct {
    const char *name;
    fp3_model *model;
    known_table known;
    dag g;
    fp3_pair made;
    fp3_config config;
    uint64_t checked, wrong;
    double worst;
    uint32_t spent;   /* nodes to print; 0: all that there are */
    const char *unit; /* of the worst */
} operation;

static inline void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(1);
}

static inline void open_operation(operation *o, const char *name) {
    static const char source[] = "state x = 0\nstep 1\nx' = 0\n";
    char *report = NULL;
    fp3_error error;
    *o = (operation){.name = name,
                     .unit = "u^2",
                     .config = {.nearest = 1, .subnormal = 1, .fraction = 23, .flags = 1}};
    if (fp3_model_read(source, strlen(source), name, &o->model, &report, &error))
        fail(name, error.text);
    fp3_known_open(&o->known, o->model, 2);
    fp3_dag_open(&o->g, &o->known, FP3_PASS(FP3_PASS_COMMON));
}

static inline int end(operation *o) {
    uint32_t nodes = 0;
    for (uint32_t i = 0; i < o->g.count; i++)
        nodes += !fp3_dag_is_leaf(&o->g, i);
    if (o->spent)
        nodes = o->spent;
    printf("%s: %llu checked, %llu wrong, %u nodes, %.3g %s at most\n", o->name,
           (unsigned long long)o->checked, (unsigned long long)o->wrong, nodes, o->worst, o->unit);
    const int is_bad = o->wrong != 0;
    fp3_dag_close(&o->g);
    fp3_known_close(&o->known);
    fp3_model_free(&o->model);
    return is_bad;
}

/* From the words of the operands to those of the result; flags, unless NULL: the exceptions raised.
 */
static inline void execute(const operation *o, const float *words, float result[2],
                           uint32_t *flags) {
    static uint32_t value[FP3_DAG_LIMIT];
    for (uint32_t i = 0; i < o->g.count; i++) {
        const dag_node *n = &o->g.nodes[i];
        uint32_t raised = 0;
        if (n->op == NODE_VARIABLE)
            memcpy(&value[i], &words[n->a], sizeof value[i]);
        else if (n->op == NODE_KNOWN) {
            const float number = (float)o->known.list[n->a].number;
            memcpy(&value[i], &number, sizeof number);
        } else
            value[i] = fp3_execute(&o->config, n->op,
                                   (uint32_t[]){value[n->a], n->b == FP3_NONE ? 0 : value[n->b],
                                                n->c == FP3_NONE ? 0 : value[n->c]},
                                   flags ? &raised : NULL);
        if (flags)
            *flags |= raised;
    }
    memcpy(&result[0], &value[o->made.high], sizeof *result);
    result[1] = 0;
    if (o->made.low != FP3_NONE)
        memcpy(&result[1], &value[o->made.low], sizeof *result);
}

static inline void tell(operation *o, const float *words, unsigned count, const float result[2]) {
    if (o->wrong++ >= 5)
        return;
    printf("FAIL %s:", o->name);
    for (unsigned i = 0; i < count; i++)
        printf(" %a", (double)words[i]);
    printf(" gives %a + %a\n", (double)result[0], (double)result[1]);
}

/* The exceptions that it raises, which takes longer. */
static inline uint32_t flags_of(const operation *o, const float *words) {
    float result[2];
    uint32_t flags = 0;
    execute(o, words, result, &flags);
    return flags;
}

/* ---- operands ---- */

/* Marsaglia, Xorshift RNGs, Journal of Statistical Software 8 (2003). */
static inline uint64_t chance(void) {
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    return state ^= state << 17;
}

static inline float between(int least, int most) {
    const uint64_t bits = chance();
    const float fraction = 1 + (float)(bits & 0x7fffff) * 0x1p-23f;
    const int exponent = least + (int)((bits >> 32) % (uint64_t)(most - least + 1));
    return ldexpf(bits >> 31 & 1 ? -fraction : fraction, exponent);
}

static inline quad sum_of(const float *words) { return (quad)words[0] + (quad)words[1]; }

/* A pair whose second word is half a unit of the first one's last place at most; some are 0 or at
 * it. */
static inline void any_pair(float *words, int least, int most) {
    words[0] = between(least, most);
    const int exponent = ilogbf(words[0]) - 24;
    const uint64_t kind = chance() % 8;
    words[1] = kind == 0   ? 0
               : kind == 1 ? ldexpf((float)(chance() % 3) - 1, exponent - 1)
                           : ldexpf((float)(chance() % 0x2000000) * 0x1p-24f - 1, exponent) * 0.99f;
}

#endif
