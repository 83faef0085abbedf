/* SPDX-License-Identifier: Apache-2.0 */
/* repeat.h - projections that happen several times: the lines from `repeat N` to `end`. */
#ifndef FP3_LANGUAGE_REPEAT_H
#define FP3_LANGUAGE_REPEAT_H

#include "parser.h"

/* Whether the statement, whose first word has been read, begins or ends a repetition. */
int fp3_ode_is_repeat(const ode_parser *p, fp3_token first);
void fp3_ode_repeat(ode_parser *p, fp3_token first);
/* Within a repetition there are projections alone. 0: the statement is something else, which is
 * told. */
int fp3_ode_may_repeat(ode_parser *p, fp3_token first);
/* After the last line. */
void fp3_ode_repeat_check(ode_parser *p);

#endif
