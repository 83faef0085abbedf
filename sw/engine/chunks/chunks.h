/* SPDX-License-Identifier: Apache-2.0 */
/* chunks.h - objects that see each other, more than the store of hardware with a port to memory
 * holds: what its memory has to be, and the list of transfers that makes the steps.
 *
 *     fp3_chunks *chunks = NULL;
 *     const fp3_chunks_how how = {.at = 0x40000000, .steps = 100};
 *     if (fp3_chunks_make(engine, config, &how, &chunks, &error))
 *         return ...
 *     ... chunks->memory goes to byte address chunks->at; the hardware makes the list that begins
 *         at chunks->list (fp3_bare_move_list) ...
 *     fp3_chunks_read(chunks, memory, reg, words);
 *     fp3_chunks_free(&chunks);
 *
 * Of a phase a chunk loads the words of its objects, their lists, and the words that others publish
 * to them; it runs, and what it publishes goes to the other of two places, so each chunk reads what
 * held when the phase began. What one object alone has is in a single place. docs/memory.md has the
 * words of a step. Each start clears `flags`, so after the list it tells of the last chunk's phase
 * alone. Lists of near objects are made by the hardware; if an object goes too far for that, or a
 * list has no room, the list of transfers ends with FP3_BARE_REFUSED. Then memory has states of
 * some step, and the engine those before the first: the caller makes fewer steps. If `raised` in
 * `status` is 1 and `no_room` is 0, it may let objects roam farther instead. The last transfer
 * enables the interrupt, whose `ended` the last run has set: `irq` rises when all steps are made,
 * if it was disabled before. After an error of the list it does not.
 */
#ifndef FP3_CHUNKS_H
#define FP3_CHUNKS_H

#include "made.h"

typedef struct {
    uint32_t at;    /* the byte address of memory */
    uint32_t steps; /* at least 1 */
    /* Of near objects, how far they may go from where they are now, above 0, in the unit of the
     * model: the farther, the more ghosts a chunk has. */
    double roam;
} fp3_chunks_how;

/* The engine has a program and objects, which stay as they are; `config` says the hardware, of
 * which the chunks are as few as fit. FP3_E_PROGRAM: chunks cannot do what the objects need, or one
 * alone has no room; FP3_E_ARGUMENT: the hardware has no port or no neighbours, computes otherwise,
 * or memory would go beyond 32 bits of address; FP3_E_SYSTEM: out of memory. */
fp3_status fp3_chunks_make(fp3_engine *engine, const fp3_config *config, const fp3_chunks_how *how,
                           fp3_chunks **chunks, fp3_error *error);
/* *chunks may be NULL, and is NULL then. */
void fp3_chunks_free(fp3_chunks **chunks);

/* A word of each object, of memory as it is after the steps. 0: no step changes it, and no chunk
 * needs it: it is what the engine has. */
int fp3_chunks_read(const fp3_chunks *chunks, const uint32_t *memory, uint32_t reg,
                    uint32_t *words);

#endif
