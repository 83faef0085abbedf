/* SPDX-License-Identifier: Apache-2.0 */
/* store_lists.c - see store_lists.h. */
#include "store_lists.h"

#include "driver.h"
#include "engine/common/follow.h"
#include "engine/common/ghosts.h"
#include "engine/common/luggage.h"
#include "engine/common/partition.h"
#include "memory.h"
#include "shared_list.h"

#include "gen/registers.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define MOST_NEIGHBOURS ((1u << (FP3_OBJECTS_LENGTH_HI - FP3_OBJECTS_LENGTH_LO + 1)) - 1)

/* A scheduler has one program, so there is one group where the hardware has neighbours. */
static fp3_members *group_of(const fp3_engine *engine) { return &engine->layout.groups[0]; }

static fp3_cells cells_of(const fp3_members *group, uint32_t reg) {
    return (fp3_cells){FP3_CELLS_REGISTER, reg, group->first, group->rows};
}

static int is_near(const fp3_engine *engine) {
    const fp3_lists *lists = &group_of(engine)->lists;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        if (lists->lists[i].is_near)
            return 1;
    return 0;
}

int fp3_store_lists_is_by_phase(const fp3_engine *engine) {
    return is_near(engine) || engine->exchange.end || engine->only ||
           group_of(engine)->lists.shape.worst;
}

/* ---- what the hardware cannot run ---- */

static fp3_status refuse(fp3_engine *engine, const char *what) {
    return fp3_fail(engine->def.error, FP3_E_PROGRAM, "engine '%s': %s", engine->backend->is.name,
                    what);
}

/* The hardware finds a list by its register: each phase loads it before it loops, and leaves it
 * alone. */
static fp3_status check_lists(fp3_engine *engine, const fp3_code *program) {
    uint64_t loaded = 0;
    for (uint32_t i = 0; i < program->count; i++) {
        const fp3_decoded *word = &program->decoded[i];
        if (!word->of)
            continue;
        if (word->in.op == FP3_OP_EACH && !(loaded & BIT(word->in.d)))
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "engine '%s': word %" PRIu32 ": the register r%" PRIu32
                            " of a list is not loaded in this phase, or overwritten",
                            engine->backend->is.name, i, word->in.d);
        if (fp3_ends_phase(word))
            loaded = 0;
        else if (word->in.op == FP3_OP_LD)
            loaded |= BIT(word->in.d);
        else if (word->of->writes != FP3_WRITES_NEVER)
            loaded &= ~BIT(word->in.d);
    }
    return FP3_OK;
}

fp3_status fp3_store_lists_check(fp3_engine *engine, const fp3_members *group) {
    const uint32_t half = engine->config->store_words / 2;
    if (!group->lists.shape.is_any)
        return FP3_OK;
    if (fp3_config_schedulers(engine->config) != 1)
        return refuse(engine, "objects that see each other need a configuration of one scheduler");
    if (group->visit->loads_in_front || group->visit->stores_behind)
        return refuse(engine, "a program with neighbours needs loads and stores of its own");
    if ((uint64_t)fp3_placement_fullest(engine->config, group->rows, 1) << group->log2 > half)
        return fp3_fail(
            engine->def.error, FP3_E_PROGRAM,
            "engine '%s': objects that see each other have half of the store: room for %" PRIu32
            " objects of %u words, not for %" PRIu32,
            engine->backend->is.name, (half >> group->log2) * engine->config->lanes,
            1u << group->log2, group->rows);
    return check_lists(engine, &group->program);
}

/* ---- lists in a lane's store: behind the records of either half ---- */

typedef struct {
    fp3_engine *engine;
    const fp3_ghosts *ghosts;
    uint32_t lane;
    uint32_t next[2], end[2];
    uint32_t *place; /* where lists are, as of fp3_store_lists */
} room;

static fp3_status open_room(fp3_engine *engine, const fp3_ghosts *ghosts, uint32_t lane, room *r) {
    const fp3_members *group = group_of(engine);
    const uint32_t half = engine->config->store_words / 2;
    const uint64_t records = (uint64_t)ghosts->used[lane] << group->log2;
    if (records > half)
        return fp3_fail(
            engine->def.error, FP3_E_PROGRAM,
            "engine '%s': records have half of the store: room for %" PRIu32
            " of %u words, not for %" PRIu32 ", %" PRIu32
            " of them copies of objects in other lanes or of other ranks",
            engine->backend->is.name, half >> group->log2, 1u << group->log2, ghosts->used[lane],
            ghosts->used[lane] - fp3_layout_rows(&engine->layout, engine->config, 0, lane));
    *r = (room){.engine = engine,
                .ghosts = ghosts,
                .lane = lane,
                .next = {(uint32_t)records, half + (uint32_t)records},
                .end = {half, 2 * half}};
    return FP3_OK;
}

/* Of a list's words, where the first is; UINT32_MAX: there is no room. */
static uint32_t take(room *r, uint32_t words) {
    for (int i = 0; i < 2; i++)
        if (r->end[i] - r->next[i] >= words) {
            const uint32_t place = r->next[i];
            r->next[i] += words;
            return place;
        }
    return UINT32_MAX;
}

static fp3_status write_entries(room *r, const fp3_list *list, uint32_t object, uint32_t place) {
    const fp3_config *config = r->engine->config;
    const uint32_t turns = fp3_list_turns(config, list, object);
    fp3_status status = FP3_OK;
    for (uint32_t turn = 0; !status && turn < turns; turn++) {
        const uint32_t row =
            fp3_ghosts_row(r->ghosts, r->lane, fp3_list_turn(config, list, object, turn));
        status = fp3_memory_put_word(r->engine, r->lane, place++, row);
        for (uint32_t k = 0; !status && k < list->fields; k++) {
            const size_t entry = list->begin[object] + turn;
            status = fp3_memory_put_word(r->engine, r->lane, place++,
                                         list->field[entry * list->fields + k]);
        }
    }
    return status;
}

static fp3_status no_room(const room *r, const fp3_list *list, uint32_t object) {
    const fp3_engine *engine = r->engine;
    if (fp3_list_is_shared(engine->config, list))
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "engine '%s': the store of configuration '%s' has no room for a list of "
                        "all %" PRIu32 " objects: its %" PRIu32 " words are full",
                        engine->backend->is.name, engine->config->name,
                        fp3_list_turns(engine->config, list, object), engine->config->store_words);
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "engine '%s': the store of configuration '%s' has no room for the "
                    "neighbours of object %" PRIu32 " of %" PRIu32 ": its %" PRIu32
                    " words are full",
                    engine->backend->is.name, engine->config->name, object, list->objects,
                    engine->config->store_words);
}

/* *place: where the list is. */
static fp3_status write_one(room *r, const fp3_list *list, uint32_t object, uint32_t *place) {
    fp3_engine *engine = r->engine;
    const uint32_t turns = fp3_list_turns(engine->config, list, object);
    if (turns > MOST_NEIGHBOURS)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "engine '%s': object %" PRIu32 " has %" PRIu32
                        " neighbours in a list, at most %u are possible",
                        engine->backend->is.name, object, turns, MOST_NEIGHBOURS);
    *place = take(r, turns * (1 + list->fields));
    return *place == UINT32_MAX ? no_room(r, list, object) : write_entries(r, list, object, *place);
}

static fp3_status write_list(room *r, const fp3_list *list) {
    fp3_engine *engine = r->engine;
    const fp3_members *group = group_of(engine);
    const int is_shared = fp3_list_is_shared(engine->config, list);
    uint32_t place = 0, written = 0; /* turns of the list at this place */
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < group->objects; i++) {
        const fp3_where at = fp3_layout_where(&engine->layout, engine->config, group->first + i);
        const uint32_t turns = fp3_list_turns(engine->config, list, i);
        if (at.lane != r->lane)
            continue;
        if (!is_shared || written < turns) {
            status = write_one(r, list, i, &place);
            written = turns;
        }
        r->place[(size_t)(list - group->lists.lists) * group->rows + i] = place;
        if (!status)
            status =
                fp3_memory_put_word(engine, r->lane, (at.row << group->log2) + list->reg,
                                    turns << FP3_OBJECTS_LENGTH_LO | place << FP3_OBJECTS_PLACE_LO);
    }
    return status;
}

/* ---- ghosts ---- */

static uint32_t place_word(uint32_t lane, uint32_t row) {
    return lane << FP3_COPIES_LANE_LO | row << FP3_COPIES_ROW_LO;
}

static fp3_status write_copies(fp3_engine *engine, const fp3_ghosts *ghosts) {
    const uint32_t most = engine->config->store_words / 2;
    fp3_status status = FP3_OK;
    if (!engine->config->exchange)
        return FP3_OK;
    if (ghosts->count > most)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "engine '%s': %" PRIu32
                        " objects have to be copied to other lanes in each phase, configuration "
                        "'%s' has room for a list of %" PRIu32,
                        engine->backend->is.name, ghosts->count, engine->config->name, most);
    for (uint32_t i = 0; !status && i < ghosts->count; i++) {
        const fp3_copy *copy = &ghosts->copies[i];
        status = fp3_memory_put_copy(engine, 2 * i, place_word(copy->from_lane, copy->from_row));
        if (!status)
            status = fp3_memory_put_copy(engine, 2 * i + 1,
                                         place_word(copy->to_lane, copy->to_row) |
                                             (uint32_t)copy->to_all << FP3_COPIES_EVERY_LO);
    }
    return status ? status
                  : fp3_driver_put(engine, fp3_driver_of_all(engine, FP3_ADDR_COPIES),
                                   2 * ghosts->count);
}

/* Words that neighbours read and no phase stores are not copied later. */
static fp3_status write_constant(fp3_engine *engine, const fp3_ghosts *ghosts, uint32_t reg,
                                 uint32_t *words) {
    const fp3_members *group = group_of(engine);
    fp3_status status = fp3_memory_read(engine, cells_of(group, reg), words);
    for (uint32_t lane = 0; lane < ghosts->lanes; lane++)
        for (uint32_t i = 0; !status && i < ghosts->objects; i++) {
            const uint32_t row = fp3_ghosts_row(ghosts, lane, i);
            const fp3_where at =
                fp3_layout_where(&engine->layout, engine->config, group->first + i);
            if (row != FP3_NO_ROW && at.lane != lane)
                status = fp3_memory_put_word(engine, lane, (row << group->log2) + reg, words[i]);
        }
    return status;
}

static fp3_status write_ghosts(fp3_engine *engine, const fp3_ghosts *ghosts, uint32_t *words) {
    const fp3_members *group = group_of(engine);
    const uint64_t constant = group->lists.shape.published & ~fp3_layout_published(group);
    fp3_status status = write_copies(engine, ghosts);
    for (uint32_t reg = 0; !status && ghosts->count && reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (constant & BIT(reg))
            status = write_constant(engine, ghosts, reg, words);
    return status;
}

static fp3_status write_lists(fp3_engine *engine, const fp3_store_lists *to) {
    const fp3_lists *lists = &group_of(engine)->lists;
    fp3_ghosts ghosts;
    fp3_status status = fp3_ghosts_find(engine, &ghosts);
    for (uint32_t lane = 0; !status && lane < ghosts.lanes; lane++) {
        room r = {0};
        status = open_room(engine, &ghosts, lane, &r);
        r.place = to->place;
        for (uint32_t i = 0; !status && i < lists->shape.list_count; i++)
            if (!to->kept || &lists->lists[i] != to->kept->list)
                status = write_list(&r, &lists->lists[i]);
    }
    if (!status && to->kept)
        status = fp3_kept_install(engine, to->kept);
    if (!status)
        status = write_ghosts(engine, &ghosts, to->words);
    fp3_ghosts_free(&ghosts);
    return status;
}

/* ---- a run ---- */

fp3_status fp3_store_lists_begin(fp3_engine *engine, fp3_store_lists *lists) {
    const fp3_members *group = group_of(engine);
    const uint32_t count = group->lists.shape.list_count;
    fp3_status status = FP3_OK;
    *lists = (fp3_store_lists){0};
    lists->words = malloc(group->rows * sizeof *lists->words);
    lists->saved = malloc(((size_t)count * group->rows + 1) * sizeof *lists->saved);
    lists->place = malloc(((size_t)count * group->rows + 1) * sizeof *lists->place);
    if (!lists->words || !lists->saved || !lists->place) {
        free(lists->saved);
        lists->saved = NULL;
        return fp3_no_memory(engine->def.error);
    }
    for (uint32_t i = 0; !status && i < count; i++)
        status = fp3_memory_read(engine, cells_of(group, group->lists.lists[i].reg),
                                 lists->saved + (size_t)i * group->rows);
    if (status) { /* nothing to put back */
        free(lists->saved);
        lists->saved = NULL;
    }
    return status;
}

/* The positions of all objects, for the lists that follow them. */
static fp3_status follow(fp3_engine *engine, int *is_new) {
    fp3_members *group = group_of(engine);
    const uint32_t *words[FP3_BANK_OBJECT_COUNT] = {NULL};
    uint32_t *all = NULL;
    uint64_t regs = 0;
    uint32_t count = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        regs |= fp3_near_registers(&group->lists.lists[i].near, group->lists.lists[i].kind);
    for (uint64_t left = regs; left; left &= left - 1)
        count++;
    if (!(all = malloc(((size_t)count * group->rows + 1) * sizeof *all)))
        return fp3_no_memory(engine->def.error);
    uint32_t *next = all;
    for (uint32_t reg = 0; !status && reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (regs & BIT(reg)) {
            status = fp3_memory_read(engine, cells_of(group, reg), next);
            words[reg] = next;
            next += group->rows;
        }
    if (!status)
        status = fp3_lists_follow(&group->lists, group->rows, group->rows, words, NULL, 1, NULL,
                                  is_new, engine->def.error);
    free(all);
    return status;
}

/* Lists are new, or others live: which lanes objects are in is decided anew, and they move there.
 */
static fp3_status place(fp3_engine *engine) {
    fp3_members *group = group_of(engine);
    const fp3_living *living = group->lists.living;
    fp3_luggage luggage = {0};
    uint32_t *slot = malloc((group->rows + (size_t)1) * sizeof *slot);
    fp3_status status = slot ? FP3_OK : fp3_no_memory(engine->def.error);
    if (!status)
        status = fp3_partition_find(engine, slot);
    if (!status)
        status = fp3_luggage_pack(engine, &luggage);
    if (!status)
        status = fp3_layout_arrange(group, slot, living ? group->objects - living->count : 0,
                                    engine->def.error);
    if (status)
        free(slot);
    else
        status = fp3_luggage_unpack(engine, &luggage);
    if (!status)
        status = fp3_memory_list(engine);
    fp3_luggage_free(&luggage);
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++)
        group->lists.lists[i].is_placed = 1;
    return status;
}

static int is_placed(const fp3_engine *engine) {
    const fp3_lists *lists = &group_of(engine)->lists;
    int is = 1;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is = is && lists->lists[i].is_placed;
    return is || (engine->config->lanes == 1 && !lists->living && !group_of(engine)->away);
}

fp3_status fp3_store_lists_follow(fp3_engine *engine, fp3_store_lists *lists) {
    int is_new = 0;
    fp3_status status = is_near(engine) ? follow(engine, &is_new) : FP3_OK;
    if (!status && !lists->is_written && !is_placed(engine))
        status = place(engine);
    if (!status && (is_new || !lists->is_written))
        status = write_lists(engine, lists);
    lists->is_written = !status;
    return status;
}

/* Whether the words that have run write fields. */
static int has_written(const fp3_engine *engine) {
    const fp3_code *program = &group_of(engine)->program;
    const int is_by_phase = fp3_store_lists_is_by_phase(engine);
    for (uint32_t i = ((const fp3_driver *)engine->self)->first; i < program->count; i++) {
        const fp3_decoded *word = &program->decoded[i];
        if (word->of && word->of->takes_field)
            return 1;
        if (is_by_phase && fp3_ends_phase(word))
            return 0;
    }
    return 0;
}

/* The fields of one object's list. */
static fp3_status read_fields(fp3_engine *engine, const fp3_list *list, uint32_t object,
                              uint32_t place) {
    const fp3_members *group = group_of(engine);
    const fp3_where at = fp3_layout_where(&engine->layout, engine->config, group->first + object);
    const size_t each = list->fields + (size_t)1, length = fp3_list_length(list, object);
    uint32_t *words = malloc((length * each + 1) * sizeof *words);
    if (!words)
        return fp3_no_memory(engine->def.error);
    const fp3_status status = fp3_memory_get_words(engine, at.lane, place, length * each, words);
    for (size_t turn = 0; !status && turn < length; turn++)
        memcpy(&list->field[(list->begin[object] + turn) * list->fields], &words[turn * each + 1],
               list->fields * sizeof *words);
    free(words);
    return status;
}

fp3_status fp3_store_lists_remember(fp3_engine *engine, const fp3_store_lists *lists) {
    const fp3_members *group = group_of(engine);
    fp3_status status = FP3_OK;
    if (!lists->is_written || !fp3_lists_remember(&group->lists) || !has_written(engine))
        return FP3_OK;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
        const fp3_list *list = &group->lists.lists[k];
        for (uint32_t i = 0; fp3_list_remembers(list) && !status && i < group->objects; i++)
            status = read_fields(engine, list, i, lists->place[(size_t)k * group->rows + i]);
    }
    return status;
}

fp3_status fp3_store_lists_look(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    uint32_t half = 0;
    const fp3_status status =
        fp3_driver_get(engine, fp3_driver_of_all(engine, FP3_ADDR_HALF), &half);
    self->is_upper = (int)(half & 1);
    return status;
}

/* Writes a word of each object, but of those that do not live, of guests and of objects behind
 * those in use: no phase has stored it, and it is where it was. */
static fp3_status write_living(fp3_engine *engine, fp3_cells cells, const uint32_t *words) {
    const fp3_living *living = group_of(engine)->lists.living;
    fp3_status status = FP3_OK;
    if (!living)
        return fp3_memory_write(
            engine, (fp3_cells){cells.kind, cells.number, cells.first, group_of(engine)->objects},
            words);
    for (uint32_t i = 0; !status && i < living->count; i++) {
        const uint32_t object = living->who[i];
        status = fp3_memory_write(
            engine, (fp3_cells){cells.kind, cells.number, cells.first + object, 1}, words + object);
    }
    return status;
}

/* All published words, a register after the other. */
static fp3_status move_published(fp3_engine *engine, uint32_t *words, int is_write) {
    const fp3_members *group = group_of(engine);
    const uint64_t published = fp3_layout_published(group);
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (published & BIT(reg)) {
            status = is_write ? write_living(engine, cells_of(group, reg), words)
                              : fp3_memory_read(engine, cells_of(group, reg), words);
            words += group->rows;
        }
    return status;
}

/* Published words to the lower half: all are read before one is written, so that a board gets those
 * of an object together. */
static fp3_status lower(fp3_engine *engine) {
    fp3_driver *self = engine->self;
    const fp3_members *group = group_of(engine);
    uint32_t count = 0;
    if (!self->is_upper)
        return FP3_OK;
    for (uint64_t left = fp3_layout_published(group); left; left &= left - 1)
        count++;
    uint32_t *words = malloc(((size_t)count * group->rows + 1) * sizeof *words);
    fp3_status status = words ? move_published(engine, words, 0) : fp3_no_memory(engine->def.error);
    self->is_upper = 0;
    if (!status)
        status = move_published(engine, words, 1);
    free(words);
    return status;
}

fp3_status fp3_store_lists_end(fp3_engine *engine, fp3_store_lists *lists) {
    const fp3_members *group = group_of(engine);
    fp3_status status = lists->saved ? lower(engine) : FP3_OK;
    for (uint32_t i = 0; !status && lists->saved && i < group->lists.shape.list_count; i++)
        status = fp3_memory_write(engine, cells_of(group, group->lists.lists[i].reg),
                                  lists->saved + (size_t)i * group->rows);
    free(lists->saved);
    free(lists->words);
    free(lists->place);
    *lists = (fp3_store_lists){0};
    return status;
}
