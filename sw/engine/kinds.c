/* SPDX-License-Identifier: Apache-2.0 */
/* kinds.c - see kinds.h. */
#include "kinds.h"

#include "engine/common/cells.h"
#include "engine/common/origin.h"
#include "gen/registers.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define NO_ROW UINT32_MAX

/* A word of guests. */
typedef struct {
    uint32_t reg;   /* of the engine that has the guests */
    uint32_t from;  /* the group that they are of */
    uint32_t of;    /* its register, or shared constant */
    int is_shared;  /* ... a constant */
    int is_stored;  /* a step of that group may change it */
    int is_brought; /* guests have it, and it has not changed since */
} foreign;

typedef struct {
    fp3_engine *own;
    uint32_t base[FP3_KINDS_MAX]; /* of each group: the row of its first object here, or NO_ROW */
    foreign *words;
    uint32_t word_count;
    uint32_t rows, phases;
    struct teller {
        const fp3_engine *engine;
        uint32_t first;
    } teller;
} kind;

struct fp3_kinds {
    fp3_backend backend;
    const fp3_backend *usual;
    kind kinds[FP3_KINDS_MAX];
    uint32_t count;
    uint32_t *words; /* of one register of any group */
};

static fp3_kinds *kinds_of(const fp3_engine *engine) { return engine->self; }

const fp3_backend *fp3_kinds_backend(const fp3_kinds *kinds) { return &kinds->backend; }

/* ---- what objects hold: by group ---- */

typedef fp3_status access_fn(fp3_engine *own, fp3_cells cells, void *words);

static fp3_status read_own(fp3_engine *own, fp3_cells cells, void *words) {
    return own->backend->read(own, cells, words);
}

static fp3_status write_own(fp3_engine *own, fp3_cells cells, void *words) {
    return fp3_cells_write(own, cells, words);
}

static fp3_status access_cells(fp3_engine *engine, fp3_cells cells, void *words,
                               access_fn *access) {
    const fp3_kinds *self = kinds_of(engine);
    fp3_status status = FP3_OK;
    if (cells.kind == FP3_CELLS_CONSTANT) {
        fp3_engine *own = self->kinds[cells.number].own;
        cells.number = 0;
        return access(own, cells, words);
    }
    for (uint32_t i = 0; !status && i < self->count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        fp3_cells here = fp3_cells_of(group, cells.number, cells.first, cells.count);
        char *at = (char *)words + (here.first - cells.first) * sizeof(uint32_t);
        here.kind = cells.kind;
        here.first -= group->first;
        if (here.count)
            status = access(self->kinds[i].own, here, at);
    }
    return status;
}

static fp3_status read_kinds(fp3_engine *engine, fp3_cells cells, void *words) {
    return access_cells(engine, cells, words, read_own);
}

/* What the caller writes, guests get in the next run. */
static fp3_status write_kinds(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_kinds *self = kinds_of(engine);
    for (uint32_t i = 0; i < self->count; i++)
        for (uint32_t k = 0; k < self->kinds[i].word_count; k++)
            self->kinds[i].words[k].is_brought = 0;
    return access_cells(engine, cells, (void *)(uintptr_t)words, write_own);
}

/* ---- lists ---- */

/* Rows among which neighbours are. */
static void limit(const fp3_engine *engine, const kind *k, uint32_t number, fp3_list *own) {
    const uint32_t other = own->kind ? own->kind - 1 : number;
    own->first = own->kind ? k->base[other] : 0;
    own->end = own->first + engine->layout.groups[other].objects;
    own->own = engine->layout.groups[number].objects;
}

/* Links to objects of a group become links to rows; guests have none. */
static fp3_status give_entries(fp3_engine *engine, const fp3_list *list, fp3_list *own) {
    const uint32_t objects = list->objects, entries = list->begin[objects];
    uint32_t *begin = malloc((own->objects + (size_t)1) * sizeof *begin),
             *other = malloc((entries + (size_t)1) * sizeof *other);
    fp3_status status = begin && other ? FP3_OK : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i <= own->objects; i++)
        begin[i] = list->begin[i < objects ? i : objects];
    for (uint32_t e = 0; !status && e < entries; e++)
        other[e] = list->other[e] + own->first;
    const fp3_neighbours given = {.begin = begin,
                                  .other = other,
                                  .fields = (const float *)(const void *)list->field,
                                  .kind = list->kind};
    if (!status)
        status = fp3_list_take(own, &given, engine->def.error);
    free(begin);
    free(other);
    return status;
}

/* The row of each object of a kind's engine; NULL: its number. */
static const uint32_t *rows_of(const fp3_engine *own) {
    return own->backend->rows ? own->backend->rows(own) : NULL;
}

/* What pairs of near objects remember, to the engine of their kind. */
static fp3_status give_memory(fp3_engine *engine, const kind *k, const fp3_list *list,
                              fp3_list *own) {
    const uint32_t entries = list->begin ? list->begin[list->own] : 0;
    if (!list->begin)
        return FP3_OK;
    fp3_remembered saved = {.begin = list->begin,
                            .other = malloc((entries + (size_t)1) * sizeof *saved.other),
                            .field = list->field};
    if (!saved.other)
        return fp3_no_memory(engine->def.error);
    for (uint32_t e = 0; e < entries; e++)
        saved.other[e] = list->other[e] + own->first;
    const fp3_status status = fp3_list_restore(own, rows_of(k->own), k->own->layout.groups[0].rows,
                                               &saved, engine->def.error);
    free(saved.other);
    return status;
}

/* ... and back, to the lists that the caller's engine has: to be found, and kept. */
static fp3_status take_memory(fp3_engine *engine, const kind *k, fp3_list *list, fp3_list *own) {
    const uint32_t rows = k->own->layout.groups[0].rows;
    fp3_remembered saved;
    const fp3_status status = fp3_list_save(own, rows_of(k->own), rows, &saved, engine->def.error);
    if (status) {
        fp3_remembered_free(&saved);
        return status;
    }
    if (!list->is_near) {
        memcpy(list->field, saved.field,
               (size_t)list->begin[list->own] * list->fields * sizeof *list->field);
        fp3_remembered_free(&saved);
        return FP3_OK;
    }
    for (uint32_t e = 0; e < saved.begin[list->own]; e++)
        saved.other[e] -= own->first;
    free(list->begin);
    free(list->other);
    free(list->field);
    list->begin = saved.begin;
    list->other = saved.other;
    list->field = saved.field;
    return FP3_OK;
}

static fp3_status take_memories(fp3_engine *engine) {
    const fp3_kinds *self = kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        fp3_lists *lists = &engine->layout.groups[i].lists;
        for (uint32_t n = 0; !status && n < lists->shape.list_count; n++)
            if (fp3_list_remembers(&lists->lists[n]))
                status = take_memory(engine, &self->kinds[i], &lists->lists[n],
                                     &self->kinds[i].own->layout.groups[0].lists.lists[n]);
    }
    return status;
}

static fp3_status give_list(fp3_engine *engine, uint32_t number, const fp3_list *list) {
    const fp3_members *group = &engine->layout.groups[number];
    const kind *k = &kinds_of(engine)->kinds[number];
    fp3_members *members = &k->own->layout.groups[0];
    fp3_list *own = &members->lists.lists[list - group->lists.lists];
    fp3_status status = FP3_OK;
    own->kind = list->kind;
    limit(engine, k, number, own);
    if (list->is_near) {
        fp3_list_take_near(own, &list->near);
        own->kind = list->kind;
        if (fp3_list_remembers(list))
            status = give_memory(engine, k, list, own);
    } else if (list->is_all)
        status = fp3_list_take(own, &(fp3_neighbours){.kind = list->kind}, engine->def.error);
    else if (list->is_there)
        status = give_entries(engine, list, own);
    if (!status && k->own->backend->connect)
        status = k->own->backend->connect(k->own, members, own);
    return status;
}

static fp3_status connect_kinds(fp3_engine *engine, fp3_members *group, const fp3_list *list) {
    const uint32_t number = (uint32_t)(group - engine->layout.groups);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++)
        if (!list || list == &group->lists.lists[i])
            status = give_list(engine, number, &group->lists.lists[i]);
    return status;
}

/* ---- a run ---- */

/* The objects of a group, as they are now, become guests of this kind. */
static fp3_status bring(fp3_engine *engine, kind *k, foreign *f) {
    fp3_kinds *self = kinds_of(engine);
    const uint32_t count = engine->layout.groups[f->from].objects;
    fp3_engine *from = self->kinds[f->from].own;
    const fp3_cells theirs = {f->is_shared ? FP3_CELLS_CONSTANT : FP3_CELLS_REGISTER,
                              f->is_shared ? 0 : f->of, f->is_shared ? f->of : 0,
                              f->is_shared ? 1 : count},
                    here = {FP3_CELLS_REGISTER, f->reg, k->base[f->from], count};
    fp3_status status = from->backend->read(from, theirs, self->words);
    for (uint32_t i = 1; f->is_shared && i < count; i++)
        self->words[i] = self->words[0];
    if (!status)
        status = k->own->backend->write(k->own, here, self->words);
    f->is_brought = !status && !f->is_stored;
    return status;
}

static fp3_status bring_all(fp3_engine *engine, uint32_t phase) {
    fp3_kinds *self = kinds_of(engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        kind *k = &self->kinds[i];
        for (uint32_t w = 0; !status && phase < k->phases && w < k->word_count; w++)
            if (!k->words[w].is_brought)
                status = bring(engine, k, &k->words[w]);
    }
    return status;
}

/* As if one machine took the kinds in turn. */
static void add_counters(const fp3_engine *engine, const fp3_engine *own) {
    for (uint32_t s = 0; s < fp3_config_schedulers(engine->config); s++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            engine->counters[s][i] += own->counters[s][i];
}

static fp3_status make_round(fp3_engine *engine, uint32_t phase, fp3_stats *stats) {
    fp3_kinds *self = kinds_of(engine);
    fp3_status status = bring_all(engine, phase);
    for (uint32_t i = 0; !status && i < self->count; i++) {
        kind *k = &self->kinds[i];
        if (phase >= k->phases)
            continue;
        status = fp3_engine_make_phase(k->own, phase, stats);
        if (!engine->backend->is_uncounted)
            add_counters(engine, k->own);
    }
    return status;
}

static fp3_status make_step(fp3_engine *engine, uint32_t clock, fp3_stats *stats) {
    fp3_kinds *self = kinds_of(engine);
    uint32_t phases = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < self->count; i++) {
        self->kinds[i].own->clock = clock;
        phases = self->kinds[i].phases > phases ? self->kinds[i].phases : phases;
    }
    for (uint32_t phase = 0; !status && phase < phases; phase++)
        status = make_round(engine, phase, stats);
    return status;
}

/* A run that does not come to its end leaves all objects as they were. */
static fp3_status undo(fp3_engine *engine) {
    const fp3_origin *o = engine->origin;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t reg = 0; !status && reg < 1u << group->log2; reg++)
            if (o->began[group->first] >> reg & 1)
                status = write_kinds(
                    engine, (fp3_cells){FP3_CELLS_REGISTER, reg, group->first, group->objects},
                    &o->registers[(size_t)reg * engine->objects + group->first]);
    }
    if (!status)
        status = fp3_origin_remember(engine, NULL, &engine->layout, engine->def.error);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = connect_kinds(engine, &engine->layout.groups[i], NULL);
    return status;
}

/* Engines of the kinds note what their objects raise, by rows of their own. */
static void watch(fp3_engine *engine, int is_on) {
    fp3_kinds *self = kinds_of(engine);
    for (uint32_t i = 0; engine->watched && i < self->count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        fp3_members *own = &self->kinds[i].own->layout.groups[0];
        self->kinds[i].own->watched = is_on ? engine->watched + group->first : NULL;
        self->kinds[i].own->began = engine->began;
        own->is_ahead = is_on ? group->is_ahead : NULL; /* of the same words */
        own->live = group->live;
    }
}

/* 1 + a row of a kind's engine becomes 1 + the number of the object there. */
static uint32_t number_of(const fp3_engine *engine, const kind *k, uint32_t own, uint32_t partner) {
    const fp3_layout *layout = &engine->layout;
    if (!partner || partner <= layout->groups[own].objects)
        return partner ? partner + layout->groups[own].first : 0;
    for (uint32_t i = 0; i < layout->count; i++)
        if (k->base[i] != NO_ROW && partner > k->base[i] &&
            partner - k->base[i] <= layout->groups[i].objects)
            return partner - k->base[i] + layout->groups[i].first;
    return 0;
}

static void number_partners(fp3_engine *engine) {
    const fp3_kinds *self = kinds_of(engine);
    for (uint32_t i = 0; engine->watched && i < self->count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t n = group->first; n < group->first + group->objects; n++)
            engine->watched[n].partner =
                number_of(engine, &self->kinds[i], i, engine->watched[n].partner);
    }
}

static fp3_status run_kinds(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_status status = FP3_OK;
    watch(engine, 1);
    for (uint32_t step = 0; !status && step < steps; step++) {
        status = make_step(engine, engine->clock + step, stats);
        fp3_engine_tell(engine, (uint64_t)(engine->expected * (step + 1) / steps));
    }
    watch(engine, 0);
    number_partners(engine);
    if (!status)
        status = take_memories(engine);
    stats->schedulers = 1;
    if (!status)
        return FP3_OK;
    const fp3_error why = engine->def.error ? *engine->def.error : (fp3_error){.text = ""};
    const fp3_status undone = undo(engine);
    if (!undone && engine->def.error)
        *engine->def.error = why;
    return undone ? undone : status;
}

/* ---- made and closed ---- */

void fp3_kinds_free(fp3_kinds **kinds) {
    fp3_kinds *self = *kinds;
    if (!self)
        return;
    for (uint32_t i = 0; i < FP3_KINDS_MAX; i++) {
        fp3_engine_close(&self->kinds[i].own);
        free(self->kinds[i].words);
    }
    free(self->words);
    free(self);
    *kinds = NULL;
}

static void close_kinds(fp3_engine *engine) {
    fp3_kinds *self = engine->self;
    fp3_kinds_free(&self);
}

static fp3_status nothing(fp3_engine *engine) {
    (void)engine;
    return FP3_OK;
}

static const char *how_kinds(const fp3_engine *engine) {
    return fp3_engine_how(kinds_of(engine)->kinds[0].own);
}

static const fp3_backend divided_by_kind = {
    .close = close_kinds,
    .load = nothing,
    .read = read_kinds,
    .write = write_kinds,
    .connect = connect_kinds,
    .list = nothing,
    .run = run_kinds,
    .how = how_kinds,
};

const fp3_backend *fp3_kinds_usual(const fp3_engine *engine) {
    return engine->backend->run == run_kinds ? kinds_of(engine)->usual : engine->backend;
}

/* Objects are told by their numbers in all groups. */
static void tell_retirement(void *user, const fp3_retirement *retirement) {
    const struct teller *t = user;
    fp3_retirement told = *retirement;
    told.object += t->first;
    t->engine->def.retire(t->engine->def.retire_user, &told);
}

static int may_store(const fp3_members *group, uint32_t reg) {
    const uint64_t stored = group->visit ? group->visit->stored : UINT64_MAX;
    return (int)(stored >> reg & 1);
}

static fp3_status no_word(const fp3_engine *engine, const fp3_foreign *f, const char *name) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "foreign word '%s' of group %zu's '%s': there is no such %s", f->word, f->group,
                    f->of, name);
}

static fp3_status find_word(const fp3_engine *engine, const fp3_layout *layout, uint32_t number,
                            const fp3_foreign *f, foreign *found) {
    if (f->group >= layout->count || f->group == number)
        return no_word(engine, f, "other group");
    const fp3_symbol *word = fp3_image_find(layout->groups[number].image, f->word,
                                            FP3_CLASS(FP3_SYMBOL_PARAM)),
                     *of = fp3_image_find(layout->groups[f->group].image, f->of, FP3_CLASSES_HOST);
    if (!of)
        return no_word(engine, f, "state, param or shared constant");
    *found = (foreign){.reg = word ? word->index : 0,
                       .from = (uint32_t)f->group,
                       .of = of->index,
                       .is_shared = of->symbol_class == FP3_SYMBOL_SHARED};
    found->is_stored = !found->is_shared && may_store(&layout->groups[f->group], of->index);
    return word ? FP3_OK : no_word(engine, f, "param");
}

/* Where guests stand: group by group, behind the own objects. */
static fp3_status find_words(const fp3_engine *engine, const fp3_layout *layout, uint32_t number,
                             kind *k) {
    const fp3_members *group = &layout->groups[number];
    fp3_status status = FP3_OK;
    k->words = calloc(group->foreign_count + 1u, sizeof *k->words);
    if (!k->words)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < FP3_KINDS_MAX; i++)
        k->base[i] = NO_ROW;
    k->rows = group->objects;
    for (uint32_t i = 0; !status && i < group->foreign_count; i++) {
        foreign *f = &k->words[k->word_count++];
        status = find_word(engine, layout, number, &group->foreign[i], f);
        if (status || k->base[f->from] != NO_ROW)
            continue;
        k->base[f->from] = k->rows;
        k->rows += layout->groups[f->from].objects;
    }
    k->phases = group->lists.shape.is_any ? group->lists.shape.phases : 1;
    return status;
}

fp3_status fp3_kinds_open(fp3_engine *engine, fp3_kinds *kinds, const fp3_layout *layout,
                          uint32_t group, fp3_engine **own) {
    kind *k = &kinds->kinds[group];
    fp3_engine_def def = engine->def;
    k->teller = (struct teller){engine, layout->groups[group].first};
    def.objects = k->rows;
    def.visit = 0;
    def.progress = NULL;
    def.retire = def.retire ? tell_retirement : NULL;
    def.retire_user = &k->teller;
    const fp3_status status = fp3_engine_open_on(&def, engine->config, kinds->usual, NULL, &k->own);
    *own = k->own;
    return status;
}

void fp3_kinds_loaded(fp3_kinds *kinds, fp3_layout *layout, uint32_t group) {
    fp3_engine *own = kinds->kinds[group].own;
    fp3_engine_use(own, 0, layout->groups[group].objects);
    layout->groups[group].log2 = own->layout.groups[0].log2;
}

static fp3_status check(const fp3_engine *engine, const fp3_backend *usual) {
    const fp3_engine_def *def = &engine->def;
    const char *what = def->trace                    ? "a trace is told of one program"
                       : def->bus_log                ? "a bus is logged of one program"
                       : def->native                 ? "native code is taken for one program"
                       : def->cycle_limit            ? "a cycle limit is kept by one program"
                       : usual->is_divided           ? "several ranks have one kind of objects"
                       : !engine->config->interleave ? "a configuration that interleaves is needed"
                       : usual == &fp3_backend_board ? "a board has one program"
                                                     : NULL;
    return what ? fp3_fail(def->error, FP3_E_PROGRAM, "groups that see each other: %s", what)
                : FP3_OK;
}

fp3_status fp3_kinds_make(fp3_engine *engine, const fp3_backend *usual, const fp3_layout *layout,
                          fp3_kinds **kinds) {
    fp3_status status = check(engine, usual);
    fp3_kinds *self = *kinds = status ? NULL : calloc(1, sizeof *self);
    if (!self)
        return status ? status : fp3_no_memory(engine->def.error);
    self->backend = divided_by_kind;
    self->backend.is = usual->is;
    self->backend.is_in_host = usual->is_in_host;
    self->backend.is_uncounted = usual->is_uncounted;
    self->usual = usual;
    self->count = layout->count;
    self->words = malloc((engine->objects + (size_t)1) * sizeof *self->words);
    status = self->words ? FP3_OK : fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i < layout->count; i++)
        status = find_words(engine, layout, i, &self->kinds[i]);
    if (status)
        fp3_kinds_free(kinds);
    return status;
}
