/* SPDX-License-Identifier: Apache-2.0 */
/* check.h - what objects in chunks cannot do. */
#ifndef FP3_CHUNKS_CHECK_H
#define FP3_CHUNKS_CHECK_H

#include "engine/common/inside.h"

/* As of fp3_chunks_make, but for what the cut shows. */
fp3_status fp3_chunks_check(fp3_engine *engine, const fp3_config *config, fp3_error *error);

/* FP3_E_PROGRAM: the object, and so many that it sees, have no room. */
fp3_status fp3_chunks_no_room(const fp3_config *config, uint32_t object, uint32_t seen,
                              fp3_error *error);

/* The binary logarithm of the words of a record. */
uint32_t fp3_chunks_log2(const fp3_members *group);

/* Words of an object's list: each entry has a row, then its fields. */
static inline uint32_t fp3_chunks_words(const fp3_list *list, uint32_t object) {
    return fp3_list_length(list, object) * (1 + list->fields);
}

#endif
