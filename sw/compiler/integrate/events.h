/* SPDX-License-Identifier: Apache-2.0 */
/* events.h - what `when` does to the states that a step has made. */
#ifndef FP3_EVENTS_H
#define FP3_EVENTS_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the events, in their order. */
fp3_status fp3_events(fp3_advance *a, fp3_error *error);

#endif
