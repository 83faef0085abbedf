/* SPDX-License-Identifier: Apache-2.0 */
/* load.c - objects from memory to the store and back: cycles a word, by the port to memory and
 * through AXI4-Lite. */
#include "hardware.h"
#include "rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RECORD 3u /* the binary logarithm of 8 words */

static uint32_t word_of(uint32_t i) { return i * 2654435761u ^ i >> 7; }

/* Through the slave: the master of the bus waits for no response, or for each. */
static double by_slave(alone *a, uint32_t words, int waits) {
    const uint32_t base = FP3_ADDRESS_IN(a->fp3.space_bit, FP3_SPACE_OBJECTS, 0);
    const uint32_t room = a->fp3.lanes * a->fp3.store;
    const uint64_t begin = alone_now(a);
    uint32_t done = 0;
    fp3_rtl_word *list = malloc(words * sizeof *list);
    NEED(list);
    for (uint32_t i = 0; i < words; i++)
        list[i] = (fp3_rtl_word){base + 4 * (i % room), word_of(i), 1, 0};
    for (uint32_t piece = waits ? 1 : words; done < words; done += piece)
        NEED(!a->hardware.ops->transfer(a->rtl, list + done, piece));
    for (uint32_t i = 0; i < words; i++)
        NEED(!list[i].is_refused);
    free(list);
    return (double)(alone_now(a) - begin) / words;
}

/* As many rows at a time as the store has; back to another place. */
static void by_master(alone *a, uint32_t words, double cycles[2]) {
    const uint32_t objects = words >> RECORD, rows = a->fp3.store >> RECORD, bytes = 4 * words;
    uint64_t begin, taken[2] = {0, 0};
    for (uint32_t i = 0; i < words; i++)
        a->memory[i] = word_of(i);
    for (uint32_t first = 0; first < objects; first += rows) {
        const uint32_t some = objects - first < rows ? objects - first : rows;
        const uint32_t at = first << RECORD << 2;
        begin = alone_now(a);
        alone_move(a, FP3_BARE_TO_PROCESSOR, 0, 0, some, at);
        taken[0] += alone_now(a) - begin;
        begin = alone_now(a);
        alone_move(a, FP3_BARE_TO_MEMORY, 0, 0, some, bytes + at);
        taken[1] += alone_now(a) - begin;
    }
    NEED(!memcmp(a->memory, a->memory + words, bytes));
    for (uint32_t i = 0; i < words; i++)
        NEED(a->memory[i] == word_of(i));
    cycles[0] = (double)taken[0] / words;
    cycles[1] = (double)taken[1] / words;
}

void measure_load(const char *config, uint32_t objects, uint32_t rate, uint32_t latency,
                  uint64_t waits) {
    const uint32_t words = objects << RECORD;
    const fp3_rtl_memory shape = {2 * words, rate, latency};
    alone a = {0};
    double cycles[2];
    alone_open(&a, config, &shape, waits);
    a.fp3.record[0] = RECORD; /* moves need no program but this */
    by_master(&a, words, cycles);
    printf("{\"scene\": \"load\", \"config\": \"%s\", \"memory\": %g, \"latency\": %" PRIu32
           ", \"objects\": %" PRIu32 ", \"words\": %" PRIu32
           ", \"cycles_per_word\": %.4f, \"back\": %.4f, \"slave_streams\": %.4f, "
           "\"slave_waits\": %.4f}\n",
           config, rate / 1000.0, latency, objects, words, cycles[0], cycles[1],
           by_slave(&a, words, 0), by_slave(&a, words, 1));
    alone_close(&a);
}
