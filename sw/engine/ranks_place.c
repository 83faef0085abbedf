/* ranks_place.c - which rank has which object, and what it needs of the others. */
#include "ranks_own.h"

#include "cells.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROOM_MORE 256 /* for guests, as objects move */

static fp3_status no_memory(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
}

static unsigned here(const fp3_ranked *self) { return self->ranks->rank; }

static int sees_all(const fp3_members *group) {
    int is = 0;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        is |= group->lists.lists[i].is_all;
    return is;
}

static int count_near(const fp3_members *group) {
    int count = 0;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        count += group->lists.lists[i].is_near;
    return count;
}

/* ---- whose ---- */

/* Of objects that see all others, whole vectors: FP3_USE_STEP. */
static void divide_group(const fp3_ranked *self, const fp3_members *group) {
    const uint32_t ranks = self->ranks->count;
    const uint64_t step = group->lists.shape.is_any ? FP3_USE_STEP : 1;
    const uint64_t pieces = (group->objects + step - 1) / step;
    for (uint32_t i = 0; i < group->objects; i++)
        self->whose[group->first + i] = (uint32_t)(i / step * ranks / pieces);
}

/* What a step of an object costs, about: its words, and those of its loops once for each neighbour. */
static uint32_t weight_of(const fp3_members *group, uint32_t object) {
    uint32_t weight = group->program.count;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++)
        if (group->lists.lists[k].begin)
            weight += 4 * fp3_list_length(&group->lists.lists[k], object);
    return weight;
}

/* Both ends of each link: Scotch wants a graph that is symmetric and simple. */
static fp3_status make_graph(fp3_engine *engine, uint32_t **begin, uint32_t **other,
                             uint32_t **weight) {
    const fp3_members *group = &engine->layout.groups[0];
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
        return no_memory(engine);
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
                        (*begin)[i + 2 <= n ? i + 2 : n + 1]++;
                        (*begin)[j + 2 <= n ? j + 2 : n + 1]++;
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
        (*weight)[i] = weight_of(group, i);
    }
    (*begin)[n] = to;
    free(seen);
    return FP3_OK;
}

static fp3_status divide_by_links(fp3_engine *engine, fp3_ranked *to) {
    const fp3_ranks *ranks = to->ranks;
    uint32_t *begin = NULL, *other = NULL, *weight = NULL;
    fp3_status status = make_graph(engine, &begin, &other, &weight);
    if (!status &&
        ranks->calls->divide(
            ranks->world, &(fp3_mpi_graph){engine->layout.groups[0].objects, begin, other, weight},
            to->whose))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM,
                          "Scotch does not divide the objects: out of memory");
    free(begin);
    free(other);
    free(weight);
    return status;
}

/* ---- where they are ---- */

typedef struct {
    uint32_t *word[FP3_NEAR_DIMENSIONS]; /* of all objects */
    uint32_t dimensions;
} positions;

static void forget_positions(positions *p) {
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        free(p->word[k]);
}

static fp3_status read_positions(fp3_engine *engine, const fp3_near_rule *rule, positions *p) {
    fp3_status status = FP3_OK;
    *p = (positions){.dimensions = rule->dimensions};
    for (uint32_t k = 0; !status && k < rule->dimensions; k++) {
        p->word[k] = malloc(engine->objects * sizeof *p->word[k]);
        status =
            p->word[k]
                ? fp3_ranks_read(engine,
                                 (fp3_cells){FP3_CELLS_REGISTER, rule->regs[k], 0, engine->objects},
                                 p->word[k])
                : no_memory(engine);
    }
    return status;
}

static float at(const positions *p, uint32_t k, uint32_t object) {
    float f;
    memcpy(&f, &p->word[k][object], sizeof f);
    return f;
}

typedef struct {
    float place;
    uint32_t object;
} placed;

static int by_place(const void *a, const void *b) {
    const placed *x = a, *y = b;
    return x->place != y->place ? (x->place > y->place) - (x->place < y->place)
                                : (x->object > y->object) - (x->object < y->object);
}

/* Recursive bisection: across the longest side of what `list` fills, in the proportion of the ranks of either half. */
static void bisect(const positions *p, placed *list, uint32_t count, uint32_t first, uint32_t ranks,
                   uint32_t *whose) {
    uint32_t axis = 0;
    double longest = -1;
    for (uint32_t k = 0; k < p->dimensions; k++) {
        double least = INFINITY, most = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            least = fmin(least, (double)at(p, k, list[i].object));
            most = fmax(most, (double)at(p, k, list[i].object));
        }
        if (most - least > longest) {
            longest = most - least;
            axis = k;
        }
    }
    if (ranks == 1) {
        for (uint32_t i = 0; i < count; i++)
            whose[list[i].object] = first;
        return;
    }
    for (uint32_t i = 0; i < count; i++)
        list[i].place = at(p, axis, list[i].object);
    qsort(list, count, sizeof *list, by_place);
    const uint32_t low = ranks / 2, cut = (uint32_t)((uint64_t)count * low / ranks);
    bisect(p, list, cut, first, low, whose);
    bisect(p, list + cut, count - cut, first + low, ranks - low, whose);
}

static const fp3_near_rule *rule_of(const fp3_members *group) {
    uint32_t i = 0;
    while (!group->lists.lists[i].is_near)
        i++;
    return &group->lists.lists[i].near;
}

static fp3_status divide_by_place(fp3_engine *engine, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    positions p = {0};
    placed *list = malloc(engine->objects * sizeof *list);
    fp3_status status = list ? FP3_OK : no_memory(engine);
    if (!status)
        status = read_positions(engine, rule_of(group), &p);
    for (uint32_t i = 0; !status && i < engine->objects; i++)
        list[i] = (placed){0, i};
    if (!status)
        bisect(&p, list, engine->objects, 0, to->ranks->count, to->whose);
    forget_positions(&p);
    free(list);
    return status;
}

/* ---- guests ---- */

static void forget_traffic(fp3_ranked *self) {
    if (self->plan)
        self->ranks->calls->forget(self->plan);
    self->plan = NULL;
    fp3_traffic *both[] = {&self->out, &self->in};
    for (int i = 0; i < 2; i++) {
        free(both[i]->rows);
        free(both[i]->count);
        free(both[i]->words);
        *both[i] = (fp3_traffic){0};
    }
}

typedef struct {
    uint8_t *is_needed; /* here, of each object */
    uint8_t *is_wanted; /* by rank r, of the own object in place i: r * own + i */
    uint32_t own;
} needs;

/* Object i reads object j. */
static void note(const fp3_ranked *self, const uint32_t *place, needs *n, uint32_t i, uint32_t j) {
    if (self->whose[i] == self->whose[j])
        return;
    if (self->whose[i] == here(self))
        n->is_needed[j] = 1;
    else if (self->whose[j] == here(self))
        n->is_wanted[(size_t)self->whose[i] * n->own + place[j]] = 1;
}

static void note_links(const fp3_engine *engine, const fp3_ranked *self, const uint32_t *place,
                       needs *n) {
    const fp3_members *group = &engine->layout.groups[0];
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
        const fp3_list *list = &group->lists.lists[k];
        for (uint32_t i = 0; !list->is_near && !list->is_all && i < group->objects; i++)
            for (uint32_t e = list->begin[i]; e < list->begin[i + 1]; e++)
                note(self, place, n, i, list->other[e]);
    }
}

/* Objects in the box of the own ones, with the reach around it: only among these there are pairs. */
static uint32_t find_around(const fp3_ranked *self, const positions *p, double reach,
                            uint32_t *objects, uint32_t count) {
    double least[FP3_NEAR_DIMENSIONS], most[FP3_NEAR_DIMENSIONS];
    uint32_t found = 0;
    for (uint32_t k = 0; k < p->dimensions; k++) {
        least[k] = INFINITY;
        most[k] = -INFINITY;
        for (uint32_t i = 0; i < self->share[here(self)]; i++) {
            least[k] = fmin(least[k], (double)at(p, k, self->mine[i]));
            most[k] = fmax(most[k], (double)at(p, k, self->mine[i]));
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        int is_in = 1;
        for (uint32_t k = 0; k < p->dimensions; k++)
            is_in = is_in && (double)at(p, k, i) >= least[k] - reach &&
                    (double)at(p, k, i) <= most[k] + reach;
        objects[found] = i;
        found += (uint32_t)is_in;
    }
    return found;
}

static fp3_status note_near(fp3_engine *engine, const fp3_ranked *self, const fp3_near_rule *of,
                            const uint32_t *place, needs *n) {
    fp3_near_rule rule = {.dimensions = of->dimensions, .reach = of->reach, .skin = of->skin};
    uint32_t *some = malloc(engine->objects * sizeof *some), *begin = NULL, *other = NULL;
    positions p = {0};
    fp3_status status = some ? read_positions(engine, of, &p) : no_memory(engine);
    uint32_t astray = UINT32_MAX;
    fp3_where_they_are now = {.stride = 1, .objects = engine->objects, .dimensions = p.dimensions};
    for (uint32_t k = 0; k < p.dimensions; k++)
        now.position[k] = p.word[k];
    for (uint32_t k = 0; !status && k < p.dimensions; k++)
        for (uint32_t i = 0; i < n->own; i++)
            self->made[k][i] = at(&p, k, self->mine[i]);
    if (!status && fp3_near_is_stale(&rule, &now, &astray) && astray != UINT32_MAX)
        status = fp3_lists_astray(astray, engine->def.error);
    if (!status) {
        now.objects =
            find_around(self, &p, (rule.reach + rule.skin) * 1.001, some, engine->objects);
        for (uint32_t k = 0; k < p.dimensions; k++)
            for (uint32_t i = 0; i < now.objects; i++)
                p.word[k][i] = p.word[k][some[i]]; /* some[i] >= i */
        if (now.objects)
            status = fp3_near_make(&rule, &now, &begin, &other, engine->def.error);
    }
    for (uint32_t i = 0; !status && begin && i < now.objects; i++)
        for (uint32_t e = begin[i]; e < begin[i + 1]; e++)
            note(self, place, n, some[i], some[other[e]]);
    free(begin);
    free(other);
    free(some);
    fp3_near_close(&rule);
    forget_positions(&p);
    return status;
}

static void note_all(const fp3_engine *engine, const fp3_ranked *self, needs *n) {
    for (uint32_t i = 0; i < engine->objects; i++)
        n->is_needed[i] = n->own && self->whose[i] != here(self);
    for (uint32_t r = 0; r < self->ranks->count; r++)
        if (r != here(self) && self->share[r])
            memset(&n->is_wanted[(size_t)r * n->own], 1, n->own);
}

static void list_guests(const fp3_engine *engine, fp3_ranked *self, const needs *n) {
    self->guest_count = 0;
    for (uint32_t r = 0; r < self->ranks->count; r++) {
        const uint32_t before = self->guest_count;
        for (uint32_t i = 0; i < engine->objects; i++)
            if (n->is_needed[i] && self->whose[i] == r)
                self->guests[self->guest_count++] = i;
        self->in.count[r] = self->guest_count - before;
    }
}

static void list_wanted(fp3_ranked *self, const needs *n) {
    uint32_t count = 0;
    for (uint32_t r = 0; r < self->ranks->count; r++) {
        const uint32_t before = count;
        for (uint32_t i = 0; i < n->own; i++)
            if (n->is_wanted[(size_t)r * n->own + i])
                self->out.rows[count++] = self->first + i;
        self->out.count[r] = count - before;
    }
}

static uint32_t count_wanted(const fp3_ranked *self, const needs *n) {
    uint32_t count = 0;
    for (size_t i = 0; i < (size_t)self->ranks->count * n->own; i++)
        count += n->is_wanted[i];
    return count;
}

static uint32_t words_of(const fp3_engine *engine) {
    uint32_t words = 0;
    for (uint64_t left = fp3_layout_published(&engine->layout.groups[0]); left; left &= left - 1)
        words++;
    return words;
}

static fp3_status make_plan(fp3_engine *engine, fp3_ranked *self) {
    const uint32_t ranks = self->ranks->count, words = words_of(engine);
    uint32_t *send = malloc(ranks * sizeof *send), *receive = malloc(ranks * sizeof *receive);
    size_t out = 0;
    for (uint32_t r = 0; send && receive && r < ranks; r++) {
        send[r] = self->out.count[r] * words;
        receive[r] = self->in.count[r] * words;
        out += send[r];
    }
    self->out.words = malloc((out + 1) * sizeof *self->out.words);
    self->in.words = malloc(((size_t)self->guest_count * words + 1) * sizeof *self->in.words);
    if (send && receive && self->out.words && self->in.words)
        self->plan = self->ranks->calls->plan(self->ranks->world, send, receive, self->out.words,
                                              self->in.words);
    free(send);
    free(receive);
    return self->plan ? FP3_OK : no_memory(engine);
}

fp3_status fp3_ranks_choose_guests(fp3_engine *engine, fp3_ranked *self) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t ranks = self->ranks->count;
    needs n = {.own = self->share[here(self)]};
    uint32_t *place = calloc(engine->objects, sizeof *place);
    n.is_needed = calloc(engine->objects, 1);
    n.is_wanted = calloc((size_t)ranks * n.own + 1, 1);
    fp3_status status = place && n.is_needed && n.is_wanted ? FP3_OK : no_memory(engine);
    for (uint32_t i = 0; !status && i < n.own; i++)
        place[self->mine[i]] = i;
    if (!status)
        note_links(engine, self, place, &n);
    for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++)
        if (group->lists.lists[k].is_near)
            status = note_near(engine, self, &group->lists.lists[k].near, place, &n);
    if (!status && sees_all(group))
        note_all(engine, self, &n);
    forget_traffic(self);
    if (!status) {
        free(self->guests);
        self->guests = malloc(engine->objects * sizeof *self->guests);
        self->in.count = calloc(ranks, sizeof *self->in.count);
        self->out.count = calloc(ranks, sizeof *self->out.count);
        self->out.rows = malloc((count_wanted(self, &n) + (size_t)1) * sizeof *self->out.rows);
        status = self->guests && self->in.count && self->out.count && self->out.rows
                     ? FP3_OK
                     : no_memory(engine);
    }
    if (!status) {
        list_guests(engine, self, &n);
        list_wanted(self, &n);
        status = make_plan(engine, self);
    }
    free(place);
    free(n.is_needed);
    free(n.is_wanted);
    return status;
}

/* ---- the own engine ---- */

static void count_shares(const fp3_engine *engine, fp3_ranked *to) {
    uint32_t own = 0;
    memset(to->share, 0, to->ranks->count * sizeof *to->share);
    for (uint32_t i = 0; i < engine->objects; i++) {
        to->share[to->whose[i]]++;
        if (to->whose[i] == here(to))
            to->mine[own++] = i;
    }
    to->first = to->sees_all && own ? to->mine[0] : 0;
}

static fp3_status load_own(fp3_engine *engine, fp3_ranked *to) {
    const fp3_layout *layout = &engine->layout;
    fp3_group *groups = calloc(layout->count, sizeof *groups);
    size_t count = 0;
    if (!groups)
        return no_memory(engine);
    for (uint32_t g = 0; g < layout->count; g++) {
        size_t own = 0;
        for (uint32_t i = 0; i < layout->groups[g].objects; i++)
            own += to->whose[layout->groups[g].first + i] == here(to);
        if (layout->groups[g].lists.shape.is_any)
            own = to->room;
        to->group[g] = own ? (int)count : -1;
        if (own)
            groups[count++] = (fp3_group){layout->groups[g].image, own};
    }
    fp3_status status = fp3_engine_load_groups(to->own, groups, count);
    free(groups);
    for (uint32_t g = 0; !status && g < layout->count; g++)
        if (to->group[g] >= 0)
            status = fp3_cells_write(to->own,
                                     (fp3_cells){FP3_CELLS_CONSTANT, (uint32_t)to->group[g], 0,
                                                 engine->config->registers},
                                     &to->constants[(size_t)g * engine->config->registers]);
    to->own->clock = engine->clock;
    to->own->made = engine->made;
    return status;
}

/* The numbers of all rows, those without an object behind all. */
static void number_rows(const fp3_ranked *to, uint32_t *numbers) {
    const uint32_t own = to->share[here(to)];
    for (uint32_t i = 0; i < to->room; i++)
        numbers[i] = to->sees_all ? i : UINT32_MAX;
    for (uint32_t i = 0; i < own; i++)
        numbers[to->first + i] = to->mine[i];
    for (uint32_t i = 0; i < to->guest_count; i++)
        numbers[fp3_ranks_row(to, i)] = to->guests[i];
}

/* A list of the own objects; rows: of each object, where it stands. */
static fp3_status give_list(fp3_engine *engine, const fp3_ranked *to, const fp3_list *list,
                            const uint32_t *rows, fp3_list *own) {
    const uint32_t count = to->share[here(to)];
    size_t entries = 0;
    for (uint32_t i = 0; i < count; i++)
        entries += fp3_list_length(list, to->mine[i]);
    uint32_t *begin = calloc(to->room + (size_t)1, sizeof *begin),
             *other = malloc((entries + 1) * sizeof *other), n = 0;
    float *field = malloc((entries * list->fields + 1) * sizeof *field);
    fp3_status status = begin && other && field ? FP3_OK : no_memory(engine);
    for (uint32_t i = 0; !status && i < to->room; i++) {
        const uint32_t object = i < count ? to->mine[i] : UINT32_MAX;
        for (uint32_t e = i < count ? list->begin[object] : 0;
             i < count && e < list->begin[object + 1]; e++, n++) {
            other[n] = rows[list->other[e]];
            memcpy(&field[(size_t)n * list->fields], &list->field[(size_t)e * list->fields],
                   list->fields * sizeof *field);
        }
        begin[i + 1] = n;
    }
    if (!status)
        status = fp3_list_take(own, &(fp3_neighbours){begin, other, field}, engine->def.error);
    free(begin);
    free(other);
    free(field);
    return status;
}

static fp3_status give_lists(fp3_engine *engine, fp3_ranked *to) {
    const fp3_lists *lists = &engine->layout.groups[0].lists;
    fp3_members *group = &to->own->layout.groups[0];
    uint32_t *rows = malloc((engine->objects + (size_t)1) * sizeof *rows),
             *numbers = malloc((to->room + (size_t)1) * sizeof *numbers);
    fp3_status status = rows && numbers ? FP3_OK : no_memory(engine);
    if (!status) {
        number_rows(to, numbers);
        for (uint32_t i = 0; i < to->room; i++)
            if (numbers[i] != UINT32_MAX)
                rows[numbers[i]] = i;
    }
    for (uint32_t k = 0; !status && k < lists->shape.list_count; k++) {
        const fp3_list *list = &lists->lists[k];
        fp3_list *own = &group->lists.lists[k];
        if (list->is_near)
            fp3_list_take_near(own, &list->near);
        else if (list->is_all)
            status = fp3_list_take(own, &(fp3_neighbours){0}, engine->def.error);
        else if (list->is_there)
            status = give_list(engine, to, list, rows, own);
        if (!status && to->own->backend->connect)
            status = to->own->backend->connect(to->own, group, own);
    }
    if (!status)
        status = fp3_engine_set_numbers(to->own, numbers);
    free(rows);
    free(numbers);
    return status;
}

static void use_rows(fp3_engine *engine, fp3_ranked *to) {
    fp3_engine_use(to->own, to->first, to->share[here(to)]);
    to->own->layout.groups[0].rows =
        to->sees_all ? engine->objects : to->share[here(to)] + to->guest_count;
    fp3_engine_set_exchange(to->own, fp3_ranks_exchange, engine);
}

/* Opens it for `whose` and guests, empty. */
static fp3_status settle(fp3_engine *engine, fp3_ranked *to) {
    const uint32_t own = to->share[here(to)];
    const int is_around = engine->layout.groups[0].lists.shape.is_any;
    to->room = to->sees_all
                   ? engine->objects
                   : own + to->guest_count + (to->made[0] ? to->guest_count + ROOM_MORE : 0);
    if (!own)
        return FP3_OK;
    to->def.objects = to->room;
    to->def.visit = engine->def.visit;
    fp3_status status = fp3_engine_open(&to->def, &to->own);
    if (!status)
        status = load_own(engine, to);
    if (!status && is_around && to->is_placed)
        status = give_lists(engine, to);
    if (!status && is_around)
        use_rows(engine, to);
    return status;
}

fp3_status fp3_ranks_begin(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    fp3_engine_close(&self->own);
    forget_traffic(self);
    self->guest_count = 0;
    self->sees_all = 0;
    self->is_placed = !engine->layout.groups[0].lists.shape.is_any;
    for (uint32_t i = 0; i < engine->layout.count; i++)
        divide_group(self, &engine->layout.groups[i]);
    count_shares(engine, self);
    return settle(engine, self);
}

/* ---- moving ---- */

void fp3_ranks_forget(fp3_ranked *self) {
    forget_traffic(self);
    fp3_engine_close(&self->own);
    free(self->whose);
    free(self->mine);
    free(self->share);
    free(self->guests);
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        free(self->made[k]);
}

static int is_any_set(const uint32_t *words, size_t count) {
    uint32_t any = 0;
    for (size_t i = 0; i < count; i++)
        any |= words[i];
    return any != 0;
}

/* A register at a time: what was never written is not made. */
static fp3_status move(fp3_engine *engine, fp3_ranked *before, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t count = engine->objects;
    uint32_t *words = malloc(count * sizeof *words);
    fp3_status status = words ? FP3_OK : no_memory(engine);
    for (uint32_t reg = 0; !status && reg < 1u << group->log2 && reg < engine->config->registers;
         reg++) {
        const fp3_cells cells = {FP3_CELLS_REGISTER, reg, 0, count};
        engine->self = before;
        status = fp3_ranks_read(engine, cells, words);
        engine->self = to;
        if (!status && is_any_set(words, count))
            status = engine->backend->write(engine, cells, words);
    }
    free(words);
    return status;
}

static fp3_status divide(fp3_engine *engine, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    int is_linked = 0;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++)
        is_linked |= group->lists.lists[k].begin && !group->lists.lists[k].is_near;
    if (to->sees_all)
        divide_group(to, group);
    return to->sees_all ? FP3_OK
           : is_linked  ? divide_by_links(engine, to)
                        : divide_by_place(engine, to);
}

static fp3_status remember(fp3_engine *engine, fp3_ranked *to) {
    const int near = count_near(&engine->layout.groups[0]);
    if (near > 1)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "several ranks: a model with more than one relation `near`");
    if (!near)
        return FP3_OK;
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        to->made[k] = malloc((to->share[here(to)] + (size_t)1) * sizeof *to->made[k]);
        if (!to->made[k])
            return no_memory(engine);
    }
    return FP3_OK;
}

fp3_status fp3_ranks_place(fp3_engine *engine) {
    fp3_ranked *self = engine->self, before = *self;
    fp3_ranked to = *self;
    to.whose = malloc(engine->objects * sizeof *to.whose);
    to.mine = malloc(engine->objects * sizeof *to.mine);
    to.share = calloc(to.ranks->count, sizeof *to.share);
    to.own = NULL;
    to.guests = NULL;
    to.guest_count = 0;
    to.out = to.in = (fp3_traffic){0};
    to.plan = NULL;
    to.sees_all = sees_all(&engine->layout.groups[0]);
    to.is_placed = 1;
    memset(to.made, 0, sizeof to.made);
    fp3_status status = to.whose && to.mine && to.share ? FP3_OK : no_memory(engine);
    if (!status)
        status = divide(engine, &to);
    if (!status) {
        count_shares(engine, &to);
        status = remember(engine, &to);
    }
    if (!status)
        status = fp3_ranks_choose_guests(engine, &to);
    if (!status)
        status = settle(engine, &to);
    if (!status) {
        *self = to;
        status = move(engine, &before, self);
    }
    if (!status) /* the first exchange does not wait for who was slower here */
        to.ranks->calls->most(to.ranks->world, 0);
    fp3_ranks_forget(status ? &to : &before);
    if (status)
        *self = before;
    engine->self = self;
    return status;
}

/* ---- between phases ---- */

/* Whether some object has moved by more than half the skin since guests were chosen: then another may be near that is none. */
static fp3_status look_who_moved(fp3_engine *engine, uint64_t *has_moved) {
    const fp3_ranked *self = engine->self;
    const fp3_near_rule *rule = rule_of(&engine->layout.groups[0]);
    const uint32_t own = self->share[here(self)];
    const float most = (float)(rule->skin * rule->skin / 4 * (1 - 1e-5));
    float *now = malloc((own + (size_t)1) * sizeof *now),
          *way = calloc(own + (size_t)1, sizeof *way);
    fp3_status status = now && way ? FP3_OK : no_memory(engine);
    for (uint32_t k = 0; !status && own && k < rule->dimensions; k++) {
        status = self->own->backend->read(
            self->own, (fp3_cells){FP3_CELLS_REGISTER, rule->regs[k], self->first, own}, now);
        for (uint32_t i = 0; !status && i < own; i++)
            way[i] += (now[i] - self->made[k][i]) * (now[i] - self->made[k][i]);
    }
    *has_moved = 0;
    for (uint32_t i = 0; !status && i < own; i++)
        *has_moved |= !(way[i] <= most);
    free(now);
    free(way);
    return status;
}

/* Words that neighbours read and no phase stores: an exchange does not bring them. */
static fp3_status bring_constants(fp3_engine *engine) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint64_t set = group->lists.shape.published & ~fp3_layout_published(group);
    uint32_t *words = malloc(engine->objects * sizeof *words);
    fp3_status status = words ? FP3_OK : no_memory(engine);
    for (uint32_t reg = 0; !status && reg < engine->config->registers; reg++)
        if (set >> reg & 1) {
            const fp3_cells cells = {FP3_CELLS_REGISTER, reg, 0, engine->objects};
            status = fp3_ranks_read(engine, cells, words);
            if (!status && ((fp3_ranked *)engine->self)->own)
                status = fp3_ranks_write_guests(engine->self, cells, words);
        }
    free(words);
    return status;
}

static fp3_status choose_again(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    uint32_t *numbers = malloc((self->room + (size_t)1) * sizeof *numbers);
    fp3_status status = numbers ? fp3_ranks_choose_guests(engine, self) : no_memory(engine);
    if (!status && self->own && self->share[here(self)] + self->guest_count > self->room)
        status = fp3_fail(engine->def.error, FP3_E_LIMIT,
                          "rank %u has %" PRIu32 " objects of its own and needs %" PRIu32
                          " of other ranks: there is room for %" PRIu32 " together",
                          here(self), self->share[here(self)], self->guest_count, self->room);
    if (!status && self->own) {
        self->own->layout.groups[0].rows = self->share[here(self)] + self->guest_count;
        number_rows(self, numbers);
        status = fp3_engine_set_numbers(self->own, numbers);
    }
    free(numbers);
    return status ? status : bring_constants(engine);
}

static fp3_status send_and_receive(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    const uint32_t ranks = self->ranks->count;
    const uint64_t published = fp3_layout_published(&engine->layout.groups[0]);
    fp3_status status = FP3_OK;
    uint32_t *to = self->out.words, *from = self->in.words;
    for (uint32_t r = 0, row = 0; r < ranks; row += self->out.count[r], r++)
        for (uint32_t reg = 0; !status && self->out.count[r] && reg < 64; reg++)
            if (published >> reg & 1) {
                status =
                    fp3_engine_gather(self->own, reg, self->out.rows + row, self->out.count[r], to);
                to += self->out.count[r];
            }
    if (status)
        return status;
    self->ranks->calls->begin(self->plan);
    self->ranks->calls->end(self->plan);
    for (uint32_t r = 0, guest = 0; r < ranks; guest += self->in.count[r], r++)
        for (uint32_t reg = 0; !status && self->in.count[r] && reg < 64; reg++)
            if (published >> reg & 1) {
                status = self->own->backend->write(self->own,
                                                   (fp3_cells){FP3_CELLS_REGISTER, reg,
                                                               fp3_ranks_row(self, guest),
                                                               self->in.count[r]},
                                                   from);
                from += self->in.count[r];
            }
    return status;
}

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void note_exchange(const fp3_ranked *self, const fp3_engine *engine, uint64_t began) {
    fp3_exchanged *all = self->ranks->exchanged;
    if (!all)
        return;
    for (uint32_t r = 0; r < self->ranks->count; r++)
        all->bytes += sizeof(uint32_t) * (uint64_t)self->out.count[r] * words_of(engine);
    all->times++;
    all->nanoseconds += now() - began;
}

/* The engine that makes a run again stands in for the own one. */
fp3_status fp3_ranks_exchange(void *user, fp3_engine *own) {
    fp3_engine *engine = user;
    fp3_ranked *self = engine->self;
    fp3_engine *usual = self->own;
    const uint64_t began = now();
    uint64_t has_moved = 0;
    fp3_status status = FP3_OK;
    self->own = own;
    if (self->made[0])
        status = look_who_moved(engine, &has_moved);
    if (!status && self->made[0] && self->ranks->calls->most(self->ranks->world, has_moved))
        status = choose_again(engine);
    if (!status)
        status = send_and_receive(engine);
    if (!status)
        note_exchange(self, engine, began);
    self->own = usual;
    return status;
}
