/* SPDX-License-Identifier: Apache-2.0 */
/* utf8.h - a check of texts that are shown to users. */
#ifndef FP3_ODE_UTF8_H
#define FP3_ODE_UTF8_H

#include "base/token.h"

/* Whether the token is UTF-8 without control characters. */
int fp3_ode_is_utf8(fp3_token token);

#endif
