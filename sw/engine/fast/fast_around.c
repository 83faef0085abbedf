/* SPDX-License-Identifier: Apache-2.0 */
/* fast_around.c - phases of the "fast" engine, each by all threads. */
#include "fast_own.h"

#include "engine/common/follow.h"
#include "engine/common/origin.h"
#include "engine/common/words.h"

#include <stdlib.h>
#include <string.h>

/* What the threads share. */
typedef struct {
    fast *self;
    const fp3_fast *program;
    fp3_fast_group group;
    uint32_t phase, from, count; /* from: of the group's rows, the first */
    const piece *pieces;         /* or NULL: blocks of those rows */
    uint32_t piece_count;
} sweep;

void fp3_around_forget(group *g) {
    for (int i = 0; i < FP3_LISTS_MAX; i++) {
        fp3_fast_pack_free(&g->lists[i]);
        free(g->in_rows[i]);
        g->in_rows[i] = NULL;
    }
    free(g->records);
    g->records = NULL;
    free(g->pieces);
    g->pieces = NULL;
    g->is_packed = 0;
}

/* ---- which objects see guests ---- */

/* Whether they are computed in pieces: there are guests, which links alone show. */
static int is_in_pieces(const fp3_engine *engine, const fp3_members *members) {
    int is = engine->exchange.begin != NULL;
    for (uint32_t i = 0; i < members->lists.shape.list_count; i++)
        is = is && !members->lists.lists[i].is_near && !members->lists.lists[i].is_all;
    return is;
}

static int sees_guests(const fp3_members *members, uint32_t first, uint32_t end) {
    int is = 0;
    for (uint32_t k = 0; k < members->lists.shape.list_count; k++) {
        const fp3_list *list = &members->lists.lists[k];
        for (uint32_t e = list->begin[first]; e < list->begin[end]; e++)
            is |= list->other[e] >= members->objects;
    }
    return is;
}

/* Vector by vector: those that see guests, or those that see none. */
static uint32_t list_pieces(const fp3_members *members, uint32_t lanes, int is_outer, piece *to) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < members->objects; i += lanes) {
        const uint32_t end = i + lanes < members->objects ? i + lanes : members->objects;
        if (sees_guests(members, i, end) != is_outer)
            continue;
        if (count && to[count - 1].first + to[count - 1].count == i &&
            to[count - 1].count + lanes <= FP3_BLOCK)
            to[count - 1].count += end - i;
        else
            to[count++] = (piece){i, end - i};
    }
    return count;
}

static uint32_t lanes_of(const group *g) {
    const unsigned native = fp3_fast_native_lanes(g->program);
    return native ? native : 1;
}

static fp3_status need_pieces(fp3_engine *engine, const fp3_members *members, group *g) {
    const uint32_t lanes = lanes_of(g);
    if (!is_in_pieces(engine, members) || g->pieces)
        return FP3_OK;
    g->pieces = malloc((members->objects / lanes + (size_t)1) * sizeof *g->pieces);
    if (!g->pieces)
        return fp3_no_memory(engine->def.error);
    g->inner_count = list_pieces(members, lanes, 0, g->pieces);
    g->piece_count = g->inner_count + list_pieces(members, lanes, 1, g->pieces + g->inner_count);
    return FP3_OK;
}

/* ---- what the executor needs ---- */

/* Those that make steps, from the group's first row on. */
static uint32_t end_of(const fp3_members *members) {
    return members->lists.living ? members->lists.living->count : members->from + members->objects;
}

/* Links between objects by their numbers, of which some do not live, become links between rows:
 * begin and other, one behind the other. Fields stay where they are. */
static fp3_status link_rows(fp3_engine *engine, const fp3_list *l, uint32_t **to) {
    const fp3_living *living = l->living;
    const uint32_t entries = l->begin[l->objects];
    uint32_t *begin = *to = malloc(((size_t)living->count + 1 + entries) * sizeof *begin);
    if (!begin)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < living->count; i++)
        begin[i] = l->begin[living->who[i]];
    begin[living->count] = entries;
    for (uint32_t i = 0; i < entries; i++)
        begin[living->count + 1 + i] = living->place[l->other[i]];
    return FP3_OK;
}

/* Lists of guests are left out. Padding lanes of the last vector repeat the last object, so they
 * need its list. */
static fp3_status pack_one(fp3_engine *engine, const fp3_members *members, group *g, uint32_t i) {
    const fp3_list *l = &members->lists.lists[i];
    fp3_fast_given given = {.begin = l->is_all ? NULL : l->begin,
                            .other = l->other,
                            .field = l->field,
                            .fields = l->fields,
                            .objects = end_of(members),
                            .first = l->living ? 0 : l->first,
                            .end = l->living ? l->living->count : l->end,
                            .rows = members->rows,
                            .is_fixed = !l->is_near,
                            .is_written = fp3_list_remembers(l)};
    if (l->living && !l->is_all && !l->is_near) {
        const fp3_status status = link_rows(engine, l, &g->in_rows[i]);
        if (status)
            return status;
        given.begin = g->in_rows[i];
        given.other = g->in_rows[i] + l->living->count + 1;
    }
    return fp3_fast_pack(&given, fp3_fast_native_lanes(g->program), &g->lists[i],
                         engine->def.error);
}

static fp3_status pack(fp3_engine *engine, const fp3_members *members, group *g) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !g->is_packed && !status && i < members->lists.shape.list_count; i++)
        status = pack_one(engine, members, g, i);
    g->is_packed = !status;
    return status;
}

static fp3_status need_halves(fp3_engine *engine, const group *g) {
    fast *self = engine->self;
    FP3_EACH_REGISTER (fp3_fast_doubled(g->program), reg)
        if (!self->other_half[reg] &&
            !(self->other_half[reg] = fp3_words_make(engine, engine->objects)))
            return fp3_no_memory(engine->def.error);
    return FP3_OK;
}

static uint32_t share_begin(const sweep *s, uint32_t number) {
    const uint64_t blocks = s->pieces ? s->piece_count : (s->count + FP3_BLOCK - 1) / FP3_BLOCK;
    return (uint32_t)(blocks * number / s->self->used);
}

static piece piece_of(const sweep *s, uint32_t n) {
    const uint32_t first = n * FP3_BLOCK, left = s->count - first;
    return s->pieces ? s->pieces[n] : (piece){s->from + first, left < FP3_BLOCK ? left : FP3_BLOCK};
}

/* First its own share, which is in its processor's cache from the phase before, then what others
 * have left of theirs. */
static void take_part(void *of, uint32_t number) {
    sweep *s = of;
    const uint32_t used = s->self->used;
    for (uint32_t i = 0; i < used; i++) {
        const uint32_t whose = (number + i) % used, end = share_begin(s, whose + 1);
        atomic_uint *next = &s->self->hands[whose].next;
        for (uint32_t n; (n = atomic_fetch_add(next, 1)) < end;) {
            const piece p = piece_of(s, n);
            fp3_fast_phase(s->program, s->self->hands[number].worker, &s->group, s->phase, p.first,
                           p.count);
        }
    }
}

static fp3_status need_records(fp3_engine *engine, group *g) {
    int is_any = 0;
    for (int i = 0; i < FP3_LISTS_MAX; i++)
        is_any |= g->lists[i].is_gathered;
    if (!is_any || g->records)
        return FP3_OK;
    const size_t bytes = fp3_fast_records(g->program, engine->objects) * sizeof *g->records;
    g->records = aligned_alloc(64, (bytes + 63) / 64 * 64);
    return g->records ? FP3_OK : fp3_no_memory(engine->def.error);
}

static void run_own(void *user, fp3_task_fn *task, void *of, uint32_t count) {
    fp3_threads_run(user, task, of, count);
}

/* The threads of this run. */
static fp3_crew crew_of(const fp3_engine *engine) {
    const fast *self = engine->self;
    return engine->def.tasks ? (fp3_crew){engine->def.tasks, engine->def.tasks_user, self->used}
                             : (fp3_crew){run_own, self->threads, self->used};
}

static fp3_status follow(fp3_engine *engine, fp3_members *members, group *g) {
    const fast *self = engine->self;
    const fp3_crew crew = crew_of(engine);
    const uint32_t *words[FP3_BANK_OBJECT_COUNT];
    int is_new = 0;
    fp3_status status = fp3_order_follow(engine, members);
    const uint32_t rows = fp3_order_rows(members);
    for (int reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
        words[reg] = self->column[reg] ? self->column[reg] + members->first : NULL;
    if (!status)
        status = fp3_lists_follow(&members->lists, rows, members->from ? rows : end_of(members),
                                  words, self->row, 1, &crew, &is_new, engine->def.error);
    if (is_new)
        fp3_around_forget(g);
    if (!status)
        status = pack(engine, members, g);
    if (!status)
        status = need_pieces(engine, members, g);
    return status ? status : need_records(engine, g);
}

static void sweep_all(fp3_engine *engine, sweep *s) {
    fast *self = engine->self;
    for (uint32_t i = 0; i < self->used; i++)
        atomic_store(&self->hands[i].next, share_begin(s, i));
    if (engine->def.tasks)
        engine->def.tasks(engine->def.tasks_user, take_part, s, self->used);
    else
        fp3_threads_run(self->threads, take_part, s, self->used);
}

/* What neighbours read of these rows goes where they read it. */
static void gather(fp3_engine *engine, sweep s, const group *g, uint32_t from, uint32_t count) {
    if (!g->records)
        return;
    s.phase = fp3_fast_phases(g->program);
    s.from = from;
    s.count = count;
    sweep_all(engine, &s);
}

static void take_pieces(fp3_engine *engine, sweep s, const group *g, uint32_t first, uint32_t end) {
    s.pieces = g->pieces + first;
    s.piece_count = end - first;
    sweep_all(engine, &s);
}

/* An exchange has begun. While words are on their way, those are computed that need none of them.
 */
static fp3_status sweep_around_exchange(fp3_engine *engine, const fp3_members *members,
                                        const group *g, const sweep *s) {
    gather(engine, *s, g, 0, members->objects);
    take_pieces(engine, *s, g, 0, g->inner_count);
    const fp3_status status = fp3_engine_exchange_end(engine);
    if (status)
        return status;
    const uint32_t guests = members->objects / lanes_of(g) * lanes_of(g); /* from a whole vector */
    gather(engine, *s, g, guests, members->rows - guests);
    take_pieces(engine, *s, g, g->inner_count, g->piece_count);
    return FP3_OK;
}

static fp3_status make_phase(fp3_engine *engine, const fp3_members *members, const group *g,
                             uint32_t phase) {
    fast *self = engine->self;
    uint32_t *own[FP3_BANK_OBJECT_COUNT] = {0}, *next[FP3_BANK_OBJECT_COUNT] = {0};
    const uint64_t doubled = fp3_fast_doubled(g->program);
    sweep s = {.self = self, .program = g->program, .phase = phase};
    for (int reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++) {
        if (!self->column[reg])
            continue;
        own[reg] = self->column[reg] + members->first;
        next[reg] =
            (doubled >> reg & 1 ? self->other_half[reg] : self->column[reg]) + members->first;
    }
    const size_t number = (size_t)(members - engine->layout.groups);
    s.group = (fp3_fast_group){.own = own,
                               .next = next,
                               .constants = &self->shared[number * engine->config->registers],
                               .lists = g->lists,
                               .records = g->records,
                               .objects = members->rows};
    fp3_status status = FP3_OK;
    if (g->pieces) {
        status = sweep_around_exchange(engine, members, g, &s);
    } else {
        gather(engine, s, g, 0, fp3_order_rows(members));
        s.from = members->from;
        s.count = end_of(members) - members->from;
        sweep_all(engine, &s);
    }
    FP3_EACH_REGISTER (doubled, reg) {
        uint32_t *half = self->column[reg];
        self->column[reg] = self->other_half[reg];
        self->other_half[reg] = half;
    }
    return status;
}

int fp3_around_is_any(const fp3_engine *engine) {
    for (uint32_t i = 0; i < engine->layout.count; i++)
        if (engine->layout.groups[i].lists.shape.is_any)
            return 1;
    return 0;
}

double fp3_around_turns(const fp3_engine *engine) {
    const fp3_members *members = &engine->layout.groups[0];
    const fp3_lists *lists = &members->lists;
    double turns = 1;
    for (uint32_t i = 0; i < lists->shape.list_count; i++) {
        const fp3_list *l = &lists->lists[i];
        const uint32_t rows = l->living ? l->living->count : l->own;
        const uint32_t end = l->is_near ? rows : l->own;
        turns += l->is_all          ? l->end - l->first
                 : l->begin && rows ? (double)l->begin[end] / rows
                                    : 0;
    }
    return turns;
}

/* A run that does not come to its end leaves objects as they were, as on the other engines. */
static fp3_status undo(fp3_engine *engine) {
    fast *self = engine->self;
    const fp3_origin *o = engine->origin;
    for (size_t reg = 0; reg < engine->config->registers; reg++)
        for (uint32_t i = 0; self->column[reg] && i < engine->objects; i++)
            if (o->began[i] >> reg & 1)
                self->column[reg][self->row ? self->row[i] : i] =
                    o->registers[reg * engine->objects + i];
    fp3_around_forget(&self->groups[0]);
    return fp3_origin_remember(engine, self->row, &engine->layout, engine->def.error);
}

/* A phase stores no words of objects that do not live: both halves have them. */
static void fill_halves(const fp3_engine *engine, const fp3_members *members, const group *g) {
    const fast *self = engine->self;
    const fp3_living *living = members->lists.living;
    FP3_EACH_REGISTER (fp3_fast_doubled(g->program), reg)
        for (uint32_t i = 0; living && i < members->rows; i++) {
            const uint32_t row = self->row ? self->row[i] : i;
            if (!living->is[i])
                self->other_half[reg][row] = self->column[reg][row];
        }
}

static fp3_status compare(fp3_engine *engine, const fp3_members *members, uint32_t phase) {
    uint32_t begin, end;
    if (!members->lists.shape.worst)
        return FP3_OK;
    fp3_neighbourhood_phase(&members->program, phase, &begin, &end);
    return fp3_engine_compare(engine, members, begin);
}

fp3_status fp3_around_run(fp3_engine *engine, uint32_t steps) {
    fast *self = engine->self;
    group *g = &self->groups[0];
    fp3_members *members = &engine->layout.groups[0];
    fp3_status status = need_halves(engine, g);
    if (!status)
        fill_halves(engine, members, g);
    for (uint32_t step = 0; !status && step < steps; step++) {
        const uint32_t end = engine->only ? engine->only : fp3_fast_made(g->program);
        for (uint32_t phase = engine->only ? end - 1 : 0; !status && phase < end; phase++) {
            status = compare(engine, members, phase);
            if (!status)
                status = fp3_engine_exchange_begin(engine);
            if (!status && !is_in_pieces(engine, members))
                status = fp3_engine_exchange_end(engine);
            if (!status)
                status = follow(engine, members, g);
            if (!status)
                status = make_phase(engine, members, g, fp3_fast_phase_at(g->program, phase));
        }
        fp3_engine_tell(engine, (uint64_t)(engine->expected * (step + 1) / steps));
    }
    const fp3_status undone = status && !engine->only ? undo(engine) : FP3_OK;
    return undone ? undone : status;
}
