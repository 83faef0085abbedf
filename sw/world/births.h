/* SPDX-License-Identifier: Apache-2.0 */
/* births.h - which object numbers live, and the handles of those that do.
 *
 * A handle is an object's number, with the number of births that there had been with it: another
 * object that gets the number later has another handle.
 */
#ifndef FP3_BATCH_BIRTHS_H
#define FP3_BATCH_BIRTHS_H

#include <fp3/batch.h>

typedef struct {
    uint32_t *times; /* of each number: births so far */
    uint8_t *lives;  /* likewise */
    size_t objects, living;
    size_t lowest; /* nobody below is free */
} fp3_births;

/* All live, or nobody. The caller closes, after a failure too. */
fp3_status fp3_births_open(size_t objects, int is_empty, fp3_births *births, fp3_error *error);
void fp3_births_close(fp3_births *births);

/* 0: nobody lives there. */
uint64_t fp3_births_handle(const fp3_births *births, size_t number);
/* FP3_NOBODY: the object lives no more. */
uint32_t fp3_births_number(const fp3_births *births, uint64_t handle);

/* The numbers that are free, lowest first. FP3_E_LIMIT: there are fewer. */
fp3_status fp3_births_find_free(fp3_births *births, size_t count, uint32_t *numbers,
                                fp3_error *error);
/* The numbers of these objects. FP3_E_ARGUMENT: one lives no more, or (is_once) occurs twice. */
fp3_status fp3_births_find(const fp3_births *births, const uint64_t *handles, size_t count,
                           int is_once, uint32_t *numbers, fp3_error *error);
void fp3_births_begin(fp3_births *births, const uint32_t *numbers, size_t count);
void fp3_births_end(fp3_births *births, const uint32_t *numbers, size_t count);

/* How many of the numbers from numbers[0] on follow each other. */
static inline size_t fp3_births_run(const uint32_t *numbers, size_t count) {
    size_t n = count ? 1 : 0;
    while (n < count && numbers[n] == numbers[0] + n)
        n++;
    return n;
}

#endif
