/* SPDX-License-Identifier: Apache-2.0 */
/* load.c - programs and groups: whether the configuration has room for them, and loading them. */
#include "engine/common/cells.h"
#include "engine/common/checks.h"
#include "engine/common/life.h"
#include "engine/common/luggage.h"
#include "engine/common/origin.h"
#include "kinds.h"
#include "machine/format.h"
#include "machine/needs.h"
#include "machine/operation.h"
#include "machine/storage.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static fp3_needs needs_of(const fp3_image *image) {
    fp3_needs needs = {
        .registers = image->registers, .constants = image->shared, .words = image->code_count};
    for (uint32_t i = 0; i < image->code_count; i++)
        if (image->decoded[i].of)
            needs.operations |= fp3_operation_bit(image->decoded[i].in.op);
    return needs;
}

/* Where the host executes, words are in its memory. */
static fp3_status check_needs(fp3_engine *engine, fp3_needs needs) {
    if (!engine->backend->is.is_hardware)
        needs.words = 0;
    return fp3_needs_check(&needs, engine->config, engine->def.error);
}

static fp3_status check_operations(fp3_engine *engine, const fp3_image *image) {
    for (uint32_t i = 0; i < image->code_count; i++) {
        const fp3_decoded *word = &image->decoded[i];
        if (!word->of)
            continue;
        const fp3_key key = fp3_operation_lacks(engine->config, word->in.op);
        if (key != FP3_KEY_NONE)
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "word %" PRIu32 " is %s, which configuration '%s' does not have", i,
                            fp3_key_lack(key), engine->config->name);
        const char *mixes = fp3_operation_mixes(engine->config, &word->in);
        if (mixes)
            return fp3_fail(
                engine->def.error, FP3_E_PROGRAM,
                "word %" PRIu32 " (%s) %s: configuration '%s' keeps sums in registers of "
                "even number and products in those of odd number, and reads one of each",
                i, word->of->name, mixes, engine->config->name);
    }
    return FP3_OK;
}

/* With adaptive steps an object's time goes from visit to visit in its record. */
static fp3_status check_storage(fp3_engine *engine, const fp3_image *image) {
    if (!engine->config->storage || !fp3_adaptive_is(image))
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "the program chooses its steps: configuration '%s' keeps records in %s, which "
                    "is too coarse for times",
                    engine->config->name, fp3_storage_name(engine->config));
}

/* An image may say what they have to be. */
static fp3_status check_words(fp3_engine *engine, const fp3_image *image) {
    const uint32_t has = fp3_config_words(engine->config);
    char made[FP3_WORDS_NAME_SIZE], said[FP3_WORDS_NAME_SIZE];
    if (image->words == FP3_WORDS_ANY || image->words == has)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "the program is made for %s: words of configuration '%s' are %s",
                    fp3_image_words_said(image->words, made), engine->config->name,
                    fp3_image_words_said(has, said));
}

static fp3_status check_constants(fp3_engine *engine, const fp3_image *image) {
    for (uint32_t i = 0; i < image->constant_count; i++) {
        const fp3_constant *c = &image->constants[i];
        uint32_t word;
        float value;
        memcpy(&value, &c->bits, sizeof value);
        const char *wrong = fp3_format_word(engine->config, value, &word);
        if (wrong)
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "the program's constant %g %s: configuration '%s' has no word for it",
                            (double)value, wrong, engine->config->name);
    }
    return FP3_OK;
}

static fp3_status check_image(fp3_engine *engine, const fp3_image *image) {
    fp3_status status = check_words(engine, image);
    if (!status)
        status = check_needs(engine, needs_of(image));
    if (!status)
        status = check_storage(engine, image);
    if (!status)
        status = check_operations(engine, image);
    return status ? status : check_constants(engine, image);
}

/* What is there besides the image's words, and what an object needs of the store. */
static fp3_status check_visit(fp3_engine *engine, const fp3_image *image, const fp3_visit *visit,
                              size_t objects) {
    const fp3_config *config = engine->config;
    const uint32_t lanes = fp3_config_schedulers(config) * config->lanes;
    const uint64_t room = (uint64_t)fp3_placement_rows(config, visit->log2) * lanes;
    fp3_needs needs = needs_of(image);
    needs.words = visit->code_count;
    needs.is_visited = 1;
    const fp3_status status = check_needs(engine, needs);
    if (status)
        return status;
    if (objects > room)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program needs %u words of the object store for each object: "
                        "configuration '%s' has room for %" PRIu64 " objects, not for %zu",
                        1u << visit->log2, config->name, room, objects);
    return FP3_OK;
}

static fp3_code program_of(const fp3_image *image, const fp3_visit *visit) {
    if (visit)
        return (fp3_code){visit->code, visit->decoded,        visit->code_count, visit->step,
                          visit->last, visit->loads_in_front, visit->slept};
    return (fp3_code){image->code, image->decoded, image->code_count, image->step, image->last, 0,
                      -1};
}

static fp3_status copy_foreign(fp3_engine *engine, const fp3_group *from, fp3_members *to) {
    to->foreign = calloc(from->foreign_count + 1, sizeof *to->foreign);
    for (size_t i = 0; to->foreign && i < from->foreign_count; i++) {
        fp3_foreign *f = &to->foreign[to->foreign_count++];
        *f = (fp3_foreign){strdup(from->foreign[i].word), from->foreign[i].group,
                           strdup(from->foreign[i].of)};
        if (!f->word || !f->of)
            return fp3_no_memory(engine->def.error);
    }
    return to->foreign ? FP3_OK : fp3_no_memory(engine->def.error);
}

/* A copy of the image and, interleaved, what is made of it; checked, unless check is 0. */
static fp3_status prepare(fp3_engine *engine, const fp3_group *from, int check, int is_part,
                          fp3_members *to) {
    fp3_error *error = engine->def.error;
    fp3_status status = fp3_image_make(from->image, &to->image, error);
    if (!status && check)
        status = check_image(engine, to->image);
    if (!status && engine->config->interleave)
        status = fp3_visit_make(to->image, &to->visit, error);
    if (!status && to->visit && check)
        status = check_visit(engine, to->image, to->visit, from->objects);
    fp3_neighbourhood around;
    if (!status)
        status = fp3_neighbourhood_find(to->image, &around, error);
    if (status)
        return status;
    fp3_lists_open(&around, (uint32_t)from->objects, &to->lists);
    to->objects = to->rows = (uint32_t)from->objects;
    to->program = program_of(to->image, to->visit);
    to->counter = fp3_image_steps(to->image);
    to->rest = is_part ? -1 : fp3_image_rest(to->image);
    to->removed = is_part ? -1 : fp3_image_removed(to->image);
    to->needs = to->visit && check ? to->visit->log2 : 0;
    return copy_foreign(engine, from, to);
}

static fp3_status check_groups(fp3_engine *engine, const fp3_group *groups, size_t count) {
    fp3_error *error = engine->def.error;
    size_t objects = 0;
    if (count == 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "no group of objects");
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    int is_joined = 0;
    for (size_t i = 0; i < count && i < fp3_layout_room(engine->config); i++)
        is_joined |= groups[i].foreign_count > 0;
    if (is_joined && count > FP3_JOINED_MAX)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%zu groups, some of which see others: expected at most %d", count,
                        FP3_JOINED_MAX);
    if (!is_joined && count > schedulers)
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "%zu groups, each with a program of its own: configuration '%s' has %" PRIu32
            " scheduler%s",
            count, engine->config->name, schedulers, schedulers == 1 ? "" : "s");
    for (size_t i = 0; i < count; i++) {
        if (groups[i].objects == 0)
            return fp3_fail(error, FP3_E_ARGUMENT, "group %zu has no objects", i);
        if (groups[i].objects > engine->objects - objects)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "groups of more objects than the %" PRIu32 " of the engine",
                            engine->objects);
        objects += groups[i].objects;
    }
    if (objects < engine->objects)
        return fp3_fail(error, FP3_E_ARGUMENT, "groups of %zu objects: the engine has %" PRIu32,
                        objects, engine->objects);
    return FP3_OK;
}

/* Messages about a group begin with its number, where there are several. */
static void say_group(const fp3_engine *engine, fp3_status status, size_t i, size_t count) {
    if (!status || !engine->def.error || count == 1)
        return;
    const fp3_error why = *engine->def.error;
    fp3_fail(engine->def.error, status, "%s%s", fp3_engine_prefix(i, count).text, why.text);
}

/* Objects that are removed: those that are left are the only ones that a run visits. */
static fp3_status check_removal(fp3_engine *engine, const fp3_layout *layout,
                                const fp3_members *group) {
    const int is_divided = fp3_kinds_usual(engine)->is_divided;
    const int sees = fp3_layout_is_joined(layout) || group->lists.shape.is_any;
    if (group->removed < 0)
        return FP3_OK;
    if (is_divided)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program removes objects: several ranks would have to agree on who is "
                        "left");
    if (engine->config->interleave && !engine->config->sleep && !sees)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program removes objects: configuration '%s' has no sleep: all its "
                        "objects make all steps",
                        engine->config->name);
    return FP3_OK;
}

static fp3_status prepare_all(fp3_engine *engine, const fp3_group *groups, size_t count, int check,
                              int is_part, fp3_layout *layout) {
    fp3_status status = fp3_layout_make(engine->config, (uint32_t)count, layout, engine->def.error);
    for (size_t i = 0; !status && i < count; i++) {
        status = prepare(engine, &groups[i], check, is_part, &layout->groups[i]);
        say_group(engine, status, i, count);
    }
    for (size_t i = 0; !status && i < count; i++) {
        status = check_removal(engine, layout, &layout->groups[i]);
        say_group(engine, status, i, count);
    }
    if (!status && fp3_layout_is_joined(layout)) {
        fp3_layout_place_apart(layout, engine->config);
        return FP3_OK;
    }
    if (!status)
        status = fp3_layout_place(layout, engine->config, engine->def.visit, engine->def.error);
    for (size_t i = 0; !status && engine->backend->check && i < count; i++) {
        status = engine->backend->check(engine, &layout->groups[i]);
        say_group(engine, status, i, count);
    }
    return status;
}

/* In an image they are binary32, so that it is the same for all formats of words. */
static fp3_status write_constants(fp3_engine *engine, uint32_t group) {
    const fp3_image *image = engine->layout.groups[group].image;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < image->constant_count; i++) {
        const fp3_constant *c = &image->constants[i];
        const fp3_cells cell = {FP3_CELLS_CONSTANT, group, c->index, 1};
        float value;
        memcpy(&value, &c->bits, sizeof value);
        status = fp3_cells_write_numbers(engine, cell, &value);
    }
    return status;
}

/* Changes the backend to that of `kinds`, or back to the usual one if kinds is NULL. */
static fp3_status become(fp3_engine *engine, const fp3_backend *usual, fp3_kinds *kinds) {
    const int was_joined = engine->backend != usual;
    if (!kinds && !was_joined)
        return FP3_OK;
    engine->backend->close(engine);
    engine->backend = kinds ? fp3_kinds_backend(kinds) : usual;
    engine->self = kinds;
    return kinds ? FP3_OK : usual->open(engine);
}

/* From here on there is no way back. */
static fp3_status settle(fp3_engine *engine, fp3_layout *layout, fp3_luggage *l, fp3_kinds *kinds) {
    const fp3_layout old = engine->layout;
    fp3_status status = become(engine, fp3_kinds_usual(engine), kinds);
    engine->layout = *layout;
    *layout = old;
    engine->clock = 0;
    engine->made = 0;
    if (!status)
        status = fp3_life_begin(engine);
    engine->sleepers.is_known = engine->sleepers.is_listed = engine->is_counted = 0;
    engine->is_touched = 1;
    if (!status)
        status = fp3_origin_load(engine, l->objects != NULL);
    if (!status)
        status = engine->backend->load(engine);
    if (!status && l->objects)
        status = fp3_luggage_unpack(engine, l);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = write_constants(engine, i);
    return status;
}

/* Objects stay where they are, and which word of a record is kept whole stays the same. */
static int is_same(const fp3_engine *engine, const fp3_layout *layout) {
    int is = fp3_layout_is_same(&engine->layout, layout);
    for (uint32_t i = 0; is && engine->config->storage && i < layout->count; i++)
        is &= engine->layout.groups[i].program.slept == layout->groups[i].program.slept;
    return is;
}

static fp3_status load(fp3_engine *engine, const fp3_group *groups, size_t count, int check,
                       int is_part);

static fp3_status load_one(fp3_engine *own, const fp3_image *image) {
    return load(own, &(fp3_group){.image = image, .objects = own->objects}, 1, 1, 1);
}

static fp3_status load_one_unchecked(fp3_engine *own, const fp3_image *image) {
    return load(own, &(fp3_group){.image = image, .objects = own->objects}, 1, 0, 1);
}

/* An engine for each group. */
static fp3_status open_kinds(fp3_engine *engine, fp3_layout *layout, int check, fp3_kinds **kinds) {
    uint32_t group = 0;
    const fp3_status status =
        fp3_kinds_make(engine, fp3_kinds_usual(engine), check ? load_one : load_one_unchecked,
                       layout, &group, kinds);
    if (group < layout->count)
        say_group(engine, status, group, layout->count);
    return status;
}

/* is_part: who sleeps is decided by the engine that this one is a part of. */
static fp3_status load(fp3_engine *engine, const fp3_group *groups, size_t count, int check,
                       int is_part) {
    fp3_layout layout = {0};
    fp3_luggage l = {0};
    fp3_kinds *kinds = NULL;
    const fp3_backend *usual = fp3_kinds_usual(engine);
    fp3_status status = check_groups(engine, groups, count);
    if (!status)
        status = prepare_all(engine, groups, count, check, is_part, &layout);
    if (!status && fp3_layout_is_joined(&layout))
        status = open_kinds(engine, &layout, check, &kinds);
    if (!status && engine->is_touched &&
        (kinds || engine->backend != usual || !is_same(engine, &layout)))
        status = fp3_luggage_pack(engine, &l);
    if (!status)
        status = settle(engine, &layout, &l, kinds);
    else
        fp3_kinds_free(&kinds);
    fp3_layout_free(&layout);
    fp3_luggage_free(&l);
    return status;
}

fp3_status fp3_engine_load_groups(fp3_engine *engine, const fp3_group *groups, size_t count) {
    return load(engine, groups, count, 1, 0);
}

fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image) {
    return load(engine, &(fp3_group){.image = image, .objects = engine->objects}, 1, 1, 0);
}

fp3_status fp3_engine_load_unchecked(fp3_engine *engine, const fp3_image *image) {
    return load(engine, &(fp3_group){.image = image, .objects = engine->objects}, 1, 0, 0);
}

fp3_status fp3_engine_load_again(fp3_engine *engine, const fp3_group *groups, size_t count) {
    return load(engine, groups, count, 0, 0);
}
