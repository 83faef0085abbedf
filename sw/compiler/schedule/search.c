/* SPDX-License-Identifier: Apache-2.0 */
/* search.c - orders are proposed, timed and get registers; the best one is taken. */
#include "search.h"

#include "interval.h"
#include "longest.h"
#include "loop.h"
#include "machine/operation.h"
#include "order.h"
#include "polish.h"
#include "timing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Orders that are tried: so many nodes are put in order in all, but so many orders in any case. */
#define NODES_LISTED 6000u
#define NODES_MOVED 50000u
#define ORDERS_LEAST 4u
#define MOVES_MOST 1000u
/* Sizes of the part that is executed ahead. */
#define ROTATIONS 16u
/* How many registers fewer a plan is filled within. */
#define SPARE_MOST 4u

typedef struct {
    const fp3_step_code *code;
    const fp3_config *config;
    fp3_block *block;
    fp3_dependences graph;
    fp3_choice *best; /* places.reg is NULL as long as nothing fits */
    uint32_t fewest;  /* registers of the orders proposed */
    int is_tight;     /* an order would be better if it fitted */
} search;

/* ---- choice ---- */

static double best_cycles(const search *m) {
    return m->best->places.reg ? m->best->cycles : INFINITY;
}

static void mark_ahead(const fp3_block *block, const char *is_ahead) {
    for (uint32_t i = 0; i < block->count; i++)
        block->nodes[i].is_ahead = is_ahead && is_ahead[i];
}

/* In order: fewer cycles; fewer registers. What does not fit is none. */
static int is_better(const search *m, const fp3_places *places, double cycles) {
    const fp3_choice *best = m->best;
    if (!best->places.reg || cycles != best->cycles)
        return !best->places.reg || cycles < best->cycles;
    return places->registers < best->places.registers;
}

static void take(search *m, const uint32_t *order, const char *is_ahead, fp3_places *places,
                 double cycles) {
    fp3_places_free(&m->best->places);
    m->best->places = *places;
    m->best->cycles = cycles;
    memcpy(m->best->order, order, m->block->count * sizeof *order);
    for (uint32_t i = 0; i < m->block->count; i++)
        m->best->is_ahead[i] = (char)(is_ahead && is_ahead[i]);
    *places = (fp3_places){0};
}

/* Takes an order if it is the best so far. is_ahead may be NULL. */
static fp3_status propose(search *m, const uint32_t *order, const char *is_ahead,
                          fp3_error *error) {
    fp3_places places = {0};
    double cycles = 0;
    uint32_t least = 0;
    mark_ahead(m->block, is_ahead);
    fp3_status status = fp3_time_order(m->block, order, &cycles, error);
    if (status || (m->best->places.reg && cycles > m->best->cycles))
        return status;
    status = fp3_allocate_least(m->block, order, &least, error);
    if (!status && least <= m->config->registers) {
        status = fp3_allocate_within(m->block, order, &places, error);
        least = places.registers;
    }
    if (!status && least < m->fewest)
        m->fewest = least;
    m->is_tight |= least > m->config->registers;
    if (!status && least <= m->config->registers && is_better(m, &places, cycles))
        take(m, order, is_ahead, &places, cycles);
    fp3_places_free(&places);
    return status;
}

/* So many orders of this block are affordable. */
static uint32_t orders_for(const search *m, uint32_t nodes) {
    const uint32_t orders = nodes / (m->block->count + 1);
    return orders > ORDERS_LEAST ? orders : ORDERS_LEAST;
}

static fp3_status propose_lists(search *m, uint32_t *order, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int next = 0; !status && next < FP3_NEXT_COUNT; next++) {
        if (next == FP3_NEXT_TURN && !m->config->dual)
            continue;
        status = fp3_order_list(m->block, &m->graph, (fp3_next)next, order, error);
        if (!status)
            status = propose(m, order, NULL, error);
    }
    return status;
}

static int is_done(const search *m, uint32_t interval) {
    return m->best->places.reg && m->best->cycles <= interval;
}

/* Nodes at the beginning of an order that may as well be executed ahead. Returns their number. */
static uint32_t rotate(const search *m, const uint32_t *order, uint32_t most, char *is_ahead) {
    uint32_t moved = 0;
    for (uint32_t p = 0; p < m->block->count && moved < most; p++) {
        const fp3_node *node = &m->block->nodes[order[p]];
        int may = !is_ahead[order[p]] && node->writes == FP3_NONE_INDEX;
        for (uint32_t k = 0; k < 3 && may; k++) {
            const fp3_ref ref = fp3_node_operand(node, k);
            may = ref.at != FP3_AT_OP || is_ahead[ref.index];
        }
        is_ahead[order[p]] |= (char)may;
        moved += (uint32_t)may;
    }
    return moved;
}

/* Temporary values that the registers have room for, and a few to spare. */
static uint32_t room_for_temps(const search *m, uint32_t spare) {
    const uint32_t taken = m->code->variable_count + m->code->param_count + spare;
    return m->config->registers > taken ? m->config->registers - taken : 0;
}

/* Lists for a set of nodes that are executed ahead. The last one is left in order. */
static fp3_status propose_filled(search *m, const fp3_interval *found, uint32_t interval,
                                 const char *is_ahead, uint32_t *left, uint32_t *order,
                                 fp3_error *error) {
    static const struct {
        int32_t loss, guard;
        uint32_t spare;
    } ways[] = {
        {6, FP3_NO_GUARD, 1}, {2, 1, 2}, {0, FP3_NO_GUARD, 4}, {1000, FP3_NO_GUARD, 2}, {0, 8, 0}};
    const uint32_t room = room_for_temps(m, 0);
    fp3_loop loop = {
        .graph = fp3_interval_dependences(found), .is_ahead = is_ahead, .interval = interval};
    fp3_status status = FP3_OK;
    loop.urgency = fp3_interval_heights(found, interval);
    for (size_t i = 0; !status && *left && i < sizeof ways / sizeof *ways; i++, --*left) {
        loop.loss = ways[i].loss;
        loop.guard = ways[i].guard;
        loop.limit =
            m->best->places.reg ? room_for_temps(m, ways[i].spare) : room - room * (uint32_t)i / 5;
        status = fp3_loop_order(m->block, &loop, order, error);
        if (!status)
            status = propose(m, order, is_ahead, error);
    }
    return status;
}

static fp3_status propose_rotated(search *m, const fp3_interval *found, uint32_t interval,
                                  uint32_t *order, char *is_ahead, fp3_error *error) {
    uint32_t left = orders_for(m, NODES_LISTED);
    const uint32_t rotations = left / 5 < ROTATIONS ? left / 5 + 1 : ROTATIONS;
    memset(is_ahead, 0, m->block->count);
    fp3_status status = FP3_OK;
    while (!status && left && !is_done(m, interval)) {
        status = propose_filled(m, found, interval, is_ahead, &left, order, error);
        if (!status && (!m->code->allow_ahead ||
                        !rotate(m, order, 1 + m->block->count / (2 * rotations), is_ahead)))
            break;
    }
    return status;
}

static fp3_status propose_polished(search *m, const fp3_interval *found, uint32_t interval,
                                   uint32_t *order, char *is_ahead, fp3_error *error) {
    const uint32_t moves = orders_for(m, NODES_MOVED);
    if (!m->best->places.reg || is_done(m, interval))
        return FP3_OK;
    memcpy(order, m->best->order, m->block->count * sizeof *order);
    memcpy(is_ahead, m->best->is_ahead, m->block->count);
    mark_ahead(m->block, is_ahead);
    const fp3_status status = fp3_polish(m->block, fp3_interval_dependences(found), interval,
                                         moves < MOVES_MOST ? moves : MOVES_MOST, order, error);
    return status ? status : propose(m, order, is_ahead, error);
}

/* A plan within the registers, and the list schedule that follows the plan. If the number of values
 * fits but they find no registers, tries again with fewer values. */
static fp3_status propose_plan(search *m, fp3_loop *loop, const uint32_t *plan, uint32_t *order,
                               fp3_error *error) {
    uint32_t least = 0;
    mark_ahead(m->block, loop->is_ahead);
    fp3_status status = fp3_allocate_least(m->block, plan, &least, error);
    loop->plan = plan;
    for (uint32_t spare = 0; !status && spare < SPARE_MOST; spare++) {
        const double before = best_cycles(m);
        loop->limit = m->config->registers - spare;
        if (least > loop->limit)
            break;
        status = fp3_loop_order(m->block, loop, order, error);
        if (!status)
            status = propose(m, order, loop->is_ahead, error);
        if (best_cycles(m) < before)
            break;
    }
    return status;
}

/* Where registers run short: plans with few values, made faster while they fit. */
static fp3_status propose_planned(search *m, const fp3_interval *found, uint32_t interval,
                                  uint32_t *order, char *is_ahead, fp3_error *error) {
    static const fp3_next plans[] = {FP3_NEXT_FEWEST, FP3_NEXT_DEEP, FP3_NEXT_LONG};
    const double before = best_cycles(m);
    uint32_t *plan = malloc((m->block->count + 1) * sizeof *plan);
    fp3_loop loop = {.graph = fp3_interval_dependences(found),
                     .is_ahead = is_ahead,
                     .urgency = fp3_interval_heights(found, interval),
                     .interval = interval};
    fp3_status status = plan ? FP3_OK : fp3_no_memory(error);
    memset(is_ahead, 0, m->block->count);
    for (size_t i = 0; !status && i < sizeof plans / sizeof *plans; i++) {
        status = fp3_order_list(m->block, &m->graph, plans[i], plan, error);
        if (!status)
            status = propose_plan(m, &loop, plan, order, error);
    }
    free(plan);
    if (!status && best_cycles(m) < before)
        status = propose_polished(m, found, interval, order, is_ahead, error);
    return status;
}

/* The solo machine: orders that know how long everything takes. */
static fp3_status propose_loops(search *m, uint32_t *order, fp3_error *error) {
    const uint32_t count = m->block->count;
    const uint32_t least = m->config->writeback_stall ? 2 * count : count;
    double path = 0;
    uint32_t interval = 0;
    fp3_interval *found = NULL;
    char *is_ahead = malloc(count + 1);
    fp3_status status = is_ahead ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_longest_path(m->code, m->config, &path, error);
    if (!status)
        status = fp3_interval_make(m->block, &found, error);
    if (!status) {
        const uint32_t begin = path > least ? (uint32_t)ceil(path - 1e-6) : least;
        interval = fp3_interval_least_from(found, begin, 64 * (begin + 64));
    }
    if (interval)
        status = propose_rotated(m, found, interval, order, is_ahead, error);
    if (interval && !status)
        status = propose_polished(m, found, interval, order, is_ahead, error);
    if (interval && !status && m->is_tight)
        status = propose_planned(m, found, interval, order, is_ahead, error);
    fp3_interval_free(&found);
    free(is_ahead);
    return status;
}

/* Sums and products at once: the best order so far, with moves by which fewer wait for their unit.
 */
static fp3_status propose_turns(search *m, uint32_t *order, fp3_error *error) {
    const uint32_t moves = orders_for(m, NODES_MOVED);
    uint32_t units[2] = {0};
    for (uint32_t i = 0; i < m->block->count; i++)
        units[fp3_operation_multiplies(fp3_operation_find(m->block->nodes[i].op.op))]++;
    const double least = units[0] > units[1] ? units[0] : units[1];
    memcpy(order, m->best->order, m->block->count * sizeof *order);
    const fp3_status status = fp3_polish(m->block, &m->graph, least,
                                         moves < MOVES_MOST ? moves : MOVES_MOST, order, error);
    return status ? status : propose(m, order, NULL, error);
}

static fp3_status propose_all(search *m, fp3_error *error) {
    uint32_t *order = malloc((m->block->count + 1) * sizeof *order);
    fp3_status status = order ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = propose_lists(m, order, error);
    if (!status && !m->config->interleave && m->block->count)
        status = propose_loops(m, order, error);
    if (!status && m->config->dual && m->best->places.reg)
        status = propose_turns(m, order, error);
    free(order);
    return status;
}

fp3_status fp3_search(fp3_block *block, fp3_choice *choice, fp3_error *error) {
    search m = {.code = block->code, .config = block->config, .block = block, .best = choice};
    m.fewest = UINT32_MAX;
    *choice = (fp3_choice){.order = malloc((block->count + 1) * sizeof *choice->order),
                           .is_ahead = calloc(block->count + 1, 1)};
    fp3_status status = choice->order && choice->is_ahead ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_dependences_make(block, NULL, 0, 0, &m.graph, error);
    if (!status)
        status = propose_all(&m, error);
    if (!status && !choice->places.reg)
        status = fp3_allocate_refuse(block, m.fewest, error);
    fp3_dependences_free(&m.graph);
    if (status)
        fp3_choice_free(choice);
    else
        mark_ahead(block, choice->is_ahead);
    return status;
}

void fp3_choice_free(fp3_choice *choice) {
    free(choice->order);
    free(choice->is_ahead);
    fp3_places_free(&choice->places);
    *choice = (fp3_choice){0};
}
