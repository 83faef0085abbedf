/* SPDX-License-Identifier: Apache-2.0 */
/* advance.h - what all kinds of integrators share: states as a step goes on, and their updates. */
#ifndef FP3_ADVANCE_H
#define FP3_ADVANCE_H

#include <fp3/model.h>

#include "fit.h"
#include "lower.h"
#include "step.h"
#include "switching.h"

typedef struct {
    fp3_step *step;
    const fp3_integrator *integrator;
    const fp3_options *options;
    const fp3_fit *fit;
    lowering *places; /* of each stage or substep, for expressions there */
    uint32_t place_count;
    term *now, *lost; /* of each live state; they become those after the step */
    /* Adaptive steps (adaptive.h): the step is a value of the object. */
    int is_adaptive;
    int is_chosen;         /* by an estimate of its error */
    int is_common;         /* all objects make the same steps, as they see each other */
    term begin, begin_low; /* t is the sum of two words */
    term h, end;           /* the step that is made, the first word of t + h */
    uint32_t end_low;      /* node: the second */
    uint32_t gain;         /* node: h, as far as the second word has a place for it */
    uint32_t limit;        /* node: where the step ends at the latest */
    fp3_switchings switchings;
    lowering
        inside; /* in the middle of the step, if a condition in t changes at a time that is known */
    term *error;      /* of each live state: how wrong the step is, as the method estimates it */
    term error_scale; /* what they all have to be multiplied with */
    term *slope;      /* likewise, where has_slope: its derivative at the new states */
    int has_slope;
    uint32_t is_attempt, is_small, is_good,
        by; /* nodes: there is a step; its error is small enough; it is accepted; growth of the next
               step */
    /* Nodes, FP3_NONE without events to locate: whether the step may end here; else the next
     * attempt, and the two steps that bracket the event. */
    uint32_t is_in_time, next, before, behind;
    uint32_t root_before, root_behind; /* the nearest root there; FP3_NONE: not needed */
    uint32_t stops; /* node: an event at the end of the step stops the object; FP3_NONE: none can */
    uint32_t projected; /* projections so far, each repetition that is no loop for itself */
    uint32_t *previous; /* of each state: the variable that has what it was when the step began,
                           behind the step's first segment; FP3_NONE: not needed */
} fp3_advance;

/* Opens a step's places: `state` gives the value of a state at a place, and gets `user`; the names
 * of places are `prefix` and a number from 1 on. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_advance_places(fp3_advance *a, uint32_t count, const char *prefix,
                              term (*state)(lowering *l, uint32_t state), void *user,
                              fp3_error *error);

static inline const char *fp3_advance_name(const fp3_advance *a, uint32_t state) {
    return a->step->model->states[state].name;
}

/* Where steps are its own, `stop` ends the object's time; where they are those of all objects, it
 * makes steps that change nothing. */
static inline int fp3_advance_may_stop(const fp3_advance *a) {
    return a->fit->has_stop && (!a->is_adaptive || a->is_common);
}

/* States, and what is lost of them, are what their variables hold: a step or a segment begins. */
void fp3_advance_begin(fp3_advance *a);

/* What a variable gets, if this is its new value: an object that has stopped keeps what it has. */
uint32_t fp3_advance_next(const fp3_advance *a, uint32_t variable, term next);

/* Whether only events and projections change the state: its derivative is the number 0. Always
 * false without the pass `zero`. */
int fp3_advance_rests(const fp3_advance *a, uint32_t state);

/* A variable as it was when the step began, which dag g calls it. */
term fp3_advance_held(const fp3_advance *a, dag *g, role role, uint32_t state);

/* t at the time c h after the beginning of the step of dag g. In the last part c is 0: its
 * variables are those after the step. Call this only if fit->has_time. */
term fp3_advance_time(const fp3_advance *a, dag *g, double c);

/* Whether objects of another kind make this comparison, so these have to make it, too. */
int fp3_advance_compares(const fp3_advance *a, fp3_compared which);
/* The largest that all objects have, where they make the same steps, and the least; else the node.
 * A NaN is either. */
uint32_t fp3_advance_worst(const fp3_advance *a, fp3_compared which, uint32_t node);
uint32_t fp3_advance_least(const fp3_advance *a, fp3_compared which, uint32_t node);
/* The node, or `stopped` where the object has stopped. */
uint32_t fp3_advance_moving(const fp3_advance *a, uint32_t node, uint32_t stopped);

/* coefficient * h^n as a known value, its sign outside. */
term fp3_advance_scaled_step(const fp3_advance *a, double coefficient, unsigned n);

/* Compensated: d with the earlier rounding error; and base + d, whose rounding error is kept
 * (Kahan, 1965). */
term fp3_advance_with_lost(const fp3_advance *a, uint32_t state, term d);
term fp3_advance_keep(const fp3_advance *a, uint32_t state, term base, term y);

/* base + d, compensated both of them. */
term fp3_advance_update(const fp3_advance *a, uint32_t state, term base, term d);

/* Opens l for the expressions of an event: with the states and the time before the step, or with
 * a->now and the time after it. The caller closes, after a failure too. */
fp3_status fp3_advance_event(const fp3_advance *a, const fp3_event *event, int is_after,
                             lowering *l, fp3_error *error);

/* Objects of other kinds see at this place what states have there, if they look. */
void fp3_advance_show(const fp3_advance *a, lowering *l);
/* Likewise what states have before the step. */
void fp3_advance_show_start(fp3_advance *a);
/* Likewise what its projections have left, or its events, at places of other kinds' projections or
 * events that this model has not. */
void fp3_advance_show_rest(fp3_advance *a, int is_after_events);

/* Likewise for what happens after the step and all events. */
fp3_status fp3_advance_behind(const fp3_advance *a, lowering *l, fp3_error *error);

#endif
