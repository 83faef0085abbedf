/* SPDX-License-Identifier: Apache-2.0 */
/* constant.h - values that are known before a run. */
#ifndef FP3_ODE_CONSTANT_H
#define FP3_ODE_CONSTANT_H

#include "dimension_read.h"

typedef struct {
    double value[ODE_VECTOR];
    uint32_t
        expr[ODE_VECTOR]; /* what a start is computed from, if params are in it; else FP3_NONE */
    ode_dimension dimension;
    char dimension_text[ODE_DIMENSION_SOURCE_SIZE];
} ode_constant;

/* NULL, or what is expected instead of a value that is no number, or was made of lost digits
 * (loss.h). */
const char *fp3_ode_constant_expected(double value, int is_lost);

/* Reads a number, or a vector of this size, with its unit in brackets, if that is there. 0 after an
 * error. */
int fp3_ode_measured(ode_parser *p, ode_context context, unsigned size, ode_constant *constant);

#endif
