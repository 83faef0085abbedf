/* SPDX-License-Identifier: Apache-2.0 */
/* kept.c - see kept.h. */
#include "kept.h"

#include "memory.h"
#include "near_code.h"
#include "shared_list.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define NO_ROOM ((1u << (FP3_OBJECTS_LENGTH_HI - FP3_OBJECTS_LENGTH_LO + 1)) - 1)
#define REGISTERS_LEAST 32 /* `hold` counts words below it */

/* Which constant: the square of how far a list reaches, below 0; of how far an object may move; how
 * many entries a list has room for; FP3_NEAR_NOWHERE. */
enum { REACH, MOVED, ROOM, NOWHERE };

_Static_assert(NOWHERE + 1 == FP3_KEPT_CONSTANTS, "each has its place");

static fp3_members *group_of(const fp3_engine *engine) { return &engine->layout.groups[0]; }

static fp3_cells column(const fp3_members *group, uint32_t reg) {
    return (fp3_cells){FP3_CELLS_REGISTER, reg, group->first, group->rows};
}

/* ---- whether the hardware can ---- */

static int is_alone(const fp3_engine *engine) {
    const fp3_members *group = group_of(engine);
    const fp3_lists *lists = &group->lists;
    return engine->config->keep && engine->config->chain && engine->config->lanes == 1 &&
           engine->config->registers >= REGISTERS_LEAST && !engine->only && !engine->exchange.end &&
           !fp3_lives_vary(engine) && !lists->living && !lists->order && !lists->shape.worst &&
           !fp3_lists_remember(lists) && !group->slot && !group->away &&
           group->objects == group->rows;
}

/* Words of a record that nothing else has. 0: there are too few. */
static int take_words(const fp3_members *group, fp3_own_list *kept) {
    const uint32_t dimensions = kept->list->near.dimensions;
    uint32_t taken = 0;
    for (uint32_t reg = 0; reg < 1u << kept->log2 && taken <= dimensions; reg++)
        if (!(group->visit->kept >> reg & 1)) {
            *(taken < dimensions ? &kept->made[taken] : &kept->all) = reg;
            taken++;
        }
    return taken > dimensions;
}

static uint32_t take(fp3_own_list *kept, uint32_t words) {
    for (int i = 0; i < 2; i++)
        if (kept->end[i] - kept->next[i] >= words) {
            const uint32_t place = kept->next[i];
            kept->next[i] += words;
            return place;
        }
    return UINT32_MAX;
}

/* What the list of all and other lists leave, as fp3_store_lists_follow places these; the same for
 * each object. 0: nothing is left. */
static int take_room(const fp3_engine *engine, fp3_own_list *kept) {
    const fp3_members *group = group_of(engine);
    const uint32_t half = engine->config->store_words / 2, objects = group->rows;
    const uint32_t records = objects << kept->log2;
    if (records > half)
        return 0;
    kept->next[0] = records;
    kept->next[1] = half + records;
    kept->end[0] = half;
    kept->end[1] = 2 * half;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
        const fp3_list *list = &group->lists.lists[k];
        const uint32_t lists = fp3_list_is_shared(engine->config, list) ? 1 : objects;
        for (uint32_t i = 0; list != kept->list && i < lists; i++)
            if (take(kept, fp3_list_turns(engine->config, list, i) * (1 + list->fields)) ==
                UINT32_MAX)
                return 0;
    }
    fp3_own_list then = *kept;
    if (objects >= NO_ROOM || take(&then, objects) == UINT32_MAX)
        return 0;
    kept->room = objects > 1 ? objects - 1 : 1;
    while (kept->room &&
           (then.end[0] - then.next[0]) / kept->room + (then.end[1] - then.next[1]) / kept->room <
               objects)
        kept->room--;
    return kept->room > 0;
}

/* ---- the program ---- */

typedef struct {
    uint32_t word[2 * FP3_NEAR_CODE_MAX], count;
} added;

static void put(added *to, const fp3_near_code *code) {
    memcpy(to->word + to->count, code->word, code->count * sizeof *code->word);
    to->count += code->count;
}

/* words: how many of the next phase are left out if nobody raises. */
static void put_hold(added *to, uint32_t words) {
    to->word[to->count++] = fp3_word_encode(&(fp3_instruction){.op = FP3_OP_HOLD, .d = words});
}

static uint32_t constant(const fp3_own_list *kept, uint32_t which) {
    return FP3_BANK_SHARED_BASE + kept->constant + which;
}

static added make_added(const fp3_config *config, const fp3_own_list *kept) {
    const fp3_near_rule *rule = &kept->list->near;
    fp3_near_names names = {.dimensions = rule->dimensions,
                            .list = kept->list->reg,
                            .source = kept->all,
                            .moved = constant(kept, MOVED),
                            .reach = constant(kept, REACH),
                            .room = constant(kept, ROOM),
                            .nowhere = constant(kept, NOWHERE)};
    memcpy(names.at, rule->regs, sizeof names.at);
    memcpy(names.made, kept->made, sizeof names.made);
    fp3_near_code check, renew;
    fp3_near_check(&names, config->registers, &check);
    fp3_near_renew(&names, config->registers, &renew);
    added to = {.count = 0};
    put(&to, &check);
    put_hold(&to, renew.count + 1);
    put(&to, &renew);
    put_hold(&to, 0);
    return to;
}

/* Whether the phase that begins there goes through the list. */
static int goes_through(const fp3_code *program, uint32_t at, uint32_t reg) {
    for (; at < program->count && !fp3_ends_phase(&program->decoded[at]); at++)
        if (program->decoded[at].in.op == FP3_OP_EACH && program->decoded[at].in.d == reg)
            return 1;
    return 0;
}

/* 0: it has more words than there is room for, or a word that is no instruction. */
static int write_program(const fp3_engine *engine, fp3_own_list *kept) {
    const fp3_code *program = &group_of(engine)->program;
    const added more = make_added(engine->config, kept);
    int begins = 1;
    for (uint32_t i = 0; i < program->count; i++) {
        if (!program->decoded[i].of)
            return 0;
        const uint32_t count = begins && goes_through(program, i, kept->list->reg) ? more.count : 0;
        if (kept->count + count + 1 > engine->config->program_words)
            return 0;
        memcpy(kept->code + kept->count, more.word, count * sizeof *more.word);
        kept->count += count;
        kept->code[kept->count++] = program->code[i];
        begins = fp3_ends_phase(&program->decoded[i]);
    }
    return 1;
}

/* ---- a run ---- */

static fp3_status write_constants(fp3_engine *engine, const fp3_own_list *kept) {
    const fp3_near_rule *rule = &kept->list->near;
    const uint32_t words[] = {
        [REACH] = fp3_near_reached(rule),
        [MOVED] = fp3_near_moved(rule->skin / 2),
        [ROOM] = kept->room,
        [NOWHERE] = FP3_NEAR_NOWHERE,
    };
    return fp3_memory_write(
        engine, (fp3_cells){FP3_CELLS_CONSTANT, 0, kept->constant, FP3_KEPT_CONSTANTS}, words);
}

/* Records of so many words, which hold what the luggage has. */
static fp3_status lay_out(fp3_engine *engine, uint32_t log2, fp3_luggage *luggage) {
    group_of(engine)->log2 = log2;
    fp3_status status = fp3_memory_load(engine);
    if (!status)
        status = fp3_memory_list(engine);
    return status ? status : fp3_luggage_unpack(engine, luggage);
}

static void forget(fp3_own_list *kept) {
    free(kept->code);
    fp3_luggage_free(&kept->before);
    *kept = (fp3_own_list){0};
}

/* Records as large as they must be. 0: the hardware cannot make the list. */
static int prepare(const fp3_engine *engine, fp3_own_list *kept) {
    const fp3_members *group = group_of(engine);
    while (1u << kept->log2 < engine->config->registers && !take_words(group, kept))
        kept->log2++;
    return take_words(group, kept) && take_room(engine, kept) &&
           kept->constant + FP3_KEPT_CONSTANTS <= engine->config->registers &&
           write_program(engine, kept);
}

fp3_status fp3_kept_begin(fp3_engine *engine, fp3_own_list *kept) {
    const fp3_members *group = group_of(engine);
    *kept = (fp3_own_list){.constant = group->image->shared, .log2 = group->log2};
    kept->log2_before = group->log2;
    if (!is_alone(engine) || !(kept->list = fp3_near_code_list(&group->lists)))
        return FP3_OK;
    kept->code = malloc(engine->config->program_words * sizeof *kept->code);
    if (!kept->code)
        return fp3_no_memory(engine->def.error);
    if (!prepare(engine, kept)) {
        forget(kept);
        return FP3_OK;
    }
    fp3_status status = fp3_luggage_pack(engine, &kept->before);
    if (status) { /* nothing to put back */
        fp3_luggage_free(&kept->before);
        return status;
    }
    status = lay_out(engine, kept->log2, &kept->before);
    if (!status)
        status = write_constants(engine, kept);
    return status ? status : fp3_memory_load_words(engine, kept->code, kept->count);
}

static fp3_status no_room(fp3_engine *engine, const fp3_own_list *kept, uint32_t object) {
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "engine '%s': object %" PRIu32 " has more than %" PRIu32
                    " neighbours in a list: the store of configuration '%s' has room for so many "
                    "of each object (without `keep`, the host makes lists)",
                    engine->backend->is.name, object, kept->room, engine->config->name);
}

static fp3_status install_object(fp3_engine *engine, const fp3_own_list *kept, uint32_t object,
                                 uint32_t place, uint32_t all) {
    const fp3_members *group = group_of(engine);
    const fp3_list *list = kept->list;
    const uint32_t length = fp3_list_length(list, object), record = object << group->log2;
    fp3_status status = FP3_OK;
    if (length > kept->room)
        return no_room(engine, kept, object);
    for (uint32_t turn = 0; !status && turn < length; turn++)
        status = fp3_memory_put_word(engine, 0, place + turn, fp3_list_entry(list, object, turn));
    for (uint32_t k = 0; !status && k < list->near.dimensions; k++)
        status = fp3_memory_put_word(engine, 0, record + kept->made[k],
                                     fp3_near_made(list->near.made[k][object]));
    if (!status)
        status =
            fp3_memory_put_word(engine, 0, record + kept->all,
                                group->rows << FP3_OBJECTS_LENGTH_LO | all << FP3_OBJECTS_PLACE_LO);
    return status ? status
                  : fp3_memory_put_word(engine, 0, record + list->reg,
                                        length << FP3_OBJECTS_LENGTH_LO |
                                            place << FP3_OBJECTS_PLACE_LO);
}

fp3_status fp3_kept_install(fp3_engine *engine, const fp3_own_list *kept) {
    const uint32_t objects = group_of(engine)->rows;
    fp3_own_list left = *kept;
    const uint32_t all = take(&left, objects);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < objects; i++)
        status = fp3_memory_put_word(engine, 0, all + i, i);
    for (uint32_t i = 0; !status && i < objects; i++)
        status = install_object(engine, kept, i, take(&left, kept->room), all);
    return status;
}

fp3_status fp3_kept_no_room(fp3_engine *engine, const fp3_own_list *kept) {
    const fp3_members *group = group_of(engine);
    uint32_t object = 0, *words = malloc(group->rows * sizeof *words);
    fp3_status status = words ? fp3_memory_read(engine, column(group, kept->list->reg), words)
                              : fp3_no_memory(engine->def.error);
    while (!status && object < group->rows && words[object] >> FP3_OBJECTS_LENGTH_LO != NO_ROOM)
        object++;
    free(words);
    return status ? status : no_room(engine, kept, object);
}

/* What the run has not computed is what it was. */
static void put_back(const fp3_engine *engine, const fp3_own_list *kept, fp3_luggage *luggage) {
    const size_t objects = engine->objects, dimensions = kept->list->near.dimensions;
    for (size_t k = 0; k <= dimensions; k++) {
        const size_t at = (k < dimensions ? kept->made[k] : kept->all) * objects;
        memcpy(luggage->objects + at, kept->before.objects + at, objects * sizeof(uint32_t));
    }
    memcpy(luggage->constants, kept->before.constants,
           engine->config->registers * sizeof(uint32_t));
}

fp3_status fp3_kept_end(fp3_engine *engine, fp3_own_list *kept) {
    fp3_luggage now = {0};
    fp3_status status = FP3_OK;
    if (kept->before.objects) {
        status = fp3_luggage_pack(engine, &now);
        group_of(engine)->log2 = kept->log2_before;
        if (!status) {
            put_back(engine, kept, &now);
            status = lay_out(engine, kept->log2_before, &now);
        }
        fp3_luggage_free(&now);
    }
    forget(kept);
    return status;
}
