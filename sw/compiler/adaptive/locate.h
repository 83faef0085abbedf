/* SPDX-License-Identifier: Apache-2.0 */
/* locate.h - events of adaptive steps: a step that goes too far beyond one is made again, shorter.
 */
#ifndef FP3_LOCATE_H
#define FP3_LOCATE_H

#include "compiler/step/advance.h"

/* a->is_in_time: node, 0 where a root is passed or a condition becomes true more than `locate`
 * before the end of the step; a->part: node, which part of the step to try then. Both stay FP3_NONE
 * if there is nothing to locate. */
fp3_status fp3_locate(fp3_advance *a, fp3_error *error);

#endif
