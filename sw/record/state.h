/* SPDX-License-Identifier: Apache-2.0 */
/* state.h - all that a program keeps of its objects from step to step: which words, and a hash of
 * them.
 *
 *     fp3_state state;
 *     fp3_digest hash;
 *     if (!fp3_state_open(engine, &state, &error) && !fp3_state_hash(&state, step, &hash, &error))
 *         ...
 *     fp3_state_free(&state);
 */
#ifndef FP3_CHECKPOINT_STATE_H
#define FP3_CHECKPOINT_STATE_H

#include "engine/common/inside.h"
#include "record/hdf5/fp3_hdf5.h"

#define FP3_DIGEST_WORDS 8
#define FP3_DIGEST_SIZE 65 /* as text */

/* SHA-256, the words in the order of FIPS 180-4. */
typedef struct {
    uint32_t words[FP3_DIGEST_WORDS];
} fp3_digest;

typedef struct {
    fp3_engine *engine;
    const fp3_hdf5_ops *calls;
    const fp3_layout *layout;
    uint64_t *kept;  /* of each group: bit r for register r */
    uint32_t *words; /* of one register of all objects */
} fp3_state;

/* Of a loaded engine, until the next load. The caller frees *state, after a failure too.
 * FP3_E_SYSTEM: no fp3_hdf5.so, no memory. */
fp3_status fp3_state_open(fp3_engine *engine, fp3_state *state, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_state_free(fp3_state *state);

/* How many registers a group keeps. */
uint32_t fp3_state_registers(const fp3_state *state, uint32_t group);

/* The words of one register of a group's objects; row: which of the kept registers it is. Or, with
 * count 0, what the pairs of list `row`, whose register is reg, remember: `pairs` have `each`
 * words. A pair of near objects has both of them, a row for each that has the other in its list,
 * and the fields; a link has its fields alone, and stands where the host gave it. */
typedef struct {
    uint32_t group, row, reg, count, pairs, each;
    const uint32_t *words;
} fp3_state_row;
typedef fp3_status fp3_state_fn(void *user, const fp3_state_row *row, fp3_error *error);
/* Calls `tell`, unless it is NULL, with each row, group by group: registers in ascending order,
 * then the lists whose pairs remember. Makes the hash of docs/checkpoints.md: SHA-256 of the step,
 * 64 bits, and of these words, each with its lowest byte first. */
fp3_status fp3_state_look(fp3_state *state, uint64_t step, fp3_state_fn *tell, void *user,
                          fp3_digest *hash, fp3_error *error);
static inline fp3_status fp3_state_hash(fp3_state *state, uint64_t step, fp3_digest *hash,
                                        fp3_error *error) {
    return fp3_state_look(state, step, NULL, NULL, hash, error);
}

/* The next link: SHA-256 of the one before and of a hash, as 64 bytes. Before the first it is all
 * 0. */
fp3_status fp3_chain_add(const fp3_hdf5_ops *calls, fp3_digest *chain, const fp3_digest *hash,
                         fp3_error *error);

void fp3_digest_text(const fp3_digest *digest, char text[FP3_DIGEST_SIZE]);
/* 0: text, which may be NULL, is no digest. */
int fp3_digest_read(const char *text, fp3_digest *digest);
static inline int fp3_digest_same(const fp3_digest *a, const fp3_digest *b) {
    uint32_t different = 0;
    for (int i = 0; i < FP3_DIGEST_WORDS; i++)
        different |= a->words[i] ^ b->words[i];
    return !different;
}

#endif
