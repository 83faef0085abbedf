/* SPDX-License-Identifier: Apache-2.0 */
/* crossing.h - where in a step of a solution an event happens, and what it makes of the states; and
 * where a switch turns.
 *
 * An event happens at the first time at which firing all events changes a state or stops the
 * object. One that is true and changes nothing, as a switch that is off already, does not happen.
 */
#ifndef FP3_CROSSING_H
#define FP3_CROSSING_H

#include <fp3/model.h>
#include <gsl/gsl_odeiv2.h>

#include "switches.h"

/* Beside GSL's own codes, which are below: why a solution ends at an event. */
enum { FP3_CROSSING_STAYS = 1000, FP3_CROSSING_MOST, FP3_CROSSING_SLIDES };

#define FP3_EVENTS_MOST 1000 /* that happen on the way */
#define FP3_TURNS_MOST 10000 /* of switches */

typedef struct {
    const fp3_model *model;
    const double *params;
    fp3_switches *switches;
    const gsl_odeiv2_system *system;
    gsl_odeiv2_step *step;           /* a method for the way to an event */
    double *values;                  /* of all expressions */
    double *from, *there, *next;     /* states */
    unsigned happened, turned, slid; /* slid: turns in a row without a step between them */
    int is_event;                    /* what was found last is an event, no turn alone */
    int has_stopped;                 /* an event has stopped the object: there are no more */
    struct fp3_path
        *path; /* NULL, or what is told where the solution stops, before switches turn */
} fp3_crossing;

/* Room for a model with events or switches. GSL_ENOMEM. The caller closes, after a failure too. */
int fp3_crossing_open(fp3_crossing *c, fp3_switches *switches, const gsl_odeiv2_system *system,
                      const gsl_odeiv2_step_type *how);
void fp3_crossing_close(fp3_crossing *c);

/* Events at time 0, after which switches are held. GSL_SUCCESS, or one of those above. */
int fp3_crossing_start(fp3_crossing *c, double *y);
/* The first event that changes y at this time; NULL: none. values: room for all expressions. */
const fp3_event *fp3_crossing_of(const fp3_model *model, const double *params, double t,
                                 const double *y, double *values);
/* A step has come from time t0 and the states c->from to *t and y. If an event happens or a switch
 * turns on the way, they become those right after it, and *is_found is 1. Returns GSL's codes, or
 * one of those above. */
int fp3_crossing_find(fp3_crossing *c, double t0, double *t, double *y, int *is_found);

#endif
