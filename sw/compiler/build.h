/* build.h - a model and an integrator to the graph of one step. */
#ifndef FP3_BUILD_H
#define FP3_BUILD_H

#include <fp3/compile.h>

#include "graph.h"
#include "lower.h"

#define BUILD_STATES 64 /* a set of states is the bits of a uint64_t */

/* What a variable holds. */
typedef enum {
    ROLE_STATE,       /* a state of the model */
    ROLE_LOST,        /* what its updates have rounded away */
    ROLE_BEFORE,      /* the state one step ago */
    ROLE_LOST_BEFORE, /* what was lost one step ago */
    ROLE_CARRIED      /* a value that the next step needs again: the host knows nothing of it */
} role;

typedef struct {
    role role;
    uint32_t state; /* of the model */
    uint32_t next;  /* node: its value after the step */
    uint32_t first; /* CARRIED: node that computes it when a visit begins */
    uint32_t last;  /* node of the graph `last` that the state is at the end; FP3_NONE: none */
} variable;

typedef struct {
    const fp3_model *model;
    const fp3_integrator *integrator;
    unsigned passes;
    int is_compensated;
    int has_notes;
    known_table known;
    graph g;    /* of a step */
    graph last; /* of the last part: its variables are those after the step */
    variable *variables;
    uint32_t variable_count;
    uint32_t one,
        minus_zero; /* nodes of g for sums and products that go the chain's way, or FP3_NONE */
    char **notes;
    uint32_t note_count, note_room;
    unsigned order; /* theoretical, of the worst state that is live */
    /* While it is made. */
    uint64_t live;
    uint64_t *needs;     /* of each expression: the states it depends on */
    lowering *places;    /* FP3_STAGES_MAX + 1 */
    term *stage, *slope; /* [place * state_count + state] */
    char *has_stage, *has_slope;
    term *now, *lost; /* of each state, as substeps go on */
    int has_failed;   /* out of memory */
} build;

/* live: the states that somebody reads; what they need is added. The caller closes b, after a failure too. */
fp3_status fp3_build(build *b, const fp3_model *model, const fp3_integrator *integrator,
                     unsigned passes, int is_compensated, int has_notes, uint64_t observed,
                     fp3_error *error);
void fp3_build_close(build *b);

/* Values that this step computes and the next one would compute again become variables. Returns how many. */
uint32_t fp3_build_carry(build *b);

#endif
