/* SPDX-License-Identifier: Apache-2.0 */
/* handle.c - what callers give: whose number a handle has, and which numbers are out of range. */
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

fp3_status fp3_ranges_check(const fp3_bodies_range *ranges, size_t count, const char *of,
                            int is_space, fp3_error *error) {
    for (size_t i = 0; i < count; i++) {
        const fp3_bodies_range *r = &ranges[i];
        if (r->value >= r->least && r->value <= r->most)
            continue;
        return r->least == r->most
                   ? fp3_fail(error, FP3_E_ARGUMENT, "%s%s is %g, expected 0 in %s", of, r->name,
                              r->value, is_space ? "space" : "a plane")
                   : fp3_fail(error, FP3_E_ARGUMENT, "%s%s is %g, expected %g to %g", of, r->name,
                              r->value, r->least, r->most);
    }
    return FP3_OK;
}
