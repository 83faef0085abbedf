/* SPDX-License-Identifier: Apache-2.0 */
/* guests.c - which objects of other ranks a rank needs, and which of its own others need. */
#include "inside.h"
#include "positions.h"

#include <math.h>
#include <stdlib.h>

void fp3_ranks_forget_traffic(fp3_ranked *self) {
    if (self->is_open) { /* a run that failed: what MPI may still write to stays */
        self->out = self->in = (fp3_traffic){0};
        self->plan = NULL;
        return;
    }
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
    if (self->whose[i] == fp3_ranks_here(self))
        n->is_needed[j] = 1;
    else if (self->whose[j] == fp3_ranks_here(self))
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

/* Objects in the box of the own ones, with the reach around it: only among these there are pairs.
 */
static uint32_t find_around(const fp3_ranked *self, const fp3_positions *p, double reach,
                            uint32_t *objects, uint32_t count) {
    double least[FP3_NEAR_DIMENSIONS], most[FP3_NEAR_DIMENSIONS];
    uint32_t found = 0;
    for (uint32_t k = 0; k < p->dimensions; k++) {
        least[k] = INFINITY;
        most[k] = -INFINITY;
        for (uint32_t i = 0; i < self->share[fp3_ranks_here(self)]; i++) {
            least[k] = fmin(least[k], fp3_position(p, k, self->mine[i]));
            most[k] = fmax(most[k], fp3_position(p, k, self->mine[i]));
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        int is_in = 1;
        for (uint32_t k = 0; k < p->dimensions; k++)
            is_in = is_in && fp3_position(p, k, i) >= least[k] - reach &&
                    fp3_position(p, k, i) <= most[k] + reach;
        objects[found] = i;
        found += (uint32_t)is_in;
    }
    return found;
}

static fp3_status note_near(fp3_engine *engine, const fp3_ranked *self, const fp3_near_rule *rule,
                            const uint32_t *place, needs *n) {
    uint32_t *some = malloc(engine->objects * sizeof *some), *begin = NULL, *other = NULL;
    fp3_positions p = {0};
    fp3_status status = some ? fp3_positions_read(engine, rule, &p) : fp3_ranks_no_memory(engine);
    uint32_t count = 0;
    for (uint32_t k = 0; !status && k < p.dimensions; k++)
        for (uint32_t i = 0; i < n->own; i++)
            memcpy(&self->made[k][i], &p.word[k][self->mine[i]], sizeof(float));
    if (!status)
        count = find_around(self, &p, fp3_near_reach(rule) * 1.001, some, engine->objects);
    for (uint32_t k = 0; k < p.dimensions; k++)
        for (uint32_t i = 0; i < count; i++)
            p.word[k][i] = p.word[k][some[i]]; /* some[i] >= i */
    if (count)
        status = fp3_positions_pairs(&p, rule, count, &begin, &other, engine->def.error);
    for (uint32_t i = 0; !status && i < count; i++)
        for (uint32_t e = begin[i]; e < begin[i + 1]; e++)
            note(self, place, n, some[i], some[other[e]]);
    free(begin);
    free(other);
    free(some);
    fp3_positions_close(&p);
    return status;
}

static void note_all(const fp3_engine *engine, const fp3_ranked *self, needs *n) {
    for (uint32_t i = 0; i < engine->objects; i++)
        n->is_needed[i] = n->own && self->whose[i] != fp3_ranks_here(self);
    for (uint32_t r = 0; r < self->ranks->count; r++)
        if (r != fp3_ranks_here(self) && self->share[r])
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
    return self->plan ? FP3_OK : fp3_ranks_no_memory(engine);
}

fp3_status fp3_ranks_choose_guests(fp3_engine *engine, fp3_ranked *self) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t ranks = self->ranks->count;
    needs n = {.own = self->share[fp3_ranks_here(self)]};
    uint32_t *place = calloc(engine->objects, sizeof *place);
    n.is_needed = calloc(engine->objects, 1);
    n.is_wanted = calloc((size_t)ranks * n.own + 1, 1);
    fp3_status status = place && n.is_needed && n.is_wanted ? FP3_OK : fp3_ranks_no_memory(engine);
    for (uint32_t i = 0; !status && i < n.own; i++)
        place[self->mine[i]] = i;
    if (!status)
        note_links(engine, self, place, &n);
    for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++)
        if (group->lists.lists[k].is_near && self->made[0])
            status = note_near(engine, self, &group->lists.lists[k].near, place, &n);
    if (!status && fp3_ranks_is_all(group))
        note_all(engine, self, &n);
    if (!status) { /* a run that positions end still has those that it had */
        fp3_ranks_forget_traffic(self);
        free(self->guests);
        self->guests = malloc(engine->objects * sizeof *self->guests);
        self->in.count = calloc(ranks, sizeof *self->in.count);
        self->out.count = calloc(ranks, sizeof *self->out.count);
        self->out.rows = malloc((count_wanted(self, &n) + (size_t)1) * sizeof *self->out.rows);
        status = self->guests && self->in.count && self->out.count && self->out.rows
                     ? FP3_OK
                     : fp3_ranks_no_memory(engine);
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

/* The numbers of all rows, those without an object behind all. */
void fp3_ranks_number_rows(const fp3_ranked *to, uint32_t *numbers) {
    const uint32_t own = to->share[fp3_ranks_here(to)];
    for (uint32_t i = 0; i < to->room; i++)
        numbers[i] = to->sees_all ? i : UINT32_MAX;
    for (uint32_t i = 0; i < own; i++)
        numbers[to->first + i] = to->mine[i];
    for (uint32_t i = 0; i < to->guest_count; i++)
        numbers[fp3_ranks_row(to, i)] = to->guests[i];
}
