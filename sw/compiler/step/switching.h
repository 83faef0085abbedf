/* SPDX-License-Identifier: Apache-2.0 */
/* switching.h - the times at which a model's conditions in t change, where the host knows them. */
#ifndef FP3_SWITCHING_H
#define FP3_SWITCHING_H

#include "compiler/value/known.h"

#define FP3_SWITCHINGS_MOST 16 /* each costs an adaptive step three instructions */

typedef struct {
    char *kind; /* of each expression (language/turn.h) */
    uint32_t expr[FP3_SWITCHINGS_MOST], count;
    uint32_t
        unknown; /* an expression of t that is not linear in it, or one too many; FP3_NONE: none */
} fp3_switchings;

/* FP3_E_SYSTEM: out of memory. The caller closes, after a failure too. */
fp3_status fp3_switchings_find(const fp3_model *model, fp3_switchings *s, fp3_error *error);
void fp3_switchings_close(fp3_switchings *s);

/* Whether the event is at a time of the list, t = T: steps end there, and nothing has to be looked
 * for. */
int fp3_switchings_time(const fp3_model *model, const fp3_switchings *s, const fp3_event *event);

/* When one of the list changes, as a known value; FP3_NONE: never. */
uint32_t fp3_switching_time(known_table *known, const fp3_switchings *s, uint32_t number);

#endif
