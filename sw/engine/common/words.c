/* SPDX-License-Identifier: Apache-2.0 */
/* words.c - see words.h. */
#include "words.h"

#include <stdlib.h>
#include <string.h>

static size_t size_of(size_t count) { return (count * sizeof(uint32_t) + 63) / 64 * 64; }

uint32_t *fp3_words_make(const fp3_engine *engine, size_t count) {
    const fp3_allocator *by = &engine->def.allocator;
    if (!by->allocate)
        return calloc(size_of(count), 1);
    void *words = by->allocate(by->user, size_of(count));
    return words ? memset(words, 0, size_of(count)) : NULL;
}

void fp3_words_free(const fp3_engine *engine, uint32_t *words, size_t count) {
    const fp3_allocator *by = &engine->def.allocator;
    if (!by->allocate)
        free(words);
    else if (words && by->release)
        by->release(by->user, words, size_of(count));
}
