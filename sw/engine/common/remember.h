/* SPDX-License-Identifier: Apache-2.0 */
/* remember.h - a list of those that are near, made again, with what its pairs remember. */
#ifndef FP3_ENGINE_REMEMBER_H
#define FP3_ENGINE_REMEMBER_H

#include "lists.h"

/* *begin and *other: as fp3_near_make gave them. The caller frees these, and *field, also after a
 * failure. FP3_E_SYSTEM: out of memory. FP3_E_LIMIT: too many entries. */
fp3_status fp3_list_merge(const fp3_list *list, const fp3_where_they_are *now, uint32_t **begin,
                          uint32_t **other, uint32_t **field, fp3_error *error);

#endif
