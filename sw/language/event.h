/* event.h - `when CONDITION: x = .., v = ..` */
#ifndef FP3_ODE_EVENT_H
#define FP3_ODE_EVENT_H

#include "parser.h"

/* What follows the keyword. */
void fp3_ode_event(ode_parser *p, fp3_token keyword);

#endif
