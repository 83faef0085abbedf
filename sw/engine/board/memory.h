/* SPDX-License-Identifier: Apache-2.0 */
/* memory.h - a driver's side of the hardware's memories; the calls are those of backend.h. */
#ifndef FP3_MEMORY_H
#define FP3_MEMORY_H

#include "engine/common/backend.h"

fp3_status fp3_memory_load(fp3_engine *engine);
/* Of the only group, words first .. end-1 as a program of their own, until the next load. */
fp3_status fp3_memory_load_phase(fp3_engine *engine, uint32_t first, uint32_t end);
/* Likewise, words that the caller has made. */
fp3_status fp3_memory_load_words(fp3_engine *engine, const uint32_t *code, uint32_t count);
/* After a load: 0 into what engine.h promises to be 0 at first. Hardware that was used before holds
 * something else. */
fp3_status fp3_memory_clear(fp3_engine *engine);
fp3_status fp3_memory_read(fp3_engine *engine, fp3_cells cells, void *words);
fp3_status fp3_memory_write(fp3_engine *engine, fp3_cells cells, const void *words);
fp3_status fp3_memory_list(fp3_engine *engine);
/* Of the only scheduler: a word of a lane's store; a word of the list of copies. */
fp3_status fp3_memory_put_word(fp3_engine *engine, uint32_t lane, uint32_t word, uint32_t data);
/* Likewise as many words of a lane's store, side by side. */
fp3_status fp3_memory_get_words(fp3_engine *engine, uint32_t lane, uint32_t word, size_t count,
                                uint32_t *data);
fp3_status fp3_memory_put_copy(fp3_engine *engine, uint32_t word, uint32_t data);

#endif
