/* SPDX-License-Identifier: Apache-2.0 */
/* near.c - see near.h. */
#include "near.h"

#include "check.h"

#include "machine/operation.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>

/* Which constant: see near_code.h. An object may move half the skin before its list is made again.
 */
enum { REACH, MOVED, ROAM, ROOM, NOWHERE, CONSTANTS };

static fp3_status read_places(fp3_chunks_maker *m) {
    fp3_chunks_near *near = &m->near;
    const uint32_t objects = m->group->objects;
    fp3_status status = FP3_OK;
    near->places = (fp3_positions){.dimensions = near->rule.dimensions, .rule = &near->rule};
    for (uint32_t k = 0; !status && k < near->rule.dimensions; k++) {
        near->places.word[k] = malloc(objects * sizeof *near->places.word[k]);
        status = near->places.word[k]
                     ? fp3_engine_read_words(m->engine, 0, objects, near->rule.regs[k],
                                             near->places.word[k])
                     : fp3_no_memory(m->error);
    }
    return status;
}

/* Room for the longest list of now, and half as many entries again, as objects come nearer. If that
 * is too little, the hardware ends the run. */
static fp3_status find_room(fp3_chunks_maker *m) {
    const uint32_t objects = m->group->objects;
    uint32_t *begin = NULL, *other = NULL, longest = 0;
    fp3_status status =
        fp3_positions_pairs(&m->near.places, &m->near.rule, objects, &begin, &other, m->error);
    m->near.lengths = malloc(objects * sizeof *m->near.lengths);
    if (!status && !m->near.lengths)
        status = fp3_no_memory(m->error);
    for (uint32_t i = 0; !status && i < objects; i++) {
        m->near.lengths[i] = begin[i + 1] - begin[i];
        longest = m->near.lengths[i] > longest ? m->near.lengths[i] : longest;
    }
    m->near.room = longest + longest / 2 + 2;
    if (m->near.room >= FP3_CHUNKS_LENGTH)
        m->near.room = FP3_CHUNKS_LENGTH - 1;
    free(begin);
    free(other);
    return status;
}

fp3_status fp3_chunks_near_open(fp3_chunks_maker *m, double roam) {
    fp3_chunks_near *near = &m->near;
    m->lists = m->group->lists;
    near->list = fp3_near_code_list(&m->group->lists);
    near->roam = roam;
    if (!near->list)
        return FP3_OK;
    near->rule = fp3_near_without_list(&near->list->near);
    if (!(roam > 0 && isfinite(roam)))
        return fp3_fail(m->error, FP3_E_ARGUMENT,
                        "objects in chunks: near objects need a distance above 0 that they may go");
    fp3_near_rule wide = near->rule;
    wide.skin += 2 * roam;
    fp3_status status = read_places(m);
    if (!status)
        status = find_room(m);
    if (!status)
        status = fp3_positions_pairs(&near->places, &wide, m->group->objects, &near->begin,
                                     &near->other, m->error);
    fp3_list *list = &m->lists.lists[near->list - m->group->lists.lists];
    list->begin = near->begin;
    list->other = near->other;
    return status;
}

void fp3_chunks_near_close(fp3_chunks_maker *m) {
    fp3_positions_close(&m->near.places);
    free(m->near.begin);
    free(m->near.other);
    free(m->near.lengths);
}

/* ---- words of a record ---- */

/* The first of so many numbers that follow each other, of which none is used; 0: there are not. */
static int find_free(uint64_t used, uint32_t count, uint32_t words, uint32_t *first) {
    const uint64_t bits = (UINT64_C(1) << count) - 1;
    for (*first = 0; *first + count <= words; (*first)++)
        if (!(used & bits << *first))
            return 1;
    return 0;
}

static int name(fp3_chunks_maker *m) {
    fp3_near_names *names = &m->near.names;
    const uint32_t words = 1u << m->chunks->log2;
    uint64_t used = UINT64_C(1) << names->list;
    uint32_t first = 0;
    for (uint32_t k = 0; k < names->dimensions; k++)
        used |= UINT64_C(1) << names->at[k];
    if (!find_free(used, names->dimensions, words, &first))
        return 0;
    for (uint32_t k = 0; k < names->dimensions; k++) {
        names->made[k] = first + k;
        used |= UINT64_C(1) << names->made[k];
    }
    return find_free(used, 1, words, &names->source);
}

void fp3_chunks_near_name(fp3_chunks_maker *m) {
    fp3_chunks_near *near = &m->near;
    if (!near->list)
        return;
    near->names = (fp3_near_names){.dimensions = near->rule.dimensions,
                                   .list = m->chunks->numbers.now[near->list->reg]};
    for (uint32_t k = 0; k < near->rule.dimensions; k++)
        near->names.at[k] = m->chunks->numbers.now[near->rule.regs[k]];
    while (!name(m))
        m->chunks->log2++;
    near->constant = m->group->image->shared;
    near->names.moved = FP3_BANK_SHARED_BASE + near->constant + MOVED;
    near->names.reach = FP3_BANK_SHARED_BASE + near->constant + REACH;
    near->names.room = FP3_BANK_SHARED_BASE + near->constant + ROOM;
    near->names.nowhere = FP3_BANK_SHARED_BASE + near->constant + NOWHERE;
}

/* ---- in memory ---- */

fp3_status fp3_chunks_near_set(fp3_chunks_maker *m, uint32_t *constants) {
    const fp3_chunks_near *near = &m->near;
    if (!near->list)
        return FP3_OK;
    if (near->constant + CONSTANTS > m->config->registers)
        return fp3_fail(m->error, FP3_E_PROGRAM,
                        "objects in chunks: lists of near objects need %d shared constants besides "
                        "the %" PRIu32 " of the program, configuration '%s' has %" PRIu32,
                        CONSTANTS, near->constant, m->config->name, m->config->registers);
    constants[near->constant + REACH] = fp3_near_reached(&near->rule);
    constants[near->constant + MOVED] = fp3_near_moved(near->rule.skin / 2);
    constants[near->constant + ROAM] = fp3_near_moved(near->roam);
    constants[near->constant + ROOM] = near->room;
    constants[near->constant + NOWHERE] = FP3_NEAR_NOWHERE;
    return FP3_OK;
}

static void put_program(fp3_chunks_maker *m, const fp3_near_code *code,
                        fp3_chunks_program *program) {
    fp3_chunks_put_program(m, code->word, code->count, 0, program);
}

static uint32_t put_places(fp3_chunks_maker *m) {
    const fp3_positions *places = &m->near.places;
    const fp3_pieces *cut = &m->chunks->cut;
    const uint32_t at = fp3_chunks_put(m, NULL, cut->objects * places->dimensions);
    for (uint32_t i = 0; i < cut->objects && !m->is_full; i++)
        for (uint32_t k = 0; k < places->dimensions; k++)
            m->chunks->memory[at + i * places->dimensions + k] =
                fp3_near_made(places->word[k][cut->object[i]]);
    return at;
}

void fp3_chunks_near_put(fp3_chunks_maker *m) {
    fp3_chunks_near *near = &m->near;
    fp3_near_names roamed = near->names;
    fp3_near_code code;
    if (!near->list)
        return;
    fp3_near_check(&near->names, m->config->registers, &code);
    put_program(m, &code, &near->check);
    roamed.moved = FP3_BANK_SHARED_BASE + near->constant + ROAM;
    fp3_near_check(&roamed, m->config->registers, &code);
    put_program(m, &code, &near->roamed);
    fp3_near_renew(&near->names, m->config->registers, &code);
    put_program(m, &code, &near->renew);
    near->made = put_places(m);
    near->stood = put_places(m);
    near->wide = fp3_chunks_put(m, NULL, m->chunks->cut.objects);
    const uint32_t rows = fp3_chunks_room(m) >> m->chunks->log2;
    const uint32_t counts[] = {rows, m->chunks->cut.objects % rows};
    near->rows = fp3_chunks_put(m, counts, 2);
    near->rest = near->rows + 1;
}
