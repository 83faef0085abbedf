/* SPDX-License-Identifier: Apache-2.0 */
/* batch_births.c - objects of a batch are born and removed. */
#include "batch_own.h"

#include "base/host.h"
#include "engine/common/inside.h"

#include <stdlib.h>
#include <string.h>

static fp3_status numbers_of(fp3_batch *b, const uint64_t *handles, size_t count, int is_once,
                             uint32_t **numbers) {
    *numbers = malloc((count + 1) * sizeof **numbers);
    return *numbers ? fp3_births_find(&b->births, handles, count, is_once, *numbers, b->error)
                    : fp3_no_memory(b->error);
}

/* Objects whose numbers follow each other. */
static fp3_status bear(fp3_batch *b, size_t first, size_t count) {
    fp3_status status = fp3_engine_wipe(b->engine, first, count);
    if (!status)
        status = fp3_fields_born(b->fields, first, count, b->error);
    return status ? status : fp3_engine_bear(b->engine, first, count);
}

fp3_status fp3_batch_add(fp3_batch *b, size_t count, uint64_t *handles) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    uint32_t *numbers = malloc((count < b->objects ? count + 1 : b->objects + 1) * sizeof *numbers);
    if (!numbers)
        return fp3_no_memory(b->error);
    fp3_status status = fp3_births_find_free(&b->births, count, numbers, b->error);
    for (size_t i = 0, n; !status && i < count; i += n) {
        n = fp3_births_run(numbers + i, count - i);
        status = bear(b, numbers[i], n);
    }
    if (!status)
        fp3_births_begin(&b->births, numbers, count);
    else
        fp3_batch_tell_lives(b); /* some of them may have been born */
    for (size_t i = 0; !status && i < count; i++)
        handles[i] = fp3_births_handle(&b->births, numbers[i]);
    free(numbers);
    return status;
}

static fp3_status bury(fp3_batch *b, const uint32_t *numbers, size_t count) {
    uint8_t *stays = malloc(b->objects);
    fp3_status status = stays ? FP3_OK : fp3_no_memory(b->error);
    if (stays)
        memset(stays, 1, b->objects);
    for (size_t i = 0; !status && i < count; i++)
        stays[numbers[i]] = 0;
    if (!status)
        status = fp3_engine_bury(b->engine, stays);
    if (!status)
        fp3_linked_drop(b->relations.linked, stays);
    free(stays);
    return status;
}

fp3_status fp3_batch_remove(fp3_batch *b, const uint64_t *handles, size_t count) {
    FP3_HOST;
    uint32_t *numbers;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = numbers_of(b, handles, count, 1, &numbers);
    if (!status)
        status = fp3_engine_can_bury(b->engine);
    if (!status && count)
        status = bury(b, numbers, count);
    if (!status)
        fp3_births_end(&b->births, numbers, count);
    free(numbers);
    return status;
}

fp3_status fp3_batch_tell_lives(fp3_batch *b) {
    fp3_status status = FP3_OK;
    if (b->births.living == b->objects)
        return FP3_OK;
    for (size_t i = 0, end; !status && i < b->objects; i = end) {
        for (end = i + 1; end < b->objects && b->births.lives[end] == b->births.lives[i]; end++)
            ;
        status = (b->births.lives[i] ? fp3_engine_bear : fp3_engine_unborn)(b->engine, i, end - i);
    }
    return status;
}

/* ---- who it is ---- */

size_t fp3_batch_living(const fp3_batch *b) { return b ? b->births.living : 0; }

void fp3_batch_numbers(const fp3_batch *b, const uint64_t *handles, size_t count,
                       uint32_t *numbers) {
    for (size_t i = 0; i < count; i++)
        numbers[i] = b ? fp3_births_number(&b->births, handles[i]) : FP3_NOBODY;
}

fp3_status fp3_batch_handles(const fp3_batch *b, size_t first, size_t count, uint64_t *handles) {
    if (!b)
        return FP3_E_ARGUMENT;
    const fp3_status status = fp3_fields_check(b->fields, first, count, b->error);
    for (size_t i = 0; !status && i < count; i++)
        handles[i] = fp3_births_handle(&b->births, first + i);
    return status;
}

/* ---- values by handles ---- */

static fp3_status write_of(fp3_batch *b, const char *name, const uint64_t *handles, size_t count,
                           fp3_numbers values) {
    uint32_t *numbers;
    fp3_status status = numbers_of(b, handles, count, 0, &numbers);
    for (size_t i = 0, n; !status && i < count; i += n) {
        n = fp3_births_run(numbers + i, count - i);
        status =
            fp3_fields_write(b->fields, name, numbers[i], n, fp3_numbers_from(values, i), b->error);
    }
    free(numbers);
    return status;
}

fp3_status fp3_batch_write_of(fp3_batch *b, const char *name, const uint64_t *handles, size_t count,
                              const float *values) {
    FP3_HOST;
    return b ? write_of(b, name, handles, count, (fp3_numbers){.single = values}) : FP3_E_ARGUMENT;
}

fp3_status fp3_batch_write_of_double(fp3_batch *b, const char *name, const uint64_t *handles,
                                     size_t count, const double *values) {
    FP3_HOST;
    return b ? write_of(b, name, handles, count, (fp3_numbers){.wide = values}) : FP3_E_ARGUMENT;
}

fp3_status fp3_batch_read_of(fp3_batch *b, const char *name, const uint64_t *handles, size_t count,
                             float *values) {
    FP3_HOST;
    uint32_t *numbers;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = numbers_of(b, handles, count, 0, &numbers);
    for (size_t i = 0, n; !status && i < count; i += n) {
        n = fp3_births_run(numbers + i, count - i);
        status = fp3_fields_read(b->fields, name, numbers[i], n, values + i, NULL, b->error);
    }
    free(numbers);
    return status;
}
