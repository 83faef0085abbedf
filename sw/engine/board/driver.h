/* SPDX-License-Identifier: Apache-2.0 */
/* driver.h - how a host drives FP3, over any bus.
 *
 * A backend with a bus has an fp3_driver as the first member of its engine's `self`, gives it an
 * fp3_bus, and takes the calls of this header, of memory.h and of session.h for its own. What it
 * adds is how a word gets there.
 */
#ifndef FP3_DRIVER_H
#define FP3_DRIVER_H

#include "engine/common/backend.h"

#include "base/file.h"

#define FP3_BUS_WORDS 512    /* the most that a bus moves at once */
#define FP3_QUEUE_WORDS 4096 /* the most that wait for others */

typedef struct {
    uint32_t words;  /* that it moves at once: 1 to FP3_BUS_WORDS */
    int is_anywhere; /* 0: addresses of words that it moves at once grow by 4 */
    /* count words to, or from, so many addresses. *refused: the number of the first one that was
     * answered with an error, from 1; 0: none. Later words may or may not have been tried. A
     * failure is that of the bus. */
    fp3_status (*transfer)(fp3_engine *engine, int is_write, const uint32_t *addresses,
                           uint32_t *data, uint32_t count, uint32_t *refused);
    /* Clock cycles since the opening; always 0 if cycles are not counted. */
    uint64_t (*now)(const fp3_engine *engine);
    /* Returns when it is time to ask whether a run has ended: `asked` times it was not. A bus that
     * counts cycles lets so many pass at most. */
    fp3_status (*rest)(fp3_engine *engine, uint64_t cycles, uint32_t asked);
    /* A run has ended as it must; before its log is published. NULL: nothing to do. */
    fp3_status (*ended)(fp3_engine *engine);
} fp3_bus;

typedef struct {
    const fp3_bus *bus;
    fp3_output *output; /* NULL unless there is a bus log ... */
    FILE *log;          /* ... and its stream */
    uint32_t lines;     /* that it has */
    uint32_t first;     /* the program's word that the hardware has as its first: of a phase */
    int is_upper;       /* the upper half of the store has the published words: only within a run */
    uint32_t queued;    /* writes that the hardware has not got yet: where, and what */
    uint32_t where[FP3_QUEUE_WORDS], what[FP3_QUEUE_WORDS];
} fp3_driver;

/* Opens the log and checks that the hardware is the configuration. */
fp3_status fp3_driver_open(fp3_engine *engine);
/* Also after an open that failed, and of an engine whose driver is {0}. */
void fp3_driver_close(fp3_engine *engine);

/* A line of the log, if there is one: "KIND X Y". FP3_E_SYSTEM: it cannot be written. */
fp3_status fp3_driver_note(fp3_engine *engine, char kind, uint32_t x, uint32_t y);

/* What the log has so far, on the disk: a full one is found before a run, not after it. */
fp3_status fp3_driver_save_log(fp3_engine *engine);

/* A word written may wait for others; the next read sends it, and so does fp3_driver_flush. If it
 * is refused then, that call fails. */
fp3_status fp3_driver_put(fp3_engine *engine, uint32_t address, uint32_t data);
fp3_status fp3_driver_flush(fp3_engine *engine);
fp3_status fp3_driver_get(fp3_engine *engine, uint32_t address, uint32_t *data);
fp3_status fp3_driver_get_all(fp3_engine *engine, const uint32_t *addresses, uint32_t *data,
                              uint32_t count);
/* A read that the log does not show. */
fp3_status fp3_driver_peek(fp3_engine *engine, uint32_t address, uint32_t *data);

/* Addresses: of one scheduler; of all of them, where a write goes to all and a read gives the OR.
 */
uint32_t fp3_driver_of(const fp3_engine *engine, uint32_t scheduler, uint32_t address);
uint32_t fp3_driver_of_all(const fp3_engine *engine, uint32_t address);

#endif
