/* SPDX-License-Identifier: Apache-2.0 */
/* fold.h - loads of a loop over neighbours become operands of the arithmetic that reads them.
 *
 *     ldn t, x ; sub d, t, y    becomes    rsbn d, y, x
 *
 * Bits, flags and the fields of an entry do not change.
 */
#ifndef FP3_PHASES_FOLD_H
#define FP3_PHASES_FOLD_H

#include "compiler/schedule/lines.h"

/* Of the lines between `each` and `next`: first loads of words and of all fields in their order, to
 * registers that nothing reads behind the loop, then arithmetic. Gives how many lines are left. */
uint32_t fp3_phases_fold(fp3_line *lines, uint32_t count);

#endif
