/* SPDX-License-Identifier: Apache-2.0 */
/* lower.h - expressions of a model to operations that the machine has.
 *
 * This file determines, for every integrator and pass, what the machine computes and in which order
 * it rounds; docs/compiler.md says the same in words.
 */
#ifndef FP3_LOWER_H
#define FP3_LOWER_H

#include "compiler/value/term.h"
#include "notes.h"
#include "options.h"

/* What neighbours see of an object at a place: a word of a state, and the node of its value there.
 */
typedef struct {
    uint32_t place, state, node;
    uint32_t word; /* 0; 1: the second word of a pair */
} fp3_seen;

typedef struct {
    fp3_seen *list;
    uint32_t count, room;
    /* Node: the object has stopped, and shows what it had when the step began, wherever it is in a
     * step that it does not make; FP3_NONE: none does. */
    uint32_t stopped;
    uint32_t start[FP3_STATES_MAX]; /* node of each state then */
    int has_failed;                 /* out of memory */
} fp3_sight;

/* Expressions at one place: a stage or a substep of one step. */
typedef struct lowering {
    const fp3_model *model;
    dag *g;
    term (*state)(struct lowering *l, uint32_t state);  /* the value of a state there */
    void *user;                                         /* of the function above */
    term (*before)(struct lowering *l, uint32_t state); /* ... when the step began */
    term time;                                          /* t there, if the model has it */
    term h;                  /* the length of the step; with `before` of projections alone */
    struct lowering *inside; /* where conditions in t are made for all of the step; NULL: here */
    const char *kind;        /* with inside: of each expression (language/turn.h) */
    fp3_notes *notes;
    char place[FP3_PLACE_SIZE]; /* as notes call it */
    uint32_t index;
    fp3_sight *sight; /* of the step; NULL: there are no neighbours here */
    term *value;      /* of each expression that is_made */
    char *is_made, *is_wanted;
    char *is_inverted; /* of each root: something is divided by it */
} lowering;

/* FP3_E_SYSTEM: out of memory. The caller sets state, user, notes and place, and closes, after a
 * failure too. */
fp3_status fp3_lower_open(lowering *l, const fp3_model *model, dag *g, fp3_error *error);
void fp3_lower_close(lowering *l);

term fp3_lower(lowering *l, uint32_t expr);

/* Others see these states there. */
void fp3_lower_show(lowering *l, uint64_t states);
/* There objects look for those that are near: the list is made from positions as the phase begins,
 * so the own position has to be that of the place. */
void fp3_lower_look(lowering *l, uint32_t relation);

#endif
