/* SPDX-License-Identifier: Apache-2.0 */
/* number.h - the numbers of the model language, as double. */
#ifndef FP3_ODE_NUMBER_H
#define FP3_ODE_NUMBER_H

#include "base/token.h"

/* NULL, or what is expected instead of this NUMBER. Needs the locale "C" (base/number.h). */
const char *fp3_ode_number(fp3_token token, double *value);

#endif
