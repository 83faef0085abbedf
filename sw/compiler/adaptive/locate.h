/* SPDX-License-Identifier: Apache-2.0 */
/* locate.h - events of adaptive steps: a step that goes too far beyond an event is repeated,
 * shorter. */
#ifndef FP3_LOCATE_H
#define FP3_LOCATE_H

#include "compiler/step/advance.h"

/* a->is_in_time: node, 0 if a root is passed or a condition becomes true more than `locate` before
 * the end of the step; a->part: node, the part of the step to try then. Both stay FP3_NONE without
 * events to locate. */
fp3_status fp3_locate(fp3_advance *a, fp3_error *error);

#endif
