/* SPDX-License-Identifier: Apache-2.0 */
#include "parts.h"

#include "base/fpu.h"

#include <stdatomic.h>

#define EACH 4u /* parts of a thread */

typedef struct {
    void (*make)(void *of, uint32_t part);
    void *of;
    atomic_uint next;
    uint32_t count;
} work;

/* A thread of the caller's may flush small numbers to zero, or trap NaN. */
static void take(void *of, uint32_t number) {
    const uint64_t callers = fp3_fpu_get();
    work *w = of;
    (void)number;
    fp3_fpu_set(FP3_FPU_OF_C);
    for (uint32_t part; (part = atomic_fetch_add(&w->next, 1)) < w->count;)
        w->make(w->of, part);
    fp3_fpu_set(callers);
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
