/* SPDX-License-Identifier: Apache-2.0 */
/* divide.c - which rank has which object. */
#include "inside.h"
#include "positions.h"

#include <math.h>
#include <stdlib.h>

/* ---- by number ---- */

/* Of objects that see all others, whole vectors: FP3_USE_STEP. */
void fp3_ranks_divide_group(const fp3_ranked *self, const fp3_members *group) {
    const uint32_t ranks = self->ranks->count;
    const uint64_t step =
        group->lists.shape.is_any && !self->backend.begins_at_0 ? FP3_USE_STEP : 1;
    const uint64_t pieces = (group->objects + step - 1) / step;
    for (uint32_t i = 0; i < group->objects; i++)
        self->whose[group->first + i] = (uint32_t)(i / step * ranks / pieces);
}

/* ---- what a step costs ---- */

/* In words that are executed: once, and for each neighbour of a relation. */
typedef struct {
    uint32_t once, turn[FP3_LISTS_MAX];
} cost;

static cost cost_of(fp3_members *group) {
    const fp3_code *program = &group->program;
    cost c = {.once = program->count};
    for (uint32_t pc = 0; pc < program->count; pc++)
        if (program->decoded[pc].in.op == FP3_OP_EACH) {
            const fp3_list *list = fp3_lists_of(&group->lists, program->decoded[pc].in.d);
            const uint32_t words = fp3_neighbourhood_end(program->decoded, pc) - pc;
            c.turn[list - group->lists.lists] += words;
            c.once -= words;
        }
    return c;
}

/* ---- by links ---- */

/* Both ends of each link: Scotch wants a graph that is symmetric and simple. */
static fp3_status make_graph(fp3_engine *engine, uint32_t **begin, uint32_t **other,
                             uint32_t **weight) {
    fp3_members *group = &engine->layout.groups[0];
    const cost each = cost_of(group);
    const uint32_t n = group->objects;
    size_t entries = 0;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++)
        if (group->lists.lists[k].begin)
            entries += group->lists.lists[k].begin[n];
    *begin = calloc(n + (size_t)2, sizeof **begin);
    *other = malloc((2 * entries + 1) * sizeof **other);
    *weight = malloc((n + (size_t)1) * sizeof **weight);
    uint32_t *seen = malloc((n + (size_t)1) * sizeof *seen);
    if (!*begin || !*other || !*weight || !seen) {
        free(seen);
        return fp3_ranks_no_memory(engine);
    }
    for (int pass = 0; pass < 2; pass++) { /* counts, then enters */
        for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
            const fp3_list *list = &group->lists.lists[k];
            for (uint32_t i = 0; list->begin && !list->is_near && i < n; i++)
                for (uint32_t e = list->begin[i]; e < list->begin[i + 1]; e++) {
                    const uint32_t j = list->other[e];
                    if (pass) {
                        (*other)[(*begin)[i + 1]++] = j;
                        (*other)[(*begin)[j + 1]++] = i;
                    } else {
                        (*begin)[i + 2]++;
                        (*begin)[j + 2]++;
                    }
                }
        }
        if (!pass)
            for (uint32_t i = 2; i <= n + 1; i++)
                (*begin)[i] += (*begin)[i - 1];
    }
    uint32_t to = 0; /* each neighbour once */
    for (uint32_t i = 0; i < n; i++)
        seen[i] = UINT32_MAX;
    for (uint32_t i = 0, from = 0; i < n; i++) {
        const uint32_t end = (*begin)[i + 1];
        for ((*begin)[i] = to; from < end; from++)
            if (seen[(*other)[from]] != i) {
                seen[(*other)[from]] = i;
                (*other)[to++] = (*other)[from];
            }
        (*weight)[i] = each.once;
        for (uint32_t k = 0; k < group->lists.shape.list_count; k++)
            if (group->lists.lists[k].begin && !group->lists.lists[k].is_near)
                (*weight)[i] += each.turn[k] * fp3_list_length(&group->lists.lists[k], i);
    }
    (*begin)[n] = to;
    free(seen);
    return FP3_OK;
}

fp3_status fp3_ranks_divide_by_links(fp3_engine *engine, fp3_ranked *to) {
    const fp3_ranks *ranks = to->ranks;
    uint32_t *begin = NULL, *other = NULL, *weight = NULL;
    const int is_made = ranks->rank || !make_graph(engine, &begin, &other, &weight);
    const fp3_mpi_graph graph = {engine->layout.groups[0].objects, begin, other, weight};
    fp3_status status = FP3_OK;
    if (ranks->calls->divide(ranks->world, is_made ? &graph : NULL, to->whose))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM,
                          "Scotch does not divide the objects: out of memory");
    free(begin);
    free(other);
    free(weight);
    return status;
}

/* ---- by place ---- */

/* Where the first `low` of so many ranks have their share of the weight. Every rank gets an object.
 */
static uint32_t find_cut(const fp3_positioned *list, uint32_t count, uint32_t low, uint32_t ranks) {
    uint64_t all = 0, sum = 0;
    uint32_t cut = 0;
    for (uint32_t i = 0; i < count; i++)
        all += list[i].weight;
    for (; cut < count - (ranks - low) && (cut < low || sum * ranks < all * low); cut++)
        sum += list[cut].weight;
    return cut;
}

/* Recursive bisection: across the longest side of what `list` fills, in the proportion of the ranks
 * of either half. */
static void bisect(const fp3_positions *p, fp3_positioned *list, uint32_t count, uint32_t first,
                   uint32_t ranks, uint32_t *whose) {
    if (ranks == 1) {
        for (uint32_t i = 0; i < count; i++)
            whose[list[i].object] = first;
        return;
    }
    fp3_positions_sort(p, list, count);
    const uint32_t low = ranks / 2, cut = find_cut(list, count, low, ranks);
    bisect(p, list, cut, first, low, whose);
    bisect(p, list + cut, count - cut, first + low, ranks - low, whose);
}

/* By how many are near each now, and linked with it. */
static fp3_status weigh(fp3_engine *engine, const fp3_positions *p, fp3_positioned *list) {
    fp3_members *group = &engine->layout.groups[0];
    const cost each = cost_of(group);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->objects; i++)
        list[i] = (fp3_positioned){0, i, each.once};
    for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++) {
        const fp3_list *of = &group->lists.lists[k];
        uint32_t *made = NULL, *other = NULL;
        if (of->is_near)
            status = fp3_positions_pairs(p, &of->near, engine->objects, &made, &other,
                                         engine->def.error);
        const uint32_t *begin = of->is_near ? made : of->begin;
        for (uint32_t i = 0; !status && begin && i < engine->objects; i++)
            list[i].weight += (uint64_t)each.turn[k] * (begin[i + 1] - begin[i]);
        free(made);
        free(other);
    }
    return status;
}

fp3_status fp3_ranks_divide_by_place(fp3_engine *engine, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    fp3_positions p = {0};
    fp3_positioned *list = malloc(engine->objects * sizeof *list);
    fp3_status status = list ? FP3_OK : fp3_ranks_no_memory(engine);
    if (!status)
        status = fp3_positions_read(engine, fp3_positions_rule(group), &p);
    if (!status)
        status = weigh(engine, &p, list);
    if (!status)
        bisect(&p, list, engine->objects, 0, to->ranks->count, to->whose);
    fp3_positions_close(&p);
    free(list);
    return status;
}
