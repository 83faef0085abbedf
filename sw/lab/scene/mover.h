/* SPDX-License-Identifier: Apache-2.0 */
/* mover.h - what a motion is inside. */
#ifndef FP3_LAB_MOVER_H
#define FP3_LAB_MOVER_H

#include "asked.h"

/* Of a group. */
typedef struct {
    const fp3_integrator *integrator;
    int is_still; /* no equation moves it */
    double *before, *next, *stages, *room;
    fp3_asked slopes;
    /* What happens at the end of a step: changes.h. */
    uint32_t *order, order_count; /* projections, one after the other, with repetitions */
    fp3_asked *projections, *events, armed, *memories;
    double *changed;   /* values of the assignments of one of them */
    char *is_armed;    /* of each event, a column */
    char *is_stopping; /* of each object */
} fp3_mover;

struct fp3_motion {
    fp3_crowd *crowd;
    fp3_mover *movers;
    double **view; /* the states that neighbours see now */
    uint64_t cost;
    unsigned events; /* that were located */
};

/* A part of a step, in steps of the scene. */
typedef struct {
    double from, share;
} fp3_span;

static inline void fp3_motion_see_states(struct fp3_motion *m) {
    for (uint32_t k = 0; k < m->crowd->group_count; k++)
        m->view[k] = m->crowd->groups[k].states;
}

/* At the beginning of the span, for a group that has its own h. */
static inline fp3_moment fp3_motion_moment(const struct fp3_motion *m, uint32_t group,
                                           double *const *states, const fp3_span *at) {
    const double h = m->crowd->groups[group].h;
    return (fp3_moment){.crowd = m->crowd,
                        .group = group,
                        .states = states,
                        .before = m->movers[group].before,
                        .t = at->from * h,
                        .h = at->share * h};
}

#endif
