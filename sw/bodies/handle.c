/* SPDX-License-Identifier: Apache-2.0 */
/* handle.c - whose number a handle has. */
#include "own.h"

#include <inttypes.h>

static uint32_t number_of(const fp3_bodies *bodies, uint64_t handle) {
    const uint32_t number = (uint32_t)handle;
    return number < bodies->body_count && fp3_body_lives(&bodies->body[number]) &&
                   bodies->body[number].generation == handle >> 32
               ? number
               : FP3_NOBODY;
}

fp3_status fp3_bodies_numbered(const fp3_bodies *bodies, const uint64_t *handles, size_t which,
                               uint32_t *number) {
    *number = number_of(bodies, handles[which]);
    return *number != FP3_NOBODY
               ? FP3_OK
               : fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "handle %zu, %" PRIx64 ": there is no such body", which, handles[which]);
}
