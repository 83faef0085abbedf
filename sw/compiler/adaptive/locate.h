/* locate.h - events of adaptive steps: a step that goes too far beyond one is made again, shorter. */
#ifndef FP3_LOCATE_H
#define FP3_LOCATE_H

#include "compiler/step/advance.h"

/* *is_late: node that is not 0 where a condition is false before the step and true after it, and the step
 * is longer than `locate`; FP3_NONE: there are no events. */
fp3_status fp3_locate(const fp3_advance *a, uint32_t *is_late, fp3_error *error);

#endif
