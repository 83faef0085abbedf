/* SPDX-License-Identifier: Apache-2.0 */
/* event.h - `when CONDITION: x = .., v = ..`, `when root(g) rising: ..`, `at t = TIME: ..`, and
 * `project x = .., v = ..` */
#ifndef FP3_ODE_EVENT_H
#define FP3_ODE_EVENT_H

#include "parser.h"

/* Whether a statement with this first word, which is read, is one of these; and what follows that
 * word. */
int fp3_ode_is_event(const ode_parser *p, fp3_token first);
void fp3_ode_event(ode_parser *p, fp3_token first);

#endif
