/* SPDX-License-Identifier: Apache-2.0 */
/* shared_list.h - with the key `keep` an object is not its own neighbour in any loop. So the
 * objects of a lane that see all others go through one list, in which each of them is, too.
 */
#ifndef FP3_SHARED_LIST_H
#define FP3_SHARED_LIST_H

#include "engine/common/lists.h"
#include "machine/config.h"

static inline int fp3_list_is_shared(const fp3_config *config, const fp3_list *list) {
    return config->keep && list->is_all;
}

/* As fp3_list_length, with the object's own turn; an object that sees nobody has none. */
static inline uint32_t fp3_list_turns(const fp3_config *config, const fp3_list *list,
                                      uint32_t object) {
    const uint32_t length = fp3_list_length(list, object);
    if (!length || !fp3_list_is_shared(config, list))
        return length;
    return list->living ? list->living->count : list->end - list->first;
}

/* As fp3_list_entry. */
static inline uint32_t fp3_list_turn(const fp3_config *config, const fp3_list *list,
                                     uint32_t object, uint32_t turn) {
    if (!fp3_list_is_shared(config, list))
        return fp3_list_entry(list, object, turn);
    return list->living ? list->living->who[turn] : list->first + turn;
}

#endif
