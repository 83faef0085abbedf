/* SPDX-License-Identifier: Apache-2.0 */
/* finish.h - what only the end of a source can tell. */
#ifndef FP3_ODE_FINISH_H
#define FP3_ODE_FINISH_H

#include "parser.h"

/* Completes the states by their equations, and reports what is missing or does not fit. */
void fp3_ode_finish(ode_parser *p);

#endif
