/* SPDX-License-Identifier: Apache-2.0 */
/* written.h - what a run writes to the registers of states, object by object. */
#ifndef FP3_BENCH_WRITTEN_H
#define FP3_BENCH_WRITTEN_H

#include <fp3/engine.h>

/* The states that are compared, by number: all but that of `sleep`. NULL beyond the last. */
const fp3_symbol *fp3_bench_state(const fp3_image *image, unsigned number);

typedef struct fp3_written fp3_written;

/* Of the states of an image, room words each of every object; until fp3_written_size of none. */
fp3_status fp3_written_make(const fp3_image *image, uint64_t room, fp3_written **written,
                            fp3_error *error);
fp3_status fp3_written_size(fp3_written *written, size_t objects, fp3_error *error);
void fp3_written_free(fp3_written **written);

/* An fp3_retire_fn; the user pointer is the fp3_written. */
void fp3_written_retire(void *written, const fp3_retirement *retirement);
void fp3_written_clear(fp3_written *written);

/* The words written to a state, numbered as by fp3_bench_state. *writes may exceed the room; words
 * beyond it are lost. */
const uint32_t *fp3_written_of(const fp3_written *written, unsigned state, uint64_t object,
                               uint64_t *writes);
uint64_t fp3_written_room(const fp3_written *written);

#endif
