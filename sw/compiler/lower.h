/* lower.h - expressions of a model to operations that the machine has.
 *
 * What is fixed here, for every integrator and pass, is what the machine computes and in which order
 * it rounds; docs/compiler.md says it in words.
 */
#ifndef FP3_LOWER_H
#define FP3_LOWER_H

#include "graph.h"

/* Expressions at one place: one stage of one step. */
typedef struct lowering {
    const fp3_model *model;
    graph *g;
    /* The value of a state there. */
    term (*state)(struct lowering *l, uint32_t state);
    /* The note for an expression there. */
    uint32_t (*note)(struct lowering *l, uint32_t expr);
    void *user;
    uint32_t place;
    term *value; /* of each expression that is_made */
    char *is_made, *is_wanted;
} lowering;

/* FP3_E_SYSTEM: out of memory. The caller closes. */
fp3_status fp3_lower_open(lowering *l, const fp3_model *model, graph *g, fp3_error *error);
void fp3_lower_close(lowering *l);

term fp3_lower(lowering *l, uint32_t expr);

#endif
