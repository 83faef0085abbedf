/* SPDX-License-Identifier: Apache-2.0 */
/* fit.h - whether an integrator fits a model, and which states have to be computed. */
#ifndef FP3_FIT_H
#define FP3_FIT_H

#include <fp3/model.h>

#include "options.h"

/* Sets of states of the model. */
typedef struct {
    uint64_t live;      /* observed states, and the states that they depend on */
    uint64_t positions; /* states whose derivative is another state, alone, that is no position */
    uint64_t control;   /* adaptive steps: t, h and what counts them */
    int has_stop;       /* an event stops the object */
    int has_time;       /* the equations or events of a live state have t in them */
    unsigned order;     /* theoretical, of the worst live state */
    /* A live state that reduces the order of a splitting to 1, and the state in its derivative that
     * is no position; FP3_NONE: none. */
    uint32_t fallen, by;
} fp3_fit;

/* FP3_E_PROGRAM: the model has not the positions and velocities that the integrator moves. */
fp3_status fp3_fit_find(const fp3_model *model, const fp3_integrator *integrator,
                        const fp3_options *options, fp3_fit *fit, fp3_error *error);

/* Whether the event changes a live state. */
int fp3_fit_has_event(const fp3_fit *fit, const fp3_model *model, const fp3_event *event);

/* Whether any does, and any projection. */
int fp3_fit_has_events(const fp3_fit *fit, const fp3_model *model);
int fp3_fit_has_projections(const fp3_fit *fit, const fp3_model *model);

/* Warns that a state has a lower order, or that a step may pass over an event. *warning is NULL
 * without a warning; else the caller frees *warning. */
fp3_status fp3_fit_warn(const fp3_fit *fit, const fp3_model *model,
                        const fp3_integrator *integrator, char **warning, fp3_error *error);

/* The first position that this state is the velocity of, or FP3_NONE. */
uint32_t fp3_fit_position_of(const fp3_fit *fit, const fp3_model *model, uint32_t velocity);

static inline int fp3_fit_is_live(const fp3_fit *fit, uint32_t state) {
    return (int)(fit->live >> state & 1);
}

/* A live state that the integrator advances. */
static inline int fp3_fit_is_moved(const fp3_fit *fit, uint32_t state) {
    return (int)((fit->live & ~fit->control) >> state & 1);
}

static inline int fp3_fit_is_position(const fp3_fit *fit, uint32_t state) {
    return (int)(fit->positions >> state & 1);
}

#endif
