/* SPDX-License-Identifier: Apache-2.0 */
/* switches.h - where the right-hand side of a model jumps or bends, so that its truth stops there.
 *
 * A comparison, min, max and abs of what changes with time is a switch: it has two sides. Between
 * two turns every switch is held to its side, so that what GSL integrates is smooth. The turns of a
 * switch of t alone are known before the integration begins (stops); those of states are looked for
 * in each step (crossing.h).
 */
#ifndef FP3_TRUTH_SWITCHES_H
#define FP3_TRUTH_SWITCHES_H

#include <fp3/model.h>

typedef struct {
    const fp3_model *model;
    const double *params;
    char *kind; /* of each expression: a set of bits of turn.h, and one of switches.c */
    char *side; /* of each switch, while it is held */
    double *values;
    double end, *stops; /* in the order in which they are reached */
    size_t stop_count, stop_room;
    int has_any;    /* the derivatives have a switch, or an event has one of t */
    int has_states; /* one depends on states: only looks in each step find its turns */
} fp3_switches;

/* For times from 0 to end, which may be below 0. FP3_E_ARGUMENT: switches of t turn too often. The
 * caller closes, after a failure too. */
fp3_status fp3_switches_open(fp3_switches *s, const fp3_model *model, const double *params,
                             double end, fp3_error *error);
void fp3_switches_close(fp3_switches *s);

/* From now on each switch has the side that it has here. */
void fp3_switches_hold(fp3_switches *s, double t, const double *y);
/* Whether a switch has another side here than the one it is held to. */
int fp3_switches_have_turned(fp3_switches *s, double t, const double *y);
/* As fp3_model_evaluate, with each switch held to its side. */
void fp3_switches_evaluate(const fp3_switches *s, const fp3_point *point, double *values);
/* The first stop after now; t, if that comes first. */
double fp3_switches_until(const fp3_switches *s, double now, double t);

#endif
