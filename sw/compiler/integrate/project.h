/* SPDX-License-Identifier: Apache-2.0 */
/* project.h - what `project` does to the states that a step has made. */
#ifndef FP3_PROJECT_H
#define FP3_PROJECT_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the projections, in their order. */
fp3_status fp3_project(fp3_advance *a, fp3_error *error);

#endif
