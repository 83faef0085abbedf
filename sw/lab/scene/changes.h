/* SPDX-License-Identifier: Apache-2.0 */
/* changes.h - the end of a step: projections, events, and what entries remember. */
#ifndef FP3_LAB_CHANGES_H
#define FP3_LAB_CHANGES_H

#include "mover.h"

/* The caller closes, after a failure too. */
fp3_status fp3_changes_open(const fp3_crowd_group *g, fp3_mover *v, fp3_error *error);
void fp3_changes_close(const fp3_crowd_group *g, fp3_mover *v);

/* Before the step: which events may happen behind it. */
fp3_status fp3_changes_arm(struct fp3_motion *m, const fp3_span *at, fp3_error *error);
/* Behind the step, which is the span, in this order. */
fp3_status fp3_changes_project(struct fp3_motion *m, const fp3_span *at, fp3_error *error);
/* Whether an event happens here and changes something; nothing is changed. */
fp3_status fp3_changes_would_fire(struct fp3_motion *m, const fp3_span *at, int *would,
                                  fp3_error *error);
fp3_status fp3_changes_fire(struct fp3_motion *m, const fp3_span *at, fp3_error *error);
fp3_status fp3_changes_remember(struct fp3_motion *m, const fp3_span *at, fp3_error *error);

#endif
