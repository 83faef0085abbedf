/* events.h - what `when` does to the states that a step has made. */
#ifndef FP3_EVENTS_H
#define FP3_EVENTS_H

#include "compiler/step/advance.h"

/* Whether the event is at a root that has to be looked for: a time is the end of a step. */
int fp3_event_is_root(const fp3_advance *a, const fp3_event *event);

/* Nodes: a root before the step; what it is after it, if it was on the side that the event comes from, else a number on that
 * side. is_falling: that side is above 0. */
typedef struct {
    uint32_t from, to;
    int is_falling;
} fp3_reach;

/* before, after: opened by fp3_advance_event. */
fp3_reach fp3_event_reach(const fp3_advance *a, const fp3_event *event, lowering *before,
                          lowering *after);

/* a->now and a->lost become those after the events, in their order. */
fp3_status fp3_events(fp3_advance *a, fp3_error *error);

#endif
