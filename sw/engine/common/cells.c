/* SPDX-License-Identifier: Apache-2.0 */
/* cells.c - registers and constants, by number and by name.
 *
 * Here numbers become words of the machine and words numbers: callers of fp3/engine.h see binary32,
 * everything in this folder sees words.
 */
#include "cells.h"
#include "base/bits.h"
#include "checks.h"
#include "machine/format.h"
#include "machine/storage.h"
#include "origin.h"
#include "removed.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define BLOCK 512 /* words that are written at once where all are the same */

fp3_cells fp3_cells_of(const fp3_members *group, uint32_t reg, size_t first, size_t count) {
    const size_t end = (size_t)group->first + group->objects;
    const size_t from = first > group->first ? first : group->first;
    const size_t to = first + count < end ? first + count : end;
    return (fp3_cells){FP3_CELLS_REGISTER, reg, from, to > from ? to - from : 0};
}

static fp3_status check_cell(fp3_engine *engine, size_t first, size_t count, uint32_t reg) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    if (!status)
        status = fp3_engine_check_range(engine, "register", reg, 1, engine->config->registers);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (fp3_cells_of(group, reg, first, count).count && reg >> group->log2)
            status =
                fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                         "register %" PRIu32 ": the store of configuration '%s' has room for %u "
                         "registers of each of %" PRIu32 " objects",
                         reg, engine->config->name, 1u << group->log2, group->objects);
    }
    return status;
}

/* What the host knows of who sleeps, and of how far programs have counted. */
static void follow(fp3_engine *engine, fp3_cells cells, const void *words) {
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const fp3_cells own = fp3_cells_of(group, cells.number, cells.first, cells.count);
        const uint32_t *from = (const uint32_t *)words + (own.first - cells.first);
        if (own.count && group->program.slept == (int)own.number) {
            memcpy(&engine->sleepers.slept[own.first], from, own.count * sizeof *from);
            engine->sleepers.is_listed = 0;
        }
        if (own.count && group->removed == (int)own.number)
            fp3_removed_note(engine, own.first, own.count, from);
        if (own.count && group->counter == (int)own.number)
            engine->is_counted = 0;
    }
}

static fp3_status write_words(fp3_engine *engine, fp3_cells cells, const void *words) {
    if (cells.kind == FP3_CELLS_REGISTER)
        follow(engine, cells, words);
    engine->is_touched = 1;
    fp3_origin_write(engine, cells, words);
    return engine->backend->write(engine, cells, words);
}

static fp3_status too_large(fp3_engine *engine, fp3_cells cells, uint32_t word) {
    const float value = fp3_value_of(word);
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu, register %" PRIu32
                    ": %.9g is too large: configuration '%s' keeps records in %s, up to %.9g",
                    cells.first, cells.number, (double)value, engine->config->name,
                    fp3_storage_name(engine->config), (double)fp3_storage_most(engine->config));
}

/* The name that a parameter of the object's program has, or NULL: the register is none. */
static const char *param_of(const fp3_engine *engine, size_t object, uint32_t reg) {
    const fp3_image *image = fp3_layout_group_of(&engine->layout, object)->image;
    for (uint32_t i = 0; image && i < image->symbol_count; i++)
        if (image->symbols[i].index == reg && image->symbols[i].symbol_class == FP3_SYMBOL_PARAM)
            return image->symbols[i].name;
    return NULL;
}

/* A state may come close to 0 and have fewer digits there; a parameter means what it says. */
static fp3_status check_small(fp3_engine *engine, fp3_cells cells, uint32_t word, uint32_t stored) {
    const float value = fp3_value_of(word), kept = fp3_value_of(stored);
    const float off = fabsf(value - kept),
                bound = fabsf(value) / (float)fp3_storage_counts(engine->config);
    const char *name = off > bound ? param_of(engine, cells.first, cells.number) : NULL;
    if (!name)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu, param '%s': %.9g is too small: configuration '%s' keeps records "
                    "in %s, where it would be %.9g (a shared constant has all bits)",
                    cells.first, name, (double)value, engine->config->name,
                    fp3_storage_name(engine->config), (double)kept);
}

/* Whether word i of these cells is an integer and no number: the register of `sleep`, or what leads
 * to a list of neighbours. */
static int is_whole(const fp3_engine *engine, fp3_cells cells, size_t i) {
    if (cells.kind != FP3_CELLS_REGISTER)
        return 0;
    const fp3_members *group = fp3_layout_group_of(&engine->layout, cells.first + i);
    int is_list = 0;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++)
        is_list |= group->lists.lists[k].reg == cells.number;
    return is_list || group->program.slept == (int)cells.number;
}

/* FP3_E_ARGUMENT: a finite number would not be one in a record of 16 bits, or a parameter would
 * lose its digits. */
static fp3_status round_words(fp3_engine *engine, fp3_cells cells, const void *words,
                              uint32_t *to) {
    const uint32_t infinite = 0x7f800000;
    for (size_t i = 0; i < cells.count; i++) {
        uint32_t word, flags;
        memcpy(&word, (const char *)words + i * sizeof word, sizeof word);
        to[i] = is_whole(engine, cells, i) ? word : fp3_stored(engine->config, word, NULL, &flags);
        const fp3_cells one = {cells.kind, cells.number, cells.first + i, 1};
        if (~word & infinite && !(~to[i] & infinite))
            return too_large(engine, one, word);
        const fp3_status status = check_small(engine, one, word, to[i]);
        if (status)
            return status;
    }
    return FP3_OK;
}

/* As a store rounds to nearest; all words are looked at before one is written. */
static fp3_status write_rounded(fp3_engine *engine, fp3_cells cells, const void *words) {
    uint32_t rounded[BLOCK];
    fp3_status status = FP3_OK;
    for (int is_written = 0; !status && is_written < 2; is_written++)
        for (size_t i = 0; !status && i < cells.count; i += BLOCK) {
            const size_t left = cells.count - i;
            const fp3_cells part = {cells.kind, cells.number, cells.first + i,
                                    left < BLOCK ? left : BLOCK};
            status = round_words(engine, part, (const char *)words + i * sizeof *rounded, rounded);
            if (!status && is_written)
                status = write_words(engine, part, rounded);
        }
    return status;
}

fp3_status fp3_cells_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    const int is_rounded = engine->config->storage && cells.kind == FP3_CELLS_REGISTER;
    return (is_rounded ? write_rounded : write_words)(engine, cells, words);
}

fp3_status fp3_cells_fill(fp3_engine *engine, fp3_cells cells, uint32_t bits) {
    uint32_t same[BLOCK];
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < BLOCK && i < cells.count; i++)
        same[i] = bits;
    for (size_t left = cells.count; !status && left; left -= cells.count) {
        cells.count = left < BLOCK ? left : BLOCK;
        status = fp3_cells_write(engine, cells, same);
        cells.first += cells.count;
    }
    return status;
}

/* ---- words ---- */

fp3_status fp3_engine_write_words(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                                  const uint32_t *words) {
    const fp3_cells cells = {FP3_CELLS_REGISTER, reg, first, count};
    const fp3_status status = check_cell(engine, first, count, reg);
    return status ? status : fp3_cells_write(engine, cells, words);
}

fp3_status fp3_engine_read_words(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                                 uint32_t *words) {
    const fp3_cells cells = {FP3_CELLS_REGISTER, reg, first, count};
    const fp3_status status = check_cell(engine, first, count, reg);
    return status ? status : engine->backend->read(engine, cells, words);
}

static fp3_status check_shared(fp3_engine *engine, size_t group, uint32_t first, size_t count) {
    if (group >= engine->layout.count)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "group %zu: there are %" PRIu32, group,
                        engine->layout.count);
    return fp3_engine_check_range(engine, "shared constant", first, count,
                                  engine->config->registers);
}

fp3_status fp3_engine_write_shared_words(fp3_engine *engine, size_t group, uint32_t first,
                                         size_t count, const uint32_t *words) {
    const fp3_cells cells = {FP3_CELLS_CONSTANT, (uint32_t)group, first, count};
    const fp3_status status = check_shared(engine, group, first, count);
    return status ? status : fp3_cells_write(engine, cells, words);
}

fp3_status fp3_engine_read_shared_words(fp3_engine *engine, size_t group, uint32_t first,
                                        size_t count, uint32_t *words) {
    const fp3_cells cells = {FP3_CELLS_CONSTANT, (uint32_t)group, first, count};
    const fp3_status status = check_shared(engine, group, first, count);
    return status ? status : engine->backend->read(engine, cells, words);
}

/* ---- numbers ---- */

static const char *word_of(const fp3_engine *engine, fp3_cells cells, size_t i, float value,
                           uint32_t *word) {
    if (!is_whole(engine, cells, i))
        return fp3_format_written(engine->config, value, word);
    memcpy(word, &value, sizeof *word);
    return NULL;
}

static fp3_status no_word(fp3_engine *engine, fp3_cells cells, size_t i, float value,
                          const char *wrong) {
    const int is_register = cells.kind == FP3_CELLS_REGISTER;
    const fp3_members *group = is_register ? fp3_layout_group_of(&engine->layout, cells.first + i)
                                           : &engine->layout.groups[cells.number];
    const uint32_t cell = is_register ? FP3_BANK_OBJECT_BASE + cells.number
                                      : FP3_BANK_SHARED_BASE + (uint32_t)(cells.first + i);
    const char *name = group->image ? fp3_image_name(group->image, cell) : NULL;
    fp3_prefix where =
        fp3_engine_prefix((size_t)(group - engine->layout.groups), engine->layout.count);
    if (is_register)
        snprintf(where.text, sizeof where.text, "object %zu: ", cells.first + i);
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s%s is %g, which %s: configuration '%s' has no word for it", where.text,
                    name          ? name
                    : is_register ? "a register"
                                  : "a constant",
                    (double)value, wrong, engine->config->name);
}

/* All have words. */
static fp3_status check_numbers(fp3_engine *engine, fp3_cells cells, const float *values) {
    for (size_t i = 0; i < cells.count; i++) {
        uint32_t word;
        const char *wrong = word_of(engine, cells, i, values[i], &word);
        if (wrong)
            return no_word(engine, cells, i, values[i], wrong);
    }
    return FP3_OK;
}

fp3_status fp3_cells_write_numbers(fp3_engine *engine, fp3_cells cells, const float *values) {
    uint32_t words[BLOCK];
    if (fp3_format_is_float(engine->config))
        return fp3_cells_write(engine, cells, values);
    fp3_status status = check_numbers(engine, cells, values);
    for (size_t left = cells.count; !status && left; left -= cells.count) {
        cells.count = left < BLOCK ? left : BLOCK;
        for (size_t i = 0; i < cells.count; i++)
            word_of(engine, cells, i, values[i], &words[i]);
        status = fp3_cells_write(engine, cells, words);
        cells.first += cells.count;
        values += cells.count;
    }
    return status;
}

static fp3_status read_numbers(fp3_engine *engine, fp3_cells cells, float *values) {
    const fp3_status status = engine->backend->read(engine, cells, values);
    for (size_t i = 0; !status && !fp3_format_is_float(engine->config) && i < cells.count; i++) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        if (!is_whole(engine, cells, i))
            values[i] = fp3_format_value(engine->config, word);
    }
    return status;
}

fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values) {
    const fp3_cells cells = {FP3_CELLS_REGISTER, reg, first, count};
    const fp3_status status = check_cell(engine, first, count, reg);
    return status ? status : fp3_cells_write_numbers(engine, cells, values);
}

fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values) {
    const fp3_cells cells = {FP3_CELLS_REGISTER, reg, first, count};
    const fp3_status status = check_cell(engine, first, count, reg);
    return status ? status : read_numbers(engine, cells, values);
}

fp3_status fp3_engine_column(fp3_engine *engine, uint32_t reg, const float **values) {
    const fp3_status status = check_cell(engine, 0, 1, reg);
    const uint32_t *words = NULL;
    *values = NULL;
    if (status || !engine->backend->column || !fp3_format_is_float(engine->config))
        return status;
    const fp3_status found = engine->backend->column(engine, reg, &words);
    *values = (const float *)(const void *)words;
    return found;
}

fp3_status fp3_engine_write_shared_of(fp3_engine *engine, size_t group, uint32_t first,
                                      size_t count, const float *values) {
    const fp3_cells cells = {FP3_CELLS_CONSTANT, (uint32_t)group, first, count};
    const fp3_status status = check_shared(engine, group, first, count);
    return status ? status : fp3_cells_write_numbers(engine, cells, values);
}

fp3_status fp3_engine_read_shared_of(fp3_engine *engine, size_t group, uint32_t first, size_t count,
                                     float *values) {
    const fp3_cells cells = {FP3_CELLS_CONSTANT, (uint32_t)group, first, count};
    const fp3_status status = check_shared(engine, group, first, count);
    return status ? status : read_numbers(engine, cells, values);
}

fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_engine_write_shared_of(engine, i, first, count, values);
    return status;
}

fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values) {
    return fp3_engine_read_shared_of(engine, 0, first, count, values);
}

/* ---- by name ---- */

static fp3_status no_name(fp3_engine *engine, const char *name) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "the program has no '%s'", name);
}

static fp3_status set_symbol(fp3_engine *engine, uint32_t number, const fp3_symbol *symbol,
                             float value) {
    const fp3_members *group = &engine->layout.groups[number];
    if (symbol->symbol_class == FP3_SYMBOL_SHARED)
        return fp3_engine_write_shared_of(engine, number, symbol->index, 1, &value);
    const fp3_cells cells = fp3_cells_of(group, symbol->index, group->first, group->objects);
    const fp3_status status = check_cell(engine, group->first, group->objects, symbol->index);
    uint32_t word = 0;
    const char *wrong = word_of(engine, cells, 0, value, &word);
    if (status || wrong)
        return status ? status : no_word(engine, cells, 0, value, wrong);
    return fp3_cells_fill(engine, cells, word);
}

fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value) {
    int is_found = 0;
    fp3_status status = fp3_engine_check_loaded(engine);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_symbol *symbol =
            fp3_image_find(engine->layout.groups[i].image, name, FP3_CLASSES_HOST);
        if (symbol)
            status = set_symbol(engine, i, symbol, value);
        is_found |= symbol != NULL;
    }
    return status || is_found ? status : no_name(engine, name);
}

fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value) {
    fp3_status status = fp3_engine_check_loaded(engine);
    if (!status)
        status = fp3_engine_check_objects(engine, object, 1);
    if (status)
        return status;
    const fp3_members *group = fp3_layout_group_of(&engine->layout, object);
    const fp3_symbol *symbol =
        fp3_image_find(group->image, name, FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
    if (!symbol)
        return no_name(engine, name);
    if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_SHARED)
        return fp3_engine_read_shared_of(engine, (size_t)(group - engine->layout.groups),
                                         symbol->index, 1, value);
    return fp3_engine_read(engine, object, 1, symbol->index, value);
}
