/* SPDX-License-Identifier: Apache-2.0 */
/* root.h - the roots of events, as a step sees them. */
#ifndef FP3_ROOT_H
#define FP3_ROOT_H

#include "compiler/step/advance.h"

/* A root at which nothing can happen in this step, where the nearest is looked for. */
#define FP3_ROOT_FAR 0x1p100

/* Whether the event is at a root that has to be looked for: a time is the end of a step. */
int fp3_root_is(const fp3_advance *a, const fp3_event *event);

/* Nodes: the root's function before the step; and after the step, if it was on the side that the
 * event comes from, else a number on that side. is_falling: that side is above 0. */
typedef struct {
    uint32_t from, to;
    uint32_t is_armed; /* it was on the side that the event comes from */
    int is_falling;
} fp3_reach;

/* before, after: opened by fp3_advance_event. */
fp3_reach fp3_root_reach(const fp3_advance *a, const fp3_event *event, lowering *before,
                         lowering *after);

/* Node: 1 if the step ends before the root. 0 where that has no value: the step may have gone too
 * far. */
uint32_t fp3_root_is_ahead(const fp3_advance *a, const fp3_event *event, const fp3_reach *r);

/* Nodes: the least of several roots' functions before and after the step, each with the sign that
 * makes it positive before the event; so far, FP3_NONE at first. */
void fp3_root_nearest(const fp3_advance *a, const fp3_event *event, const fp3_reach *r,
                      uint32_t *from, uint32_t *to);

#endif
