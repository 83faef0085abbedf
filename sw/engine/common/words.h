/* SPDX-License-Identifier: Apache-2.0 */
/* words.h - a word of each object, in memory of the caller's if the engine was opened with an
 * allocator. */
#ifndef FP3_WORDS_H
#define FP3_WORDS_H

#include "backend.h"

/* All 0; NULL: out of memory. */
uint32_t *fp3_words_make(const fp3_engine *engine, size_t count);
/* words may be NULL. */
void fp3_words_free(const fp3_engine *engine, uint32_t *words, size_t count);

#endif
