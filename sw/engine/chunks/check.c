/* SPDX-License-Identifier: Apache-2.0 */
/* check.c - see check.h. */
#include "check.h"

#include "engine/board/near_code.h"
#include "gen/registers.h"
#include "machine/operation.h"
#include <inttypes.h>

#define BIT(reg) (UINT64_C(1) << (reg))

static fp3_status refuse(fp3_error *error, const char *why) {
    return fp3_fail(error, FP3_E_PROGRAM, "objects in chunks: %s", why);
}

fp3_status fp3_chunks_no_room(const fp3_config *config, uint32_t object, uint32_t seen,
                              fp3_error *error) {
    return fp3_fail(error, FP3_E_PROGRAM,
                    "objects in chunks: object %" PRIu32 " and the %" PRIu32
                    " that it sees have no room in the %" PRIu32 " words of configuration '%s'",
                    object, seen, config->store_words, config->name);
}

static fp3_status check_hardware(const fp3_config *config, const fp3_config *program,
                                 fp3_error *error) {
    if (!config->master || !config->neighbours || config->lanes > 1 ||
        fp3_config_schedulers(config) > 1)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "configuration '%s': objects that see each other, in chunks, need `master` "
                        "and `neighbours`, one scheduler and one lane",
                        config->name);
    if (!fp3_config_computes_as(config, program))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "configuration '%s' computes otherwise than that of the program",
                        config->name);
    return FP3_OK;
}

/* The hardware finds a list by a register, which each phase loads before it loops. */
static int loads_lists(const fp3_code *program) {
    uint64_t loaded = 0;
    for (uint32_t i = 0; i < program->count; i++) {
        const fp3_decoded *word = &program->decoded[i];
        if (!word->of)
            continue;
        if (word->in.op == FP3_OP_EACH && !(loaded & BIT(word->in.d)))
            return 0;
        if (fp3_ends_phase(word))
            loaded = 0;
        else if (word->in.op == FP3_OP_LD)
            loaded |= BIT(word->in.d);
        else if (word->of->writes != FP3_WRITES_NEVER)
            loaded &= ~BIT(word->in.d);
    }
    return 1;
}

static fp3_status check_phases(const fp3_members *group, const fp3_config *config,
                               fp3_error *error) {
    for (uint32_t p = 0, first, end; p < group->lists.shape.phases; p++)
        if (fp3_neighbourhood_phase(&group->program, p, &first, &end) &&
            end - first > config->program_words)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "objects in chunks: a phase has %" PRIu32
                            " words, configuration '%s' has room for %" PRIu32,
                            end - first, config->name, config->program_words);
    return FP3_OK;
}

static fp3_status check_program(const fp3_members *group, fp3_error *error) {
    if (!group->visit || !group->lists.shape.is_any)
        return refuse(error, "these see no others, and need no lists");
    if (group->visit->loads_in_front || group->visit->stores_behind ||
        !loads_lists(&group->program))
        return refuse(error, "a program with neighbours needs loads and stores of its own, and "
                             "loads the register of a list in the phase of its loop");
    if (group->lists.shape.worst)
        return refuse(error, "a word that is compared over all objects needs the host");
    if (group->rest >= 0 || group->visit->slept >= 0)
        return refuse(error, "an object that rests would still be visited");
    return FP3_OK;
}

static fp3_status check_list(const fp3_members *group, const fp3_config *config,
                             const fp3_list *list, fp3_error *error) {
    if (list->is_all)
        return refuse(error, "all others are more than the store holds");
    if (list->kept)
        return refuse(error, "pairs that remember would change lists in memory");
    if (list->is_near && (!config->keep || !config->chain))
        return refuse(error, "lists of near objects are made by hardware with `keep` and `chain`");
    if (list->is_near && fp3_near_code_list(&group->lists) != list)
        return refuse(error, "hardware makes one list of near objects, all of one kind and of one "
                             "reach, at positions in one word");
    return list->is_near || list->begin ? FP3_OK : refuse(error, "a list has not been given");
}

/* One that would not fit even in a chunk of its own, if it saw in all its lists the same. */
static fp3_status check_object(const fp3_members *group, const fp3_config *config, uint32_t object,
                               fp3_error *error) {
    const fp3_lists *lists = &group->lists;
    uint64_t seen = 0, words = 0;
    for (uint32_t k = 0; k < lists->shape.list_count; k++) {
        if (lists->lists[k].is_near) /* the cut shows it */
            continue;
        const uint32_t length = fp3_list_length(&lists->lists[k], object);
        if (length > FP3_CHUNKS_LENGTH)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "objects in chunks: object %" PRIu32 " has %" PRIu32
                            " neighbours in a list, at most %u are possible",
                            object, length, FP3_CHUNKS_LENGTH);
        seen = length > seen ? length : seen;
        words += fp3_chunks_words(&lists->lists[k], object);
    }
    const uint64_t records = (1 + seen) << FP3_RECORD_LOG2; /* at least */
    if (2 * records > config->store_words || words + 2 * records > config->store_words)
        return fp3_chunks_no_room(config, object, (uint32_t)seen, error);
    return FP3_OK;
}

fp3_status fp3_chunks_check(fp3_engine *engine, const fp3_config *config, fp3_error *error) {
    const fp3_layout *layout = fp3_engine_layout(engine);
    const fp3_members *group = &layout->groups[0];
    fp3_status status = check_hardware(config, fp3_engine_config(engine), error);
    if (!status && (layout->count != 1 || fp3_layout_is_joined(layout)))
        status = refuse(error, "one group, which sees no other one");
    if (!status)
        status = check_program(group, error);
    if (!status && (fp3_engine_has_lives(engine) || group->removed >= 0))
        status = refuse(error, "objects that come and go need new lists");
    if (!status)
        status = check_phases(group, config, error);
    for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++)
        status = check_list(group, config, &group->lists.lists[k], error);
    for (uint32_t i = 0; !status && i < group->objects; i++)
        status = check_object(group, config, i, error);
    return status;
}
