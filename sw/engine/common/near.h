/* SPDX-License-Identifier: Apache-2.0 */
/* near.h - lists of those that are near: made on grids with a skin, and made again before one could
 * be missed. */
#ifndef FP3_ENGINE_NEAR_H
#define FP3_ENGINE_NEAR_H

#include "near_rule.h"

/* Whether the list has to be made again. */
int fp3_near_is_stale(const fp3_near_rule *rule, const fp3_where_they_are *now);

/* Makes the list: *begin and *other as in fp3_neighbours, but of rows and with rows; the caller
 * frees them. Neighbours are in the order of their objects. Nobody is near an object whose position
 * is not finite. FP3_E_SYSTEM: out of memory. FP3_E_LIMIT: more than 2^31 entries. */
fp3_status fp3_near_make(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                         uint32_t **other, fp3_error *error);
/* Rows in an order in which those that are near each other mostly stand together: as many as there
 * are objects. Likewise. */
fp3_status fp3_near_order(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t *rows,
                          fp3_error *error);
/* There is no list; the next look finds it stale. */
void fp3_near_close(fp3_near_rule *rule);

/* A list has been made of what is so now. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_near_note(fp3_near_rule *rule, const fp3_where_they_are *now, fp3_error *error);

#endif
