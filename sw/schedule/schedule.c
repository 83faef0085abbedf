/* schedule.c - a step to lines: the step part first, then what runs before and after it. */
#include "code.h"
#include "machine/cycles.h"
#include "schedule_modulo.h"
#include "schedule_order.h"
#include "schedule_search.h"
#include "schedule_time.h"

#include <isa.h>
#include <machine/operation.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_step *step;
    const fp3_config *config;
    fp3_block block; /* the step part */
    fp3_choice best;
    fp3_schedule *made;
} maker;

static fp3_status no_memory(fp3_error *error) {
    return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

/* ---- first and last part ---- */

/* Whether the step that comes reads what was executed ahead of it. */
static int is_carried(const fp3_block *block, uint32_t value) {
    for (uint32_t i = 0; i < block->count; i++)
        for (uint32_t k = 0; k < 3 && !block->nodes[i].is_ahead; k++) {
            const fp3_ref ref = fp3_node_operand(&block->nodes[i], k);
            if (ref.at == FP3_AT_OP && ref.index == value)
                return 1;
        }
    return 0;
}

/* What the step executes for the next one, the first part executes for the first step: with the
 * variables as it makes them, into the same registers. at[i]: the node in first of node i of the
 * step. */
static fp3_status add_ahead(const maker *m, fp3_block *first, uint32_t *at, fp3_error *error) {
    for (uint32_t p = 0; p < m->block.count; p++) {
        const uint32_t i = m->best.order[p];
        fp3_node node = m->block.nodes[i];
        if (!node.is_ahead)
            continue;
        fp3_ref *refs[3] = {&node.op.a, &node.op.b, &node.op.c};
        for (int k = 0; k < 3; k++) {
            fp3_ref *ref = refs[k];
            if (ref->at == FP3_AT_OP)
                ref->index = at[ref->index];
            else if (ref->at == FP3_AT_VARIABLE && first->writer[ref->index] != FP3_NONE_INDEX)
                *ref = (fp3_ref){FP3_AT_OP, first->writer[ref->index]};
        }
        node.fixed = is_carried(&m->block, i) ? m->best.places.reg[i] : FP3_NONE_INDEX;
        node.writes = FP3_NONE_INDEX;
        at[i] = fp3_block_add(first, &node);
        if (at[i] == FP3_NONE_INDEX)
            return no_memory(error);
    }
    return FP3_OK;
}

/* A part that runs once: soon if it fits, small if not. */
static fp3_status finish_block(maker *m, const fp3_block *block, fp3_line **lines, uint32_t *count,
                               fp3_error *error) {
    static const fp3_next ways[] = {FP3_NEXT_SOON, FP3_NEXT_DEEP, FP3_NEXT_FEWEST, FP3_NEXT_LONG};
    uint32_t *order = malloc((block->count + 1) * sizeof *order);
    fp3_graph graph = {0};
    fp3_places places = {0};
    fp3_status status = order ? FP3_OK : no_memory(error);
    uint32_t fewest = UINT32_MAX;
    if (!status)
        status = fp3_graph_make(block, NULL, 0, 0, &graph, error);
    for (size_t i = 0; !status && i < sizeof ways / sizeof *ways && fewest > m->config->registers;
         i++) {
        fp3_places_free(&places);
        status = fp3_order_list(block, &graph, ways[i], 0, order, error);
        if (!status)
            status = fp3_allocate_within(block, order, &places, error);
        if (!status && places.registers < fewest)
            fewest = places.registers;
    }
    if (!status && fewest > m->config->registers)
        status = fp3_allocate_refuse(m->config, fewest, error);
    if (!status)
        status = fp3_places_lines(block, order, &places, lines, error);
    if (!status) {
        *count = block->count;
        if (places.registers > m->made->registers)
            m->made->registers = places.registers;
        m->made->needs_minus_zero |= block->reads_minus_zero;
    }
    free(order);
    fp3_graph_free(&graph);
    fp3_places_free(&places);
    return status;
}

static fp3_status make_first(maker *m, fp3_error *error) {
    fp3_block first;
    uint32_t *at = calloc(m->block.count + 1, sizeof *at);
    fp3_status status = at ? fp3_block_first(m->step, m->config, &first, error) : no_memory(error);
    if (at && !status)
        status = add_ahead(m, &first, at, error);
    if (at && !status)
        status = finish_block(m, &first, &m->made->first, &m->made->first_count, error);
    if (at)
        fp3_block_free(&first);
    free(at);
    return status;
}

static fp3_status make_last(maker *m, fp3_error *error) {
    fp3_block last;
    fp3_status status = fp3_block_last(m->step, m->config, &last, error);
    if (!status)
        status = finish_block(m, &last, &m->made->last, &m->made->last_count, error);
    fp3_block_free(&last);
    return status;
}

/* Copies of old values by which steps can overlap more; *split has them, or is empty: none does. */
static fp3_status split_block(const fp3_block *block, fp3_block *split, fp3_error *error) {
    uint32_t least = 0, now = 0;
    int is_split = 0, is_changed;
    fp3_status status = fp3_block_clone(block, split, error);
    if (!status)
        status = fp3_modulo_least(block, &least, error);
    for (uint32_t x = 0; !status && x < block->step->variable_count && least > split->count; x++) {
        fp3_block tried = {0};
        status = fp3_block_clone(split, &tried, error);
        if (!status)
            status = fp3_block_split(&tried, x, &is_changed, error);
        if (!status && is_changed)
            status = fp3_modulo_least(&tried, &now, error);
        if (!status && is_changed && now && now < least) {
            fp3_block_free(split);
            *split = tried;
            least = now;
            is_split = 1;
        } else {
            fp3_block_free(&tried);
        }
    }
    if (status || !is_split)
        fp3_block_free(split);
    return status;
}

/* The step with such copies, if it takes fewer cycles. */
static fp3_status try_split(maker *m, fp3_error *error) {
    fp3_block split;
    fp3_choice choice = {0};
    fp3_status status = split_block(&m->block, &split, error);
    if (status || !split.count)
        return status;
    status = fp3_search(&split, &choice, error);
    if (!status && choice.cycles < m->best.cycles) {
        const fp3_block block = m->block;
        const fp3_choice best = m->best;
        m->block = split;
        m->best = choice;
        split = block;
        choice = best;
    }
    fp3_block_free(&split);
    fp3_choice_free(&choice);
    return status == FP3_E_LIMIT ? FP3_OK : status;
}

static fp3_status make_step(maker *m, fp3_error *error) {
    fp3_schedule *made = m->made;
    fp3_status status = fp3_block_step(m->step, m->config, &m->block, error);
    if (!status)
        status = fp3_search(&m->block, &m->best, error);
    if (!status && !m->config->interleave && m->step->allow_ahead)
        status = try_split(m, error);
    if (!status)
        status = fp3_places_lines(&m->block, m->best.order, &m->best.places, &made->step, error);
    if (status)
        return status;
    made->step_count = m->block.count;
    made->copies = m->block.copies;
    made->registers = m->best.places.registers;
    made->needs_minus_zero = m->block.reads_minus_zero;
    for (uint32_t i = 0; i < m->block.count; i++)
        made->ahead += (uint32_t)m->block.nodes[i].is_ahead;
    return FP3_OK;
}

/* ---- loads and stores of a visit ---- */

#define BIT(reg) (UINT64_C(1) << (reg))

/* As in lib/visit.c: what is read before it is written, if after is read after the end. */
static uint64_t live(const fp3_line *lines, uint32_t count, uint64_t after) {
    while (count-- > 0) {
        const fp3_operation *operation = fp3_operation_find(lines[count].op);
        after &= ~BIT(lines[count].d);
        for (size_t k = 0; operation && k + 1 < strlen(operation->operands); k++)
            if (lines[count].operand[k] < FP3_BANK_SHARED_BASE)
                after |= BIT(lines[count].operand[k]);
    }
    return after;
}

static uint64_t written(const fp3_line *lines, uint32_t count) {
    uint64_t set = 0;
    for (uint32_t i = 0; i < count; i++)
        set |= BIT(lines[i].d);
    return set;
}

static uint32_t size_of(uint64_t set) {
    uint32_t bits = 0;
    for (; set; set &= set - 1)
        bits++;
    return bits;
}

/* States are named as such, what the first part makes is a .temp. A visit has one of each at
 * least. */
static void find_visit(const fp3_step *step, fp3_schedule *s) {
    uint64_t states = 0, stored = written(s->first, s->first_count);
    stored |= written(s->step, s->step_count) | written(s->last, s->last_count);
    for (uint32_t x = 0; x < step->variable_count; x++)
        if (step->variables[x].first.at == FP3_AT_NOWHERE)
            states |= BIT(x);
    stored &= states;
    const uint64_t loaded =
        live(s->first, s->first_count,
             live(s->step, s->step_count, live(s->last, s->last_count, stored)));
    s->loads = loaded ? size_of(loaded) : 1;
    s->stores = stored ? size_of(stored) : 1;
}

/* ---- cycles and bounds ---- */

static double per_sweep(const fp3_config *config) {
    return (double)fp3_cycles_sweep(config, config->contexts) / config->contexts;
}

/* Objects that the whole configuration advances at a time. */
static double parts(const fp3_config *config) {
    return (double)config->tiles * config->schedulers * config->lanes;
}

static fp3_status find_cycles(maker *m, fp3_error *error) {
    const fp3_config *config = m->config;
    fp3_schedule *made = m->made;
    fp3_timed *code;
    fp3_timed_program program;
    if (config->interleave) {
        if (config->schedulers == 1)
            made->cycles = made->step_count * per_sweep(config) / parts(config);
        return FP3_OK;
    }
    if (!fp3_time_schedule(made, config, &code, &program))
        return no_memory(error);
    made->cycles = fp3_cycles_solo_step(config, &program);
    free(code);
    return FP3_OK;
}

/* No order takes fewer: issue slots, and uses of a unit where schedulers share it. */
static double issue_bound(const fp3_step *step, const fp3_config *config) {
    const double count = (double)step->step_count;
    uint32_t adds = 0, muls = 0;
    if (!config->interleave)
        return config->writeback_stall ? 2 * count : count;
    for (uint32_t i = 0; i < step->step_count; i++) {
        adds += (uint32_t)fp3_cycles_adds(step->step[i].op);
        muls += (uint32_t)fp3_cycles_multiplies(step->step[i].op);
    }
    const double issue = count * per_sweep(config) / parts(config);
    const double use = (adds > muls ? adds : muls) / (double)config->tiles;
    return config->schedulers > 1 && use > issue ? use : issue;
}

static fp3_status find_bounds(maker *m, fp3_error *error) {
    fp3_schedule *made = m->made;
    made->bound_issue = issue_bound(m->step, m->config);
    fp3_status status = m->config->interleave
                            ? FP3_OK
                            : fp3_step_path(m->step, m->config, &made->bound_path, error);
    made->bound = made->bound_issue > made->bound_path ? made->bound_issue : made->bound_path;
    return status;
}

/* ---- the interface ---- */

static fp3_status make_all(const fp3_step *step, const fp3_config *config, fp3_schedule **schedule,
                           fp3_error *error) {
    maker m = {.step = step, .config = config, .made = calloc(1, sizeof **schedule)};
    fp3_status status = m.made ? make_step(&m, error) : no_memory(error);
    if (!status)
        status = make_first(&m, error);
    if (!status)
        status = make_last(&m, error);
    if (!status && config->interleave)
        find_visit(step, m.made);
    if (!status)
        status = find_cycles(&m, error);
    if (!status)
        status = find_bounds(&m, error);
    if (m.made) {
        m.made->needs_minus_zero = m.made->needs_minus_zero && step->minus_zero == FP3_NONE_INDEX;
        m.made->constants = step->constant_count + (uint32_t)m.made->needs_minus_zero;
    }
    if (status)
        fp3_schedule_free(&m.made);
    fp3_block_free(&m.block);
    fp3_choice_free(&m.best);
    *schedule = m.made;
    return status;
}

fp3_status fp3_schedule_make(const fp3_step *step, const fp3_config *config,
                             fp3_schedule **schedule, fp3_error *error) {
    fp3_status status = make_all(step, config, schedule, error);
    if (status != FP3_E_LIMIT || !step->allow_ahead || config->interleave)
        return status;
    /* What is executed ahead may be too much for the first part. */
    fp3_step in_turn = *step;
    in_turn.allow_ahead = 0;
    return make_all(&in_turn, config, schedule, error);
}

void fp3_schedule_free(fp3_schedule **schedule) {
    if (!*schedule)
        return;
    free((*schedule)->first);
    free((*schedule)->step);
    free((*schedule)->last);
    free(*schedule);
    *schedule = NULL;
}

uint64_t fp3_schedule_cycles(const fp3_schedule *schedule, const fp3_config *config,
                             uint64_t steps) {
    const fp3_schedule *s = schedule;
    fp3_timed *code;
    fp3_timed_program program;
    if (config->interleave) {
        const uint64_t once = (uint64_t)s->loads + s->first_count + s->last_count + s->stores;
        if (config->schedulers > 1 || !steps)
            return 0;
        return fp3_cycles_interleaved(config, config->contexts, once + s->step_count * steps);
    }
    if (!fp3_time_schedule(s, config, &code, &program))
        return 0;
    const uint64_t cycles = fp3_cycles_solo(config, &program, steps);
    free(code);
    return cycles;
}
