/* SPDX-License-Identifier: Apache-2.0 */
/* maker.c - see maker.h. */
#include "maker.h"

#include <stdlib.h>
#include <string.h>

uint32_t fp3_chunks_put(fp3_chunks_maker *m, const uint32_t *words, uint32_t count) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t first = chunks->words;
    if (m->is_full || count > (UINT32_MAX - chunks->at) / 4 - first) {
        m->is_full = 1;
        return 0;
    }
    if (count > m->room - first) {
        const uint32_t room = 2 * (first + count); /* below 2^31: of 4 GB */
        uint32_t *memory = realloc(chunks->memory, (size_t)room * sizeof *memory);
        if (!memory) {
            m->is_full = 1;
            return 0;
        }
        chunks->memory = memory;
        m->room = room;
    }
    if (words)
        memcpy(chunks->memory + first, words, count * sizeof *words);
    else
        memset(chunks->memory + first, 0, count * sizeof *words);
    chunks->words += count;
    return first;
}

void fp3_chunks_put_program(fp3_chunks_maker *m, const uint32_t *words, uint32_t count,
                            uint64_t published, fp3_chunks_program *program) {
    const uint32_t shape[] = {0, count, count};
    const uint32_t halves[] = {(uint32_t)published, (uint32_t)(published >> 32)};
    program->words = count;
    program->at = fp3_chunks_put(m, words, count);
    program->shape = fp3_chunks_put(m, shape, 3);
    program->published = fp3_chunks_put(m, halves, 2);
}

uint32_t fp3_chunks_upper(const fp3_chunks_maker *m) { return m->config->store_words / 2; }

uint32_t fp3_chunks_room(const fp3_chunks_maker *m) { return fp3_chunks_upper(m) / m->parts; }

const fp3_chunks_run *fp3_chunks_run_of(const fp3_chunks *chunks, uint32_t number) {
    for (uint32_t i = 0; i < chunks->run_count; i++)
        if (number - chunks->runs[i].reg < chunks->runs[i].count)
            return &chunks->runs[i];
    return NULL;
}
