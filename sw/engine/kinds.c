/* SPDX-License-Identifier: Apache-2.0 */
/* kinds.c - see kinds.h. */
#include "kinds.h"

#include "kinds_inside.h"

#include "gen/registers.h"

#include <stdlib.h>
#include <string.h>

const fp3_backend *fp3_kinds_backend(const fp3_kinds *kinds) { return &kinds->backend; }

void fp3_kinds_free(fp3_kinds **kinds) {
    fp3_kinds *self = *kinds;
    if (!self)
        return;
    for (uint32_t i = 0; i < FP3_JOINED_MAX; i++) {
        fp3_engine_close(&self->kinds[i].own);
        for (uint32_t k = 0; k < self->kinds[i].word_count; k++)
            free(self->kinds[i].words[k].last);
        free(self->kinds[i].words);
    }
    free(self->place);
    free(self->who);
    free(self->constants);
    free(self->held);
    free(self->words);
    free(self->stage);
    fp3_rest_close(&self->rest);
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
    const fp3_kinds *self = fp3_kinds_of(engine);
    uint32_t i = 0;
    while (i + 1 < self->count && !self->kinds[i].own)
        i++;
    return self->kinds[i].own ? fp3_engine_how(self->kinds[i].own) : "";
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
                            const fp3_foreign *f, fp3_foreign_word *found) {
    if (f->group >= layout->count || f->group == number)
        return no_word(engine, f, "other group");
    const fp3_symbol *word = fp3_image_find(layout->groups[number].image, f->word,
                                            FP3_CLASS(FP3_SYMBOL_PARAM)),
                     *of = fp3_image_find(layout->groups[f->group].image, f->of, FP3_CLASSES_HOST);
    if (!of)
        return no_word(engine, f, "state, param or shared constant");
    *found = (fp3_foreign_word){.reg = word ? word->index : 0,
                                .from = (uint32_t)f->group,
                                .of = of->index,
                                .is_shared = of->symbol_class == FP3_SYMBOL_SHARED};
    found->is_stored = !found->is_shared && may_store(&layout->groups[f->group], of->index);
    return word ? FP3_OK : no_word(engine, f, "param");
}

static fp3_status find_words(const fp3_engine *engine, const fp3_layout *layout, uint32_t number,
                             fp3_kind_engine *k) {
    const fp3_members *group = &layout->groups[number];
    fp3_status status = FP3_OK;
    k->words = calloc(group->foreign_count + 1u, sizeof *k->words);
    if (!k->words)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; !status && i < group->foreign_count; i++)
        status = find_word(engine, layout, number, &group->foreign[i], &k->words[k->word_count++]);
    k->phases = group->lists.shape.is_any ? group->lists.shape.phases : 1;
    return status;
}

/* Before a run, or a part of one. */
static fp3_status settle_stages(fp3_engine *engine) {
    const fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    if (!fp3_lives_vary(engine) && !self->held && !self->rest.is_any)
        return FP3_OK;
    uint8_t *stage = malloc(engine->objects + (size_t)1);
    if (!stage)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < engine->objects; i++)
        stage[i] = fp3_engine_life(engine, i) == FP3_ALIVE ? FP3_STAGE_AWAKE : FP3_STAGE_NONE;
    if (self->rest.is_any)
        status = fp3_rest_settle(engine, stage);
    if (!status && memcmp(stage, self->stage, engine->objects) != 0)
        status = fp3_kinds_form(engine, stage);
    free(stage);
    return status;
}

static fp3_status write_kinds(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_rest_note(engine, cells);
    return fp3_kinds_put(engine, cells, words);
}

static const fp3_backend divided_by_kind = {
    .close = close_kinds,
    .load = nothing,
    .read = fp3_kinds_read,
    .write = write_kinds,
    .connect = fp3_kinds_connect,
    .list = settle_stages,
    .run = fp3_kinds_run,
    .how = how_kinds,
};

const fp3_members *fp3_engine_members(const fp3_engine *engine, uint32_t group) {
    if (!fp3_layout_is_joined(&engine->layout))
        return &engine->layout.groups[group];
    const fp3_engine *own = fp3_kinds_of(engine)->kinds[group].own;
    return own ? &own->layout.groups[0] : NULL;
}

const fp3_backend *fp3_kinds_usual(const fp3_engine *engine) {
    return engine->backend->run == fp3_kinds_run ? fp3_kinds_of(engine)->usual : engine->backend;
}

/* ---- made ---- */
static int is_adaptive(const fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++)
        if (fp3_adaptive_is(layout->groups[i].image))
            return 1;
    return 0;
}

static int rests(const fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++)
        if (layout->groups[i].rest >= 0)
            return 1;
    return 0;
}

static int has_sleep(const fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++)
        if (layout->groups[i].program.slept >= 0)
            return 1;
    return 0;
}

static fp3_status check(const fp3_engine *engine, const fp3_backend *usual,
                        const fp3_layout *layout) {
    const fp3_engine_def *def = &engine->def;
    const int is_of_several = layout->count > 1;
    const char *what =
        def->trace          ? "a trace is told of one engine"
        : has_sleep(layout) ? "a program has `sleep`, as for steps that each object chooses"
        : def->bus_log      ? "a bus is logged of one engine"
        : def->native       ? "native code is taken by one engine"
        : def->cycle_limit  ? "a cycle limit is kept by one engine"
        : usual->is_divided ? is_of_several ? "several ranks have one kind of objects"
                                            : "several ranks would have to agree on who sleeps"
        : is_adaptive(layout) && rests(layout)
            ? "adaptive steps are those of all objects that see each other, and none is left out"
        : !engine->config->interleave ? "a configuration that interleaves is needed"
        : usual == &fp3_backend_board ? "a board is one engine"
                                      : NULL;
    return what ? fp3_fail(def->error, FP3_E_PROGRAM, "%s: %s",
                           is_of_several ? "groups that see each other"
                                         : "objects that fall asleep at rest",
                           what)
                : FP3_OK;
}

static int has_room(const fp3_engine *engine, uint32_t count, fp3_kinds *self) {
    const size_t objects = engine->objects, registers = engine->config->registers;
    self->place = malloc((objects + 1) * sizeof *self->place);
    self->who = malloc((objects + 1) * sizeof *self->who);
    self->words = malloc((objects + 1) * sizeof *self->words);
    self->stage = malloc(objects + 1);
    self->count = count;
    if (self->stage)
        memset(self->stage, FP3_STAGE_AWAKE, objects + 1);
    self->constants = calloc(count * registers, sizeof *self->constants);
    return self->place && self->who && self->words && self->constants && self->stage;
}

fp3_status fp3_kinds_make(fp3_engine *engine, const fp3_backend *usual, fp3_kinds_load_fn *load,
                          fp3_layout *layout, uint32_t *group, fp3_kinds **kinds) {
    fp3_status status = check(engine, usual, layout);
    *group = layout->count;
    if (!status)
        status = fp3_kinds_check_worst(engine, layout, group);
    fp3_kinds *self = *kinds = status ? NULL : calloc(1, sizeof *self);
    if (!self || !has_room(engine, layout->count, self)) {
        fp3_kinds_free(kinds);
        return status ? status : fp3_no_memory(engine->def.error);
    }
    self->backend = divided_by_kind;
    self->backend.is = usual->is;
    self->backend.is_in_host = usual->is_in_host;
    self->backend.is_uncounted = usual->is_uncounted;
    self->usual = usual;
    self->load = load;
    self->bus_before = engine->bus;
    for (*group = 0; !status && *group < layout->count; *group += !status)
        status = find_words(engine, layout, *group, &self->kinds[*group]);
    if (!status)
        status = fp3_rest_open(engine, layout, self);
    if (!status)
        fp3_kinds_place(self, layout);
    for (*group = 0; !status && *group < layout->count; *group += !status) {
        status = fp3_kinds_open_one(engine, self, layout, *group);
        if (!status)
            layout->groups[*group].log2 = self->kinds[*group].own->layout.groups[0].log2;
    }
    if (status)
        fp3_kinds_free(kinds);
    return status;
}
