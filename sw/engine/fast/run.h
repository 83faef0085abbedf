/* SPDX-License-Identifier: Apache-2.0 */
/* run.h - what a run of a program over many objects is. */
#ifndef FP3_FAST_RUN_H
#define FP3_FAST_RUN_H

#include "place.h"

#include <stdint.h>

typedef struct fp3_fast fp3_fast;
typedef struct fp3_fast_worker fp3_fast_worker;

/* A run of all objects of a program. */
typedef struct {
    uint32_t *const *columns; /* [64]; NULL where fp3_fast_columns has no bit */
    uint32_t objects;         /* of the columns, whose last vector is whole */
    uint32_t *status;         /* a word for each object; NULL: the configuration keeps none */
    uint32_t
        *slept_in; /* of each object, set to `number` if it falls asleep; NULL: no object can */
    uint32_t number;
    const uint32_t *constants; /* [64] */
    uint32_t steps, visit;     /* at least 1; steps of a visit */
    uint32_t clock;            /* steps of earlier runs */
    uint32_t seed;             /* of draws (machine/storage.h) */
    void (*tell)(void *user,
                 uint32_t steps); /* now and then: how many the block has made; or NULL */
    void *user;
} fp3_fast_run;

#endif
