/* SPDX-License-Identifier: Apache-2.0 */
#include <fp3/engine.h>
#include <string.h>

#include "gen/registers.h"

const char *fp3_counter_name(fp3_counter counter) {
    static const char *const names[] = {
#define X(NAME, name, address) name,
        FP3_COUNTERS(X)
#undef X
    };
    return names[counter];
}

int fp3_counter_is_stall(fp3_counter counter) {
    return strncmp(fp3_counter_name(counter), "stall_", 6) == 0;
}
