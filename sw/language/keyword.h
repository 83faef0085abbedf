/* SPDX-License-Identifier: Apache-2.0 */
/* keyword.h - the reserved words of the language. Functions are in function.h. */
#ifndef FP3_ODE_KEYWORD_H
#define FP3_ODE_KEYWORD_H

#include "base/token.h"

int fp3_ode_is_keyword(fp3_token name);
/* A keyword that begins a statement. */
int fp3_ode_begins_statement(fp3_token name);
/* Keeps in *best the keyword at the beginning of a statement that name is most likely a misspelling
 * of (base/nearest.h). */
void fp3_ode_nearest_statement(fp3_token name, const char **best);

#endif
