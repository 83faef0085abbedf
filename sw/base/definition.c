/* SPDX-License-Identifier: Apache-2.0 */
/* definition.c - see definition.h. */
#include "definition.h"

#include <inttypes.h>
#include <string.h>

#define MARK 0x46500000u /* in each version; the lower half is the size */
#define SIZE 0xffffu

static uint32_t cookie_of(const void *def) {
    uint32_t cookie;
    memcpy(&cookie, def, sizeof cookie);
    return cookie;
}

int fp3_definition_begin(void *def, size_t size, size_t here) {
    const uint32_t cookie = MARK | (uint32_t)size;
    memset(def, 0, size);
    memcpy(def, &cookie, sizeof cookie);
    return size == here;
}

fp3_status fp3_definition_check(const void *def, size_t here, const char *name, fp3_error *error) {
    const uint32_t cookie = cookie_of(def);
    if (cookie == (MARK | (uint32_t)here))
        return FP3_OK;
    if ((cookie & ~SIZE) != MARK)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s has no default: begin with %.*sdefault()", name,
                        (int)strlen(name) - 3, name);
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s has %" PRIu32 " bytes, and %zu in this library: the program was "
                    "compiled with headers of another version than " FP3_VERSION,
                    name, cookie & SIZE, here);
}

fp3_error *fp3_definition_error(const void *def, fp3_error *error) {
    const uint32_t cookie = cookie_of(def);
    return !cookie || (cookie & ~SIZE) == MARK ? error : NULL;
}
