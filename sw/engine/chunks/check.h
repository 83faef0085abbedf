/* SPDX-License-Identifier: Apache-2.0 */
/* check.h - what objects in chunks cannot do. */
#ifndef FP3_CHUNKS_CHECK_H
#define FP3_CHUNKS_CHECK_H

#include "engine/common/inside.h"
#include "gen/registers.h"

/* As of fp3_chunks_make, but for what the cut shows. */
fp3_status fp3_chunks_check(fp3_engine *engine, const fp3_config *config, fp3_error *error);

/* FP3_E_PROGRAM: the object, and so many that it sees, have no room. */
fp3_status fp3_chunks_no_room(const fp3_config *config, uint32_t object, uint32_t seen,
                              fp3_error *error);

/* Entries of a list at most. */
#define FP3_CHUNKS_LENGTH ((1u << (FP3_OBJECTS_LENGTH_HI - FP3_OBJECTS_LENGTH_LO + 1)) - 1)

/* Words of an object's list: each entry has a row, then its fields. */
static inline uint32_t fp3_chunks_words(const fp3_list *list, uint32_t object) {
    return fp3_list_length(list, object) * (1 + list->fields);
}

#endif
