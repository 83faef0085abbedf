/* SPDX-License-Identifier: Apache-2.0 */
/* read.c - opens a checkpoint, and gives its state to an engine that has been loaded alike. */
#include "checkpoint.h"

#include "base/file.h"
#include "envelope.h"
#include "library_hdf5.h"

#include <fp3/image.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

struct fp3_checkpoint {
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    char *path, *command, *config;
    uint64_t step, flags, groups, objects; /* attributes */
    int is_of_bodies;
    fp3_digest start, hash, before, chain, links, lives;
};

static fp3_status failed(const fp3_checkpoint *c, fp3_error *error) {
    return fp3_hdf5_cannot_read(c->calls, c->file, c->path, error);
}

/* Of a file that is whole, but not what this version writes. */
static fp3_status foreign(const fp3_checkpoint *c, const char *name, fp3_error *error) {
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s: no checkpoint of this version: '%s' is not as expected", c->path, name);
}

/* ---- opening ---- */

/* An fp3_hdf5_number_fn. */
static void note(void *user, const char *name, double value) {
    fp3_checkpoint *c = user;
    const struct {
        const char *name;
        uint64_t *to;
    } known[] = {
        {"step", &c->step}, {"flags", &c->flags}, {"groups", &c->groups}, {"objects", &c->objects}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(name, known[i].name) && value >= 0 && value < 0x1p53)
            *known[i].to = (uint64_t)value;
}

static int read_digest(const fp3_checkpoint *c, const char *name, fp3_digest *digest) {
    char *text = c->calls->text_of(c->file, -1, name);
    const int is_good = fp3_digest_read(text, digest);
    free(text);
    return is_good;
}

static fp3_status read_attributes(fp3_checkpoint *c, uint64_t step, fp3_error *error) {
    if (c->calls->numbers(c->file, note, c))
        return failed(c, error);
    c->command = c->calls->text_of(c->file, -1, "command");
    c->config = c->calls->text_of(c->file, -1, "configuration");
    const int is_good = read_digest(c, "start", &c->start) && read_digest(c, "hash", &c->hash) &&
                        read_digest(c, "before", &c->before) &&
                        read_digest(c, "chain", &c->chain) && read_digest(c, "links", &c->links) &&
                        read_digest(c, "lifetimes", &c->lives);
    return is_good && c->command && c->config && c->step == step && c->groups && c->objects
               ? FP3_OK
               : foreign(c, "attributes", error);
}

/* One that a program has written has no chain and no command. */
static fp3_status read_bodies(fp3_checkpoint *c, uint64_t step, fp3_error *error) {
    c->step = step;
    c->command = c->calls->text_of(c->file, -1, "command");
    if (!c->command)
        c->command = strdup("");
    else if (!read_digest(c, "before", &c->before) || !read_digest(c, "chain", &c->chain))
        return foreign(c, "attributes", error);
    return c->command ? FP3_OK : fp3_no_memory(error);
}

static fp3_status open_file(fp3_checkpoint *c, fp3_error *error) {
    uint64_t step = 0;
    fp3_status status = fp3_library_hdf5(&c->calls, error);
    if (!status)
        status = fp3_envelope_open(c->calls, c->path, &step, error);
    if (!status && !(c->file = c->calls->open(c->path)))
        status = fp3_no_memory(error);
    if (status)
        return status;
    char *form = c->calls->text_of(c->file, -1, FP3_CHECKPOINT_BODIES);
    c->is_of_bodies = form != NULL;
    free(form);
    return c->is_of_bodies ? read_bodies(c, step, error) : read_attributes(c, step, error);
}

/* Adds to error that the file before is whole, if it is. */
static void name_before(const fp3_checkpoint *c, fp3_error *error) {
    char *before = fp3_output_before(c->path);
    uint64_t step;
    fp3_error other;
    const fp3_error why = *error;
    if (before && c->calls && !fp3_envelope_open(c->calls, before, &step, &other))
        fp3_fail(error, FP3_E_ARGUMENT, "%s; %s is whole, after %" PRIu64 " steps", why.text,
                 before, step);
    free(before);
}

fp3_status fp3_checkpoint_open(const char *path, fp3_checkpoint **checkpoint, fp3_error *error) {
    fp3_checkpoint *c = calloc(1, sizeof *c);
    *checkpoint = NULL;
    if (!c || !(c->path = strdup(path))) {
        free(c);
        return fp3_no_memory(error);
    }
    const fp3_status status = open_file(c, error);
    if (status) {
        name_before(c, error);
        fp3_checkpoint_close(&c);
    }
    *checkpoint = c;
    return status;
}

void fp3_checkpoint_close(fp3_checkpoint **checkpoint) {
    fp3_checkpoint *c = *checkpoint;
    *checkpoint = NULL;
    if (!c)
        return;
    if (c->file)
        c->calls->close(c->file);
    free(c->path);
    free(c->command);
    free(c->config);
    free(c);
}

uint64_t fp3_checkpoint_step(const fp3_checkpoint *c) { return c->step; }

void fp3_checkpoint_chain(const fp3_checkpoint *c, fp3_digest *before, fp3_digest *chain) {
    *before = c->before;
    *chain = c->chain;
}

const char *fp3_checkpoint_command(const fp3_checkpoint *c) { return c->command; }

/* ---- datasets ---- */

/* Its number; -1: there is none. */
static int look_up(const fp3_checkpoint *c, const char *name, fp3_hdf5_table *table) {
    for (int i = 0; i < c->calls->count(c->file); i++)
        if (!c->calls->describe(c->file, i, table) && !strcmp(table->name, name))
            return i;
    return -1;
}

/* -1: there is none of this size. */
static int find(const fp3_checkpoint *c, const char *name, uint64_t rows, uint64_t columns) {
    fp3_hdf5_table table;
    const int dataset = look_up(c, name, &table);
    return dataset >= 0 && table.rows == rows && table.columns == columns ? dataset : -1;
}

static fp3_status take_list(const fp3_checkpoint *c, const char *name, uint32_t *words,
                            size_t count, fp3_error *error) {
    const fp3_hdf5_part part = {.rows = count};
    const int dataset = find(c, name, count, 0);
    if (dataset < 0)
        return foreign(c, name, error);
    return c->calls->read(c->file, dataset, FP3_HDF5_UINT32, &part, words) ? failed(c, error)
                                                                           : FP3_OK;
}

static fp3_status take_of_group(const fp3_checkpoint *c, const char *what, uint32_t group,
                                uint32_t *words, size_t count, fp3_error *error) {
    char name[FP3_CHECKPOINT_NAME];
    fp3_checkpoint_name(name, what, group);
    return take_list(c, name, words, count, error);
}

/* ---- comparing ---- */

static fp3_status compare_image(const fp3_checkpoint *c, const fp3_state *state, uint32_t group,
                                fp3_error *error) {
    uint32_t *here = NULL, *there = NULL;
    size_t count = 0;
    char name[FP3_CHECKPOINT_NAME];
    fp3_status status = fp3_image_encode(state->layout->groups[group].image, &here, &count, error);
    if (!status && !(there = calloc(count, sizeof *there)))
        status = fp3_no_memory(error);
    fp3_checkpoint_name(name, "image", group);
    if (!status && find(c, name, count, 0) >= 0)
        status = take_list(c, name, there, count, error);
    if (!status && memcmp(here, there, count * sizeof *here))
        status = fp3_fail(error, FP3_E_ARGUMENT,
                          "%s: its group %" PRIu32 " runs another program than this run", c->path,
                          group);
    free(here);
    free(there);
    return status;
}

static const char *name_of_constant(const fp3_image *image, uint32_t index) {
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (FP3_CLASS(image->symbols[i].symbol_class) & FP3_CLASSES_SHARED &&
            image->symbols[i].index == index)
            return image->symbols[i].name;
    return "a constant without a name";
}

static fp3_status compare_constants(const fp3_checkpoint *c, const fp3_state *state, uint32_t group,
                                    fp3_error *error) {
    const uint32_t count = fp3_engine_config(state->engine)->registers;
    float here[64], there[64];
    fp3_status status = fp3_engine_read_shared_of(state->engine, group, 0, count, here);
    if (!status)
        status = take_of_group(c, "constants", group, (uint32_t *)(void *)there, count, error);
    for (uint32_t i = 0; !status && i < count; i++)
        if (memcmp(&here[i], &there[i], sizeof *here))
            status = fp3_fail(error, FP3_E_ARGUMENT,
                              "%s: %s is %.9g in the checkpoint and %.9g in this run", c->path,
                              name_of_constant(state->layout->groups[group].image, i),
                              (double)there[i], (double)here[i]);
    return status;
}

static fp3_status compare_sizes(const fp3_checkpoint *c, const fp3_state *state, fp3_error *error) {
    const char *config = fp3_engine_config(state->engine)->name;
    const size_t objects = fp3_engine_objects(state->engine);
    if (strcmp(c->config, config))
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: of configuration '%s', and this run has '%s'",
                        c->path, c->config, config);
    if (c->groups != state->layout->count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: has %" PRIu64 " groups, and this run has %" PRIu32, c->path, c->groups,
                        state->layout->count);
    if (c->objects != objects)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: has %" PRIu64 " objects, and this run has %zu",
                        c->path, c->objects, objects);
    return FP3_OK;
}

static fp3_status compare_digest(const fp3_checkpoint *c, const fp3_digest *there,
                                 const fp3_digest *here, const char *what, fp3_error *error) {
    return fp3_digest_same(there, here)
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "%s: its run began with other %s", c->path, what);
}

/* The hash of the start comes last: it tells the least. */
static fp3_status compare(const fp3_checkpoint *c, const fp3_state *state, const fp3_past *past,
                          fp3_error *error) {
    fp3_digest links, lives;
    fp3_status status = compare_sizes(c, state, error);
    for (uint32_t i = 0; !status && i < state->layout->count; i++) {
        status = compare_image(c, state, i, error);
        if (!status)
            status = compare_constants(c, state, i, error);
    }
    if (!status)
        status = fp3_checkpoint_links(state, &links, error);
    if (!status)
        status = compare_digest(c, &c->links, &links, "links between objects, or reaches", error);
    if (!status)
        status = fp3_checkpoint_lives(state, &lives, error);
    if (!status)
        status = compare_digest(c, &c->lives, &lives, "lifetimes", error);
    return status ? status
                  : compare_digest(c, &c->start, &past->start,
                                   "start values or params, or numbers of objects in its groups",
                                   error);
}

/* ---- restoring ---- */

static fp3_status restore_group(const fp3_checkpoint *c, fp3_state *state, uint32_t number,
                                fp3_error *error) {
    const fp3_members *group = &state->layout->groups[number];
    char name[FP3_CHECKPOINT_NAME];
    fp3_checkpoint_name(name, "words", number);
    const uint32_t rows = fp3_state_registers(state, number);
    const int dataset = find(c, name, rows, group->objects);
    fp3_status status = rows && dataset < 0 ? foreign(c, name, error) : FP3_OK;
    uint32_t row = 0;
    for (uint32_t reg = 0; !status && reg < 64; reg++) {
        const fp3_hdf5_part part = {.row = row, .rows = 1, .columns = group->objects};
        if (!(state->kept[number] >> reg & 1))
            continue;
        if (c->calls->read(c->file, dataset, FP3_HDF5_UINT32, &part, state->words))
            status = failed(c, error);
        else
            status = fp3_engine_write_words(state->engine, group->first, group->objects, reg,
                                            state->words);
        row++;
    }
    return status;
}

/* Words of pairs, as of fp3_state_row, to what a list gets; 0: they are no list of these objects.
 */
static int are_pairs(const fp3_list *list, uint32_t others, const uint32_t *words, uint32_t pairs,
                     fp3_remembered *to) {
    const uint32_t fields = list->fields, names = list->is_near ? 2 : 0;
    uint32_t before = 0;
    for (uint32_t i = 0; i < pairs; i++, words += names + fields) {
        if (names && (words[0] >= list->own || words[0] < before || words[1] >= others))
            return 0;
        if (names) {
            before = words[0];
            to->begin[before + 1]++;
            to->other[i] = words[1];
        }
        memcpy(&to->field[(size_t)i * fields], &words[names], fields * sizeof *words);
    }
    for (uint32_t i = 0; names && i < list->own; i++)
        to->begin[i + 1] += to->begin[i];
    return 1;
}

static fp3_status restore_pairs(const fp3_checkpoint *c, fp3_state *state, uint32_t group,
                                uint32_t which, fp3_error *error) {
    const fp3_list *list = &state->layout->groups[group].lists.lists[which];
    const uint32_t others = state->layout->groups[list->kind ? list->kind - 1 : group].objects;
    char name[FP3_CHECKPOINT_NAME];
    fp3_hdf5_table table = {0};
    fp3_checkpoint_list_name(name, group, list->reg);
    const int dataset = look_up(c, name, &table);
    const uint64_t links = list->is_near ? 0 : fp3_list_given(list).begin[list->objects],
                   pairs = dataset < 0 ? 0 : table.rows;
    const uint32_t each = list->fields + (list->is_near ? 2 : 0);
    if (pairs > INT32_MAX || (!list->is_near && pairs != links) ||
        (dataset >= 0 && table.columns != each))
        return foreign(c, name, error);
    uint32_t *words = calloc(pairs * each + 1, sizeof *words);
    fp3_remembered to = {calloc(list->own + (size_t)1, sizeof *to.begin),
                         calloc(pairs + 1, sizeof *to.other),
                         calloc(pairs * list->fields + 1, sizeof *to.field)};
    const fp3_hdf5_part part = {.rows = pairs, .columns = each};
    fp3_status status = words && to.begin && to.other && to.field ? FP3_OK : fp3_no_memory(error);
    if (!status && pairs && c->calls->read(c->file, dataset, FP3_HDF5_UINT32, &part, words))
        status = failed(c, error);
    if (!status && !are_pairs(list, others, words, (uint32_t)pairs, &to))
        status = foreign(c, name, error);
    if (!status)
        status = fp3_engine_write_remembered(state->engine, group, which, &to);
    free(words);
    fp3_remembered_free(&to);
    return status;
}

static fp3_status restore_memory(const fp3_checkpoint *c, fp3_state *state, uint32_t group,
                                 fp3_error *error) {
    const fp3_lists *lists = &state->layout->groups[group].lists;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < lists->shape.list_count; i++)
        if (fp3_list_remembers(&lists->lists[i]))
            status = restore_pairs(c, state, group, i, error);
    return status;
}

static fp3_status restore_status(const fp3_checkpoint *c, fp3_state *state, fp3_error *error) {
    if (!fp3_engine_config(state->engine)->status)
        return FP3_OK;
    const fp3_status status = take_list(c, "status", state->words, c->objects, error);
    return status ? status : fp3_engine_write_status(state->engine, state->words);
}

static fp3_status take_past(const fp3_checkpoint *c, const fp3_state *state, fp3_past *past,
                            fp3_error *error) {
    fp3_status status = take_list(c, "failed", past->has_failed, c->objects, error);
    for (uint32_t i = 0; !status && i < state->layout->count; i++) {
        uint32_t words[FP3_FAILURE_WORDS];
        status = take_of_group(c, "failure", i, words, FP3_FAILURE_WORDS, error);
        if (!status)
            past->failures[i] = fp3_failure_unpack(words);
        if (!status && (past->failures[i].object >= c->objects ||
                        past->failures[i].state >= FP3_BANK_OBJECT_COUNT))
            status = fp3_fail(error, FP3_E_ARGUMENT,
                              "%s: has the failure of an object or of a state that does not exist",
                              c->path);
    }
    past->step = c->step;
    past->flags = (uint32_t)c->flags;
    past->hash = c->hash;
    past->chain = c->chain;
    return status;
}

fp3_status fp3_checkpoint_restore(fp3_checkpoint *c, fp3_state *state, fp3_past *past,
                                  fp3_error *error) {
    fp3_status status = c->is_of_bodies ? fp3_fail(error, FP3_E_ARGUMENT,
                                                   "%s: a checkpoint of rigid bodies", c->path)
                                        : compare(c, state, past, error);
    for (uint32_t i = 0; !status && i < state->layout->count; i++)
        status = restore_group(c, state, i, error);
    for (uint32_t i = 0; !status && i < state->layout->count; i++)
        status = restore_memory(c, state, i, error);
    if (!status)
        status = restore_status(c, state, error);
    if (!status)
        status = take_past(c, state, past, error);
    if (status)
        return status;
    fp3_engine_resume(state->engine, c->step);
    fp3_digest hash;
    status = fp3_state_hash(state, c->step, &hash, error);
    return status || fp3_digest_same(&hash, &c->hash)
               ? status
               : fp3_fail(error, FP3_E_MISMATCH,
                          "%s: damaged: the words do not have the hash in "
                          "the file",
                          c->path);
}
