/* SPDX-License-Identifier: Apache-2.0 */
/* chunks.c - see chunks.h.
 *
 * Memory has words that do not change, places of words that do, and at its end the list. */
#include "chunks.h"

#include "check.h"
#include "lists.h"
#include "near.h"
#include "transfers.h"

#include "machine/config.h"
#include "machine/operation.h"

#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define MOST_STEPS (1u << 24) /* that a descriptor can count */

static uint32_t put_word(fp3_chunks_maker *m, uint32_t word) { return fp3_chunks_put(m, &word, 1); }

/* ---- registers that are moved alike ---- */

static void find_runs(fp3_chunks_maker *m) {
    const fp3_members *group = m->group;
    const uint64_t stored = group->visit->stored, seen = group->lists.shape.published;
    fp3_chunks *chunks = m->chunks;
    fp3_chunks_run *last = NULL;
    for (uint32_t number = 0; number < chunks->numbers.moved; number++) {
        const uint64_t reg = BIT(chunks->numbers.before[number]);
        const int is_stored = (stored & reg) != 0, is_seen = (seen & reg) != 0;
        const int is_list = m->near.list && reg == BIT(m->near.list->reg); /* it is moved alone */
        if (!last || last->is_stored != is_stored || last->is_seen != is_seen || is_list) {
            last = &chunks->runs[chunks->run_count++];
            *last = (fp3_chunks_run){.reg = number, .is_stored = is_stored, .is_seen = is_seen};
            last->is_published = is_stored && is_seen;
        }
        last->count++;
    }
}

static fp3_status put_run(fp3_chunks_maker *m, fp3_chunks_run *run, uint32_t *words) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t objects = chunks->cut.objects;
    fp3_status status = FP3_OK;
    for (int place = 0; place < 1 + run->is_published; place++)
        run->at[place] = fp3_chunks_put(m, NULL, objects * run->count);
    for (uint32_t k = 0; !status && !m->is_full && k < run->count; k++) {
        status = fp3_engine_read_words(m->engine, 0, objects, chunks->numbers.before[run->reg + k],
                                       words);
        for (uint32_t i = 0; !status && i < objects; i++)
            chunks->memory[run->at[0] + chunks->cut.place[i] * run->count + k] = words[i];
    }
    return status;
}

/* ---- all of it ---- */

/* Whether these words go through a list. */
static int goes_through(const fp3_code *program, uint32_t first, uint32_t end, uint32_t reg) {
    for (uint32_t i = first; i < end; i++)
        if (program->decoded[i].in.op == FP3_OP_EACH && program->decoded[i].in.d == reg)
            return 1;
    return 0;
}

static fp3_status put_phases(fp3_chunks_maker *m) {
    const fp3_code *program = &m->group->program;
    const uint32_t count = m->chunks->numbers.published;
    const uint64_t published = count < 64 ? BIT(count) - 1 : UINT64_MAX;
    uint32_t *words = malloc(program->count * sizeof *words);
    m->phase_count = m->group->lists.shape.phases;
    m->phases = calloc(m->phase_count + 1, sizeof *m->phases);
    if (!words || !m->phases) {
        free(words);
        return fp3_no_memory(m->error);
    }
    for (uint32_t p = 0, first, end; p < m->phase_count; p++) {
        fp3_neighbourhood_phase(program, p, &first, &end);
        for (uint32_t i = first; i < end; i++)
            words[i - first] = fp3_chunks_renamed(&m->chunks->numbers, &program->decoded[i]);
        fp3_chunks_put_program(m, words, end - first, published, &m->phases[p]);
        m->phases[p].is_near = m->near.list && goes_through(program, first, end, m->near.list->reg);
    }
    free(words);
    return FP3_OK;
}

static fp3_status put_settings(fp3_chunks_maker *m) {
    const uint32_t settings[] = {m->chunks->log2, 1, 1, 0};
    uint32_t constants[FP3_BANK_SHARED_COUNT] = {0};
    fp3_status status =
        fp3_engine_read_shared_words(m->engine, 0, 0, m->config->registers, constants);
    if (!status)
        status = fp3_chunks_near_set(m, constants);
    m->constants = fp3_chunks_put(m, constants, m->config->registers);
    m->settings = fp3_chunks_put(m, settings, sizeof settings / sizeof *settings);
    const uint32_t part = m->parts > 1 ? 1u << FP3_CONTROL_PART_LO : 0;
    for (uint32_t i = 0; i < m->parts; i++)
        m->start[i] = put_word(m, 1u << FP3_CONTROL_START_LO | part | i << FP3_CONTROL_UPPER_LO);
    m->half = put_word(m, 0);
    m->enable = put_word(m, 1u << FP3_INTERRUPT_ENABLE_LO);
    return status ? status : put_phases(m);
}

static fp3_status fill(fp3_chunks_maker *m, uint32_t steps) {
    fp3_chunks *chunks = m->chunks;
    uint32_t *words = malloc(m->group->objects * sizeof *words);
    m->data = calloc(chunks->cut.count, sizeof *m->data);
    fp3_status status = words && m->data ? put_settings(m) : fp3_no_memory(m->error);
    find_runs(m);
    for (uint32_t i = 0; !status && i < chunks->run_count; i++)
        status = put_run(m, &chunks->runs[i], words);
    if (!status)
        fp3_chunks_near_put(m);
    for (uint32_t i = 0; !status && i < chunks->cut.count; i++)
        fp3_chunks_put_lists(m, &chunks->cut.pieces[i], &m->data[i]);
    if (!status)
        fp3_chunks_put_transfers(m, steps);
    if (!status && m->is_full)
        status = fp3_fail(m->error, FP3_E_ARGUMENT,
                          "objects in chunks: out of memory, or they would go beyond 4 GB");
    free(words);
    return status;
}

/* Numbers of registers, and a record that has room for those that are moved. */
static void number(fp3_chunks_maker *m) {
    fp3_chunks *chunks = m->chunks;
    fp3_chunks_number(m->group, m->near.list ? BIT(m->near.list->reg) : 0, &chunks->numbers);
    chunks->log2 = FP3_RECORD_LOG2;
    while (1u << chunks->log2 < chunks->numbers.moved)
        chunks->log2++;
    fp3_chunks_near_name(m);
}

fp3_status fp3_chunks_make(fp3_engine *engine, const fp3_config *config, const fp3_chunks_how *how,
                           fp3_chunks **chunks, fp3_error *error) {
    const fp3_layout *layout = fp3_engine_layout(engine);
    fp3_chunks_maker m = {
        .engine = engine, .group = &layout->groups[0], .config = config, .error = error};
    if (!(*chunks = m.chunks = calloc(1, sizeof **chunks)))
        return fp3_no_memory(error);
    m.chunks->at = how->at;
    fp3_status status = fp3_chunks_check(engine, config, error);
    if (!status && (!how->steps || how->steps > MOST_STEPS || how->at % 4))
        status = fp3_fail(
            error, FP3_E_ARGUMENT,
            "objects in chunks: 1 to %u steps, and an address that is a multiple of 4", MOST_STEPS);
    if (!status)
        status = fp3_chunks_near_open(&m, how->roam);
    if (!status) {
        number(&m);
        status = fp3_chunks_cut(&m);
    }
    if (!status)
        status = fill(&m, how->steps);
    fp3_chunks_near_close(&m);
    free(m.data);
    free(m.phases);
    if (status)
        fp3_chunks_free(chunks);
    return status;
}

void fp3_chunks_free(fp3_chunks **chunks) {
    if (!*chunks)
        return;
    fp3_pieces_free(&(*chunks)->cut);
    free((*chunks)->memory);
    free(*chunks);
    *chunks = NULL;
}

int fp3_chunks_read(const fp3_chunks *chunks, const uint32_t *memory, uint32_t reg,
                    uint32_t *words) {
    const uint32_t number = chunks->numbers.now[reg];
    const fp3_chunks_run *run = fp3_chunks_run_of(chunks, number);
    if (!run)
        return 0;
    const uint32_t at = run->at[run->is_published && chunks->is_second];
    for (uint32_t i = 0; i < chunks->cut.objects; i++)
        words[i] = memory[at + chunks->cut.place[i] * run->count + number - run->reg];
    return 1;
}
