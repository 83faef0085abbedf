/* SPDX-License-Identifier: Apache-2.0 */
/* births.c - see births.h. */
#include "births.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_births_open(size_t objects, int is_empty, fp3_births *b, fp3_error *error) {
    *b = (fp3_births){.times = calloc(objects, sizeof *b->times),
                      .lives = calloc(objects, 1),
                      .objects = objects,
                      .living = is_empty ? 0 : objects,
                      .lowest = is_empty ? 0 : objects};
    if (!b->times || !b->lives)
        return fp3_no_memory(error);
    for (size_t i = 0; !is_empty && i < objects; i++)
        b->times[i] = b->lives[i] = 1;
    return FP3_OK;
}

void fp3_births_close(fp3_births *b) {
    free(b->times);
    free(b->lives);
    *b = (fp3_births){0};
}

uint64_t fp3_births_handle(const fp3_births *b, size_t number) {
    return b->lives[number] ? (uint64_t)b->times[number] << 32 | number : 0;
}

uint32_t fp3_births_number(const fp3_births *b, uint64_t handle) {
    const uint32_t number = (uint32_t)handle;
    return handle && number < b->objects && fp3_births_handle(b, number) == handle ? number
                                                                                   : FP3_NOBODY;
}

/* The births with a number can be counted no further: nobody gets it again. */
static int is_free(const fp3_births *b, size_t number) {
    return !b->lives[number] && b->times[number] < UINT32_MAX;
}

fp3_status fp3_births_find_free(fp3_births *b, size_t count, uint32_t *numbers, fp3_error *error) {
    size_t found = 0;
    while (b->lowest < b->objects && !is_free(b, b->lowest))
        b->lowest++;
    for (size_t i = b->lowest; found < count && i < b->objects; i++)
        if (is_free(b, i))
            numbers[found++] = (uint32_t)i;
    return found == count ? FP3_OK
                          : fp3_fail(error, FP3_E_LIMIT,
                                     "%zu more objects: %zu of %zu live, and there is room for %zu",
                                     count, b->living, b->objects, found);
}

static fp3_status refuse(const fp3_births *b, size_t i, uint64_t handle, fp3_error *error) {
    const uint32_t number = (uint32_t)handle, times = (uint32_t)(handle >> 32);
    if (number < b->objects && times && times <= b->times[number])
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "handle %zu, 0x%" PRIx64 ": its object, number %" PRIu32 ", was removed%s",
                        i, handle, number,
                        b->lives[number] ? ", and another object has its number" : "");
    return fp3_fail(error, FP3_E_ARGUMENT, "handle %zu, 0x%" PRIx64 ": no object ever had it", i,
                    handle);
}

static fp3_status check_once(const fp3_births *b, const uint32_t *numbers, size_t count,
                             fp3_error *error) {
    uint8_t *is_seen = calloc(b->objects, 1);
    fp3_status status = is_seen ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < count; i++) {
        if (is_seen[numbers[i]])
            status = fp3_fail(error, FP3_E_ARGUMENT, "handle %zu: object %" PRIu32 " occurs twice",
                              i, numbers[i]);
        is_seen[numbers[i]] = 1;
    }
    free(is_seen);
    return status;
}

fp3_status fp3_births_find(const fp3_births *b, const uint64_t *handles, size_t count, int is_once,
                           uint32_t *numbers, fp3_error *error) {
    for (size_t i = 0; i < count; i++) {
        numbers[i] = fp3_births_number(b, handles[i]);
        if (numbers[i] == FP3_NOBODY)
            return refuse(b, i, handles[i], error);
    }
    return is_once && count > 1 ? check_once(b, numbers, count, error) : FP3_OK;
}

void fp3_births_begin(fp3_births *b, const uint32_t *numbers, size_t count) {
    for (size_t i = 0; i < count; i++) {
        b->lives[numbers[i]] = 1;
        b->times[numbers[i]]++;
    }
    b->living += count;
}

void fp3_births_end(fp3_births *b, const uint32_t *numbers, size_t count) {
    for (size_t i = 0; i < count; i++) {
        b->lives[numbers[i]] = 0;
        b->lowest = numbers[i] < b->lowest ? numbers[i] : b->lowest;
    }
    b->living -= count;
}
