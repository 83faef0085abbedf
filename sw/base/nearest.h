/* SPDX-License-Identifier: Apache-2.0 */
/* nearest.h - which word was meant. */
#ifndef FP3_NEAREST_H
#define FP3_NEAREST_H

#include <fp3/image.h>

#include "token.h"

/* Keeps in *best the candidate that wanted is most likely a misspelling of. Start with *best
 * NULL. */
void fp3_nearest(fp3_token wanted, const char *candidate, const char **best);

#endif
