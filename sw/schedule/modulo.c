/* modulo.c - see modulo.h. */
#include "modulo.h"

#include <stdlib.h>
#include <string.h>

#define NEVER INT32_MIN

/* Of additions, products, and both. */
#define LATENCIES 3

struct fp3_modulo {
    const fp3_block *block;
    fp3_dependences graph; /* node block->count is the beginning of the step part */
    uint32_t nodes, interval;
    int32_t
        *height;   /* cycles to the end of all that depends on a node, whole intervals taken off */
    int32_t *at;   /* its cycle, or NEVER */
    int32_t *last; /* the latest that it had, or NEVER */
    /* Cycle modulo interval: which node issues, and which one's result is written. Where the
     * machine stalls at each write it is one table. */
    uint32_t *issues, *writes, tables_room;
    uint32_t latencies[LATENCIES], latency_count; /* different ones */
};

/* ---- what else has to hold ---- */

/* A reader issues before its operand is computed again, and all of a step within an interval on
 * either side of the beginning. */
static uint32_t list_extra(const fp3_block *block, fp3_edge *extra) {
    const uint32_t begin = block->count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < block->count; i++) {
        const fp3_node *node = &block->nodes[i];
        for (uint32_t k = 0; k < 3; k++) {
            const fp3_ref ref = fp3_node_operand(node, k);
            if (ref.at == FP3_AT_OP)
                extra[count++] = (fp3_edge){i, ref.index, 1, 1, 1};
        }
        extra[count++] = (fp3_edge){i, begin, 1, 1, 1};
        extra[count++] = (fp3_edge){begin, i, 0, 1, 1};
        if (node->writes != FP3_NONE_INDEX || !block->code->allow_ahead)
            extra[count++] = (fp3_edge){begin, i, 0, 0, 1};
    }
    return count;
}

static void list_latencies(fp3_modulo *m) {
    for (uint32_t i = 0; i < m->block->count; i++) {
        uint32_t k = 0;
        while (k < m->latency_count && m->latencies[k] != m->block->nodes[i].latency)
            k++;
        if (k == m->latency_count && k < LATENCIES)
            m->latencies[m->latency_count++] = m->block->nodes[i].latency;
    }
}

fp3_status fp3_modulo_make(const fp3_block *block, fp3_modulo **modulo, fp3_error *error) {
    fp3_modulo *m = *modulo = calloc(1, sizeof *m);
    fp3_edge *extra = calloc(6 * (size_t)block->count + 1, sizeof *extra);
    fp3_status status = FP3_E_SYSTEM;
    if (m && extra) {
        m->block = block;
        m->nodes = block->count + 1;
        list_latencies(m);
        m->height = calloc(3 * (size_t)m->nodes, sizeof *m->height);
        m->at = m->height + m->nodes;
        m->last = m->at + m->nodes;
        if (m->height)
            status =
                fp3_dependences_make(block, extra, list_extra(block, extra), 1, &m->graph, error);
    }
    free(extra);
    if (!status)
        return FP3_OK;
    fp3_modulo_free(modulo);
    return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
}

void fp3_modulo_free(fp3_modulo **modulo) {
    if (!*modulo)
        return;
    fp3_dependences_free(&(*modulo)->graph);
    free((*modulo)->height);
    free((*modulo)->issues);
    free(*modulo);
    *modulo = NULL;
}

/* ---- urgency ---- */

static int32_t span_of(const fp3_edge *e, uint32_t interval) {
    return (int32_t)e->weight - (int32_t)(e->distance * interval);
}

/* 0: the dependences need a longer interval. */
static int find_heights(const fp3_modulo *m, uint32_t interval) {
    uint32_t rounds = 0;
    memset(m->height, 0, m->nodes * sizeof *m->height);
    for (int is_news = 1; is_news; rounds++) {
        is_news = 0;
        for (uint32_t e = m->graph.edge_count; e-- > 0;) {
            const fp3_edge *edge = &m->graph.edges[e];
            const int32_t height = m->height[edge->to] + span_of(edge, interval);
            if (height > m->height[edge->from]) {
                m->height[edge->from] = height;
                is_news = 1;
            }
        }
        if (rounds > m->nodes)
            return 0;
    }
    return 1;
}

uint32_t fp3_modulo_interval(const fp3_modulo *modulo, uint32_t least, uint32_t most) {
    uint32_t low = least, high = least;
    while (!find_heights(modulo, high)) {
        low = high + 1;
        high += high / 2 + 1;
        if (high > most)
            return 0;
    }
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (find_heights(modulo, middle))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

fp3_status fp3_modulo_least(const fp3_block *block, uint32_t *interval, fp3_error *error) {
    const uint32_t least = block->config->writeback_stall ? 2 * block->count : block->count;
    fp3_modulo *modulo;
    fp3_status status = fp3_modulo_make(block, &modulo, error);
    if (status)
        return status;
    *interval = fp3_modulo_interval(modulo, least + !least, 64 * (least + 64));
    fp3_modulo_free(&modulo);
    return FP3_OK;
}

const fp3_dependences *fp3_modulo_dependences(const fp3_modulo *modulo) { return &modulo->graph; }

const int32_t *fp3_modulo_heights(const fp3_modulo *modulo, uint32_t interval) {
    find_heights(modulo, interval);
    return modulo->height;
}

/* ---- the tables ---- */

static uint32_t modulo_of(int32_t cycle, uint32_t interval) {
    const int32_t rest = cycle % (int32_t)interval;
    return (uint32_t)(rest < 0 ? rest + (int32_t)interval : rest);
}

static uint32_t *issue_cell(const fp3_modulo *m, int32_t cycle) {
    return &m->issues[modulo_of(cycle, m->interval)];
}

static uint32_t *write_cell(const fp3_modulo *m, uint32_t node, int32_t cycle) {
    const int32_t written = cycle + (int32_t)m->block->nodes[node].latency + 1;
    return &m->writes[modulo_of(written, m->interval)];
}

static int is_free(const fp3_modulo *m, uint32_t node, int32_t cycle) {
    return node == m->block->count || (*issue_cell(m, cycle) == FP3_NONE_INDEX &&
                                       *write_cell(m, node, cycle) == FP3_NONE_INDEX &&
                                       issue_cell(m, cycle) != write_cell(m, node, cycle));
}

static void put(fp3_modulo *m, uint32_t node, int32_t cycle) {
    m->at[node] = cycle;
    if (node < m->block->count)
        *issue_cell(m, cycle) = *write_cell(m, node, cycle) = node;
}

static void drive_out(fp3_modulo *m, uint32_t node) {
    if (node < m->block->count)
        *issue_cell(m, m->at[node]) = *write_cell(m, node, m->at[node]) = FP3_NONE_INDEX;
    m->at[node] = NEVER;
}

static int open_tables(fp3_modulo *m, uint32_t interval) {
    if (interval > m->tables_room) {
        uint32_t *tables = realloc(m->issues, 2 * (size_t)interval * sizeof *tables);
        if (!tables)
            return 0;
        m->issues = tables;
        m->tables_room = interval;
    }
    m->interval = interval;
    m->writes = m->block->config->writeback_stall ? m->issues : m->issues + interval;
    for (uint32_t i = 0; i < 2 * interval; i++)
        m->issues[i] = FP3_NONE_INDEX;
    for (uint32_t i = 0; i < m->nodes; i++)
        m->at[i] = m->last[i] = NEVER;
    return 1;
}

/* ---- placing ---- */

/* The first cycle in which what is placed already lets a node issue. */
static int32_t earliest(const fp3_modulo *m, uint32_t node, int32_t least) {
    for (uint32_t k = m->graph.in_begin[node]; k < m->graph.in_begin[node + 1]; k++) {
        const fp3_edge *e = &m->graph.edges[m->graph.in[k]];
        if (m->at[e->from] == NEVER || e->from == node)
            continue;
        const int32_t cycle = m->at[e->from] + span_of(e, m->interval);
        if (cycle > least)
            least = cycle;
    }
    return least;
}

static int32_t latest(const fp3_modulo *m, uint32_t node, int32_t most) {
    for (uint32_t k = m->graph.out_begin[node]; k < m->graph.out_begin[node + 1]; k++) {
        const fp3_edge *e = &m->graph.edges[m->graph.out[k]];
        if (m->at[e->to] == NEVER || e->to == node)
            continue;
        const int32_t cycle = m->at[e->to] - span_of(e, m->interval);
        if (cycle < most)
            most = cycle;
    }
    return most;
}

/* A result takes the write cycle of others, that would issue in another cycle because their
 * latency is another one: a cycle that is still free becomes useless to them. How many such cycles
 * there are more. */
static int loss(const fp3_modulo *m, uint32_t node, int32_t cycle) {
    const int32_t latency = (int32_t)m->block->nodes[node].latency;
    int lost = 0;
    for (uint32_t i = 0; i < m->latency_count; i++) {
        const int32_t other = (int32_t)m->latencies[i];
        if (other == latency)
            continue;
        lost += *issue_cell(m, cycle + latency - other) == FP3_NONE_INDEX;
        lost -= m->writes[modulo_of(cycle + other + 1, m->interval)] != FP3_NONE_INDEX;
    }
    return lost;
}

/* The first free cycle within an interval, or a later one that is a smaller loss; NEVER: none is
 * free. */
static int32_t choose_cycle(const fp3_modulo *m, uint32_t node, int32_t first, uint32_t patience) {
    const int32_t end = first + (int32_t)m->interval;
    int32_t cycle = first;
    while (cycle < end && !is_free(m, node, cycle))
        cycle++;
    if (cycle == end)
        return NEVER;
    if (node == m->block->count)
        return cycle;
    int32_t best = cycle, least = loss(m, node, cycle);
    for (int32_t i = cycle + 1; i < end && i <= cycle + (int32_t)patience; i++)
        if (is_free(m, node, i) && loss(m, node, i) < least) {
            best = i;
            least = loss(m, node, i);
        }
    return best;
}

static void drive_out_users(fp3_modulo *m, uint32_t node) {
    for (uint32_t k = m->graph.out_begin[node]; k < m->graph.out_begin[node + 1]; k++) {
        const fp3_edge *e = &m->graph.edges[m->graph.out[k]];
        if (e->to != node && m->at[e->to] != NEVER &&
            m->at[e->to] < m->at[node] + span_of(e, m->interval))
            drive_out(m, e->to);
    }
}

static void place(fp3_modulo *m, uint32_t node, uint32_t patience) {
    const int32_t first = earliest(m, node, 0);
    int32_t cycle = choose_cycle(m, node, first, patience);
    if (cycle == NEVER) {
        cycle = m->last[node] == NEVER || m->last[node] < first ? first : m->last[node] + 1;
        const uint32_t there[] = {*issue_cell(m, cycle), *write_cell(m, node, cycle)};
        for (int i = 0; i < 2; i++)
            if (there[i] != FP3_NONE_INDEX && m->at[there[i]] != NEVER)
                drive_out(m, there[i]);
    }
    put(m, node, cycle);
    if (cycle > m->last[node])
        m->last[node] = cycle;
    drive_out_users(m, node);
}

static int place_all(fp3_modulo *m, uint32_t patience) {
    for (uint32_t budget = 4 * m->nodes + 16; budget; budget--) {
        uint32_t best = FP3_NONE_INDEX;
        for (uint32_t i = 0; i < m->nodes; i++)
            if (m->at[i] == NEVER && (best == FP3_NONE_INDEX || m->height[i] > m->height[best]))
                best = i;
        if (best == FP3_NONE_INDEX)
            return 1;
        place(m, best, patience);
    }
    return 0;
}

/* ---- short lives ---- */

/* The last reader of a value but for one node; NEVER: none. */
static int32_t last_reader(const fp3_modulo *m, uint32_t value, uint32_t but) {
    int32_t last = NEVER;
    for (uint32_t k = m->graph.out_begin[value]; k < m->graph.out_begin[value + 1]; k++) {
        const fp3_edge *e = &m->graph.edges[m->graph.out[k]];
        if (!e->is_anti && !e->distance && e->to != but && m->at[e->to] > last)
            last = m->at[e->to];
    }
    return last;
}

/* Cycles that registers are held because node issues in a certain cycle. */
static int32_t held(const fp3_modulo *m, uint32_t node, int32_t cycle) {
    const fp3_node *n = &m->block->nodes[node];
    int32_t sum = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_ref ref = fp3_node_operand(n, k);
        if (ref.at != FP3_AT_OP || m->block->nodes[ref.index].fixed != FP3_NONE_INDEX)
            continue;
        const int32_t other = last_reader(m, ref.index, node);
        sum += other > cycle ? other : cycle;
    }
    const int32_t last = last_reader(m, node, node);
    return n->fixed == FP3_NONE_INDEX && last != NEVER ? sum - cycle : sum;
}

static int32_t next_free(const fp3_modulo *m, uint32_t node, int32_t from, int32_t to) {
    const int32_t way = from < to ? 1 : -1;
    for (int32_t cycle = from; cycle != to + way; cycle += way)
        if (is_free(m, node, cycle))
            return cycle;
    return NEVER;
}

/* Moves a node to where it holds registers for the fewest cycles. */
static int move(fp3_modulo *m, uint32_t node) {
    const int32_t now = m->at[node], interval = (int32_t)m->interval;
    const int32_t low = earliest(m, node, now - interval), high = latest(m, node, now + interval);
    if (low >= high)
        return 0;
    drive_out(m, node);
    const int32_t tried[] = {next_free(m, node, high, low), next_free(m, node, low, high)};
    int32_t best = now, least = held(m, node, now);
    for (int i = 0; i < 2; i++)
        if (tried[i] != NEVER && held(m, node, tried[i]) < least) {
            best = tried[i];
            least = held(m, node, best);
        }
    put(m, node, best);
    return best != now;
}

static void shorten(fp3_modulo *m) {
    int is_news = 1;
    for (int round = 0; is_news && round < 4; round++) {
        is_news = 0;
        for (uint32_t i = m->block->count; i-- > 0;)
            is_news |= move(m, i);
    }
}

/* ---- the loop ---- */

/* A cycle of an interval has one node at most. */
static void read_tables(const fp3_modulo *m, uint32_t *order, char *is_ahead) {
    const int32_t begin = m->at[m->block->count];
    uint32_t count = 0;
    for (uint32_t i = 0; i < m->interval; i++) {
        const uint32_t node = *issue_cell(m, begin + (int32_t)i);
        if (node != FP3_NONE_INDEX &&
            modulo_of(m->at[node], m->interval) == modulo_of(begin + (int32_t)i, m->interval))
            order[count++] = node;
    }
    for (uint32_t i = 0; i < m->block->count; i++)
        is_ahead[i] = m->at[i] < begin;
}

int fp3_modulo_order(fp3_modulo *modulo, uint32_t interval, uint32_t patience, uint32_t *order,
                     char *is_ahead) {
    if (!find_heights(modulo, interval) || !open_tables(modulo, interval) ||
        !place_all(modulo, patience))
        return 0;
    shorten(modulo);
    read_tables(modulo, order, is_ahead);
    return 1;
}
