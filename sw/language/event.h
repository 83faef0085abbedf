/* event.h - `when CONDITION: x = .., v = ..`, `when root(g) rising: ..`, `at t = TIME: ..` */
#ifndef FP3_ODE_EVENT_H
#define FP3_ODE_EVENT_H

#include "parser.h"

/* What follows the keyword. */
void fp3_ode_event(ode_parser *p, fp3_token keyword);

/* Whether a statement with this first word is `at t = ..`, and what follows that word. */
int fp3_ode_is_timed(const ode_parser *p, fp3_token first);
void fp3_ode_timed(ode_parser *p, fp3_token keyword);

/* Likewise of `project x = .., v = ..` */
int fp3_ode_is_projection(const ode_parser *p, fp3_token first);
void fp3_ode_projection(ode_parser *p, fp3_token keyword);

#endif
