/* SPDX-License-Identifier: Apache-2.0 */
/* dimension_read.h - a unit of measurement as it is written: "[kg*m/s^2]". */
#ifndef FP3_ODE_DIMENSION_READ_H
#define FP3_ODE_DIMENSION_READ_H

#include "parser.h"

enum { ODE_DIMENSION_SOURCE_SIZE = 64 };

/* Reads it, if it is there. text is what stands between the brackets, without blanks. */
void fp3_ode_dimension_read(ode_parser *p, ode_dimension *dimension,
                            char text[ODE_DIMENSION_SOURCE_SIZE]);

#endif
