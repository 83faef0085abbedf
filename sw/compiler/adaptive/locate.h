/* locate.h - events of adaptive steps: a step that goes too far beyond one is made again, shorter. */
#ifndef FP3_LOCATE_H
#define FP3_LOCATE_H

#include "compiler/step/advance.h"

/* a->is_late: node that is not 0 where a condition is false before the step and true after it, more than `locate` before
 * its end; a->back: node, how much earlier the step is to end. Both stay FP3_NONE if there are no events. */
fp3_status fp3_locate(fp3_advance *a, fp3_error *error);

#endif
