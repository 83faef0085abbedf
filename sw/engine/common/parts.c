/* SPDX-License-Identifier: Apache-2.0 */
#include "parts.h"

#include <stdatomic.h>

#define EACH 4u /* parts of a thread */

typedef struct {
    void (*make)(void *of, uint32_t part);
    void *of;
    atomic_uint next;
    uint32_t count;
} work;

static void take(void *of, uint32_t number) {
    work *w = of;
    (void)number;
    for (uint32_t part; (part = atomic_fetch_add(&w->next, 1)) < w->count;)
        w->make(w->of, part);
}

uint32_t fp3_parts_of(const fp3_crew *crew) {
    return crew && crew->count > 1 ? EACH * crew->count : 1;
}

void fp3_parts_make(const fp3_crew *crew, void (*make)(void *of, uint32_t part), void *of,
                    uint32_t count) {
    work w = {.make = make, .of = of, .count = count};
    if (count > 1)
        crew->run(crew->user, take, &w, crew->count);
    else
        take(&w, 0);
}
