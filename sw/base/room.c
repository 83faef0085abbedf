/* SPDX-License-Identifier: Apache-2.0 */
/* room.c - see room.h. */
#include "room.h"

#include <stdlib.h>
#include <string.h>

#define ALIGNED 64

fp3_status fp3_room(void **array, uint32_t *room, size_t size, size_t wanted, fp3_error *error) {
    if (wanted <= *room)
        return FP3_OK;
    size_t next = *room ? *room : 16;
    while (next < wanted)
        next *= 2;
    if (next > UINT32_MAX / 2)
        return fp3_fail(error, FP3_E_LIMIT, "more than 2^31 of a kind");
    const size_t bytes = (next * size + ALIGNED - 1) / ALIGNED * ALIGNED;
    void *made = aligned_alloc(ALIGNED, bytes);
    if (!made)
        return fp3_no_memory(error);
    if (*room)
        memcpy(made, *array, *room * size);
    memset((char *)made + *room * size, 0, bytes - *room * size);
    free(*array);
    *array = made;
    *room = (uint32_t)next;
    return FP3_OK;
}
