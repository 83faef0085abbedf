/* SPDX-License-Identifier: Apache-2.0 */
/* step.h - one step of an integrator on a model: its values, and the variables that it advances.
 *
 * integrate.h fills a step, carry.h adds variables, convert.h reads the step. The model must stay.
 */
#ifndef FP3_STEP_H
#define FP3_STEP_H

#include "compiler/value/term.h"
#include "lower.h"
#include "notes.h"
#include "options.h"

#include <machine/neighbours.h>

/* What a variable holds. */
typedef enum {
    ROLE_STATE,       /* a state of the model */
    ROLE_LOST,        /* what its updates have rounded away */
    ROLE_BEFORE,      /* the state one step ago */
    ROLE_LOST_BEFORE, /* what was lost one step ago */
    ROLE_STEPS,       /* how many steps were made: t is that times h */
    ROLE_STOPPED,     /* fixed steps: 1: an event has stopped the object; 0: none has */
    ROLE_SLEPT,       /* adaptive steps: written by `sleep`; 0: awake */
    ROLE_LOW, /* the second word of a state: of all in double-single, of t with adaptive steps */
    ROLE_LOW_BEFORE, /* and of the state one step ago */
    ROLE_CARRIED,    /* a value that the next step needs again; the host does not see it */
    ROLE_WORST,      /* a value that all objects compare between two phases */
    ROLE_LIST        /* where the object's list of neighbours is; `state`: which relation */
} role;

typedef struct variable {
    role role;
    uint32_t state; /* of the model; STEPS, CARRIED: FP3_NONE; WORST: which fp3_compared */
    uint32_t next;  /* node: its value after the step */
    uint32_t first; /* CARRIED: node that computes it when a visit begins */
    uint32_t last;  /* node of `last` that the state is at the end; FP3_NONE: none */
} variable;

/* A word of a field of each entry of a relation gets the value of a node. */
typedef struct {
    uint32_t relation, field; /* of the model's fields */
    uint32_t node;
    uint32_t word; /* 0; 1: the second word of a pair */
} fp3_kept;

/* The beginning of a step that goes on with other values of the same variables, behind a repetition
 * of phases: it begins with what its variables hold, and ends with `next` in them. */
typedef struct {
    dag values;
    uint32_t *next; /* of each variable that there is then; FP3_NONE: it stays */
    fp3_sight sight;
    uint32_t times; /* how often it is made; 0: once, and no repetition */
} fp3_segment;

typedef struct {
    const fp3_model *model;
    uint32_t words; /* that the program is made for, as fp3_image has them */
    known_table known;
    fp3_segment *segments; /* before `values` */
    uint32_t segment_count;
    dag values; /* of a step, or of what follows its segments */
    dag last;   /* of the last part: its variables are those after the step */
    variable *variables;
    uint32_t variable_count, variable_room;
    uint32_t tested; /* variable: an object sleeps where it is 0 after a step; FP3_NONE: no sleep */
    uint32_t least;  /* of known: a number below which that counts as 0 */
    uint32_t rest_note;
    fp3_sight sight; /* what neighbours see */
    /* What entries remember: each of these fields, at once, at a place of their own. */
    fp3_kept kept[2 * FP3_FIELDS_MAX];
    uint32_t kept_count, kept_place; /* kept_place: FP3_NONE without a `remember` */
    /* Of objects of other kinds: what they ask for (NULL: nothing); places at which the seen states
     * are shown, at which this step sees others; of these the phases; whether no seen state moves,
     * so that all places show the same. */
    const fp3_coupling *coupling;
    uint64_t shown, looks;
    uint8_t phase[FP3_PLACES];
    unsigned compares;               /* comparisons that this step makes, ... */
    uint8_t behind[FP3_COMPARISONS]; /* ... and behind which phase */
    uint32_t phases;                 /* of the step */
    int is_still;
    fp3_notes notes;
} fp3_step;

/* Empty. FP3_E_SYSTEM: out of memory. The caller closes, after a failure too. */
fp3_status fp3_step_open(fp3_step *step, const fp3_model *model, const fp3_options *options,
                         fp3_error *error);
void fp3_step_close(fp3_step *step);

/* What was made so far becomes a segment; values and sight begin anew. 0: out of memory. */
int fp3_step_cut(fp3_step *step, uint32_t times);

/* A variable, whose nodes are FP3_NONE so far; 0: out of memory. */
int fp3_step_add(fp3_step *step, role role, uint32_t state);
/* Which variable has this role for a state of the model; FP3_NONE: none. */
uint32_t fp3_step_find(const fp3_step *step, role role, uint32_t state);

/* The variable of a word of a state: 0, or 1 of the second word of a pair. */
static inline uint32_t fp3_step_word(const fp3_step *step, uint32_t state, uint32_t word) {
    return fp3_step_find(step, word ? ROLE_LOW : ROLE_STATE, state);
}

/* The number of a place as fp3_coupling has it; FP3_NONE: it has no room there. */
#define FP3_LAST_PLACE (FP3_PLACES - 1)
static inline uint32_t fp3_step_place(const fp3_step *step, uint32_t place) {
    return place == step->kept_place ? FP3_LAST_PLACE : place < FP3_LAST_PLACE ? place : FP3_NONE;
}

/* Whether all that was asked for since was made: FP3_E_SYSTEM, or FP3_E_LIMIT. */
fp3_status fp3_step_check(const fp3_step *step, fp3_error *error);

#endif
