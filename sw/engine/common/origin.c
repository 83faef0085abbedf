/* SPDX-License-Identifier: Apache-2.0 */
/* origin.c - see origin.h. */
#include "origin.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

static void forget_remembered(fp3_origin *o) {
    for (uint32_t i = 0; i < o->groups; i++)
        for (uint32_t k = 0; k < FP3_LISTS_MAX; k++)
            fp3_remembered_free(&o->remembered[i][k]);
    free(o->remembered);
    free(o->rows);
    o->remembered = NULL;
    o->rows = NULL;
    o->groups = 0;
}

static void forget_copies(fp3_origin *o) {
    forget_remembered(o);
    free(o->registers);
    free(o->constants);
    free(o->known);
    free(o->began);
    *o = (fp3_origin){0};
}

static fp3_status make_copies(fp3_engine *engine) {
    const size_t registers = engine->config->registers;
    fp3_origin *o = engine->origin;
    *o = (fp3_origin){.registers = calloc(engine->objects * registers, sizeof *o->registers),
                      .constants =
                          calloc(fp3_layout_room(engine->config) * registers, sizeof *o->constants),
                      .known = malloc(engine->objects * sizeof *o->known),
                      .began = calloc(engine->objects, sizeof *o->began),
                      .has_constants = 1};
    if (!o->registers || !o->constants || !o->known || !o->began)
        return fp3_no_memory(engine->def.error);
    memset(o->known, 0xff, engine->objects * sizeof *o->known);
    return FP3_OK;
}

fp3_status fp3_origin_open(fp3_engine *engine) {
    engine->origin = calloc(1, sizeof *engine->origin);
    if (!engine->origin)
        return fp3_no_memory(engine->def.error);
    return engine->backend->failures ? FP3_OK : make_copies(engine);
}

void fp3_origin_close(fp3_engine *engine) {
    fp3_origin *o = engine->origin;
    if (!o)
        return;
    forget_copies(o);
    free(o);
    engine->origin = NULL;
}

/* ---- the host ---- */

static uint32_t *find(const fp3_engine *engine, fp3_cells cells) {
    const fp3_origin *o = engine->origin;
    return cells.kind == FP3_CELLS_CONSTANT
               ? &o->constants[(size_t)cells.number * engine->config->registers + cells.first]
               : &o->registers[(size_t)cells.number * engine->objects + cells.first];
}

void fp3_origin_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_origin *o = engine->origin;
    if (cells.kind == FP3_CELLS_STATUS)
        return;
    o->is_complete = 0;
    if (!o->registers)
        return;
    memcpy(find(engine, cells), words, cells.count * sizeof(uint32_t));
    for (size_t i = 0; cells.kind == FP3_CELLS_REGISTER && i < cells.count; i++)
        o->known[cells.first + i] |= (uint64_t)1 << cells.number;
}

/* Of objects that see each other no engine knows who failed. */
static int needs_copies(const fp3_engine *engine) {
    int is_any = !engine->backend->failures;
    if (engine->backend->is_divided)
        return 0;
    for (uint32_t i = 0; i < engine->layout.count; i++)
        is_any |= engine->layout.groups[i].lists.shape.is_any;
    return is_any;
}

fp3_status fp3_origin_load(fp3_engine *engine, int is_moved) {
    fp3_origin *o = engine->origin;
    const int has = o->registers != NULL;
    fp3_status status = FP3_OK;
    o->is_complete = 0;
    if (has && !needs_copies(engine))
        forget_copies(o);
    else if (!has && needs_copies(engine))
        status = make_copies(engine);
    if (status || (has && !is_moved) || !o->registers)
        return status;
    o->has_constants = 0;
    memset(o->known, 0, engine->objects * sizeof *o->known);
    return FP3_OK;
}

/* ---- a run ---- */

/* The registers that these operations name in a group's program; all, where there is no store. */
static uint64_t named_by(const fp3_engine *engine, const fp3_members *group, uint32_t op,
                         uint32_t other) {
    uint64_t set = 0;
    for (uint32_t i = 0; i < group->program.count; i++) {
        const fp3_decoded *word = &group->program.decoded[i];
        if (word->of && (word->in.op == op || word->in.op == other))
            set |= (uint64_t)1 << word->in.d;
    }
    return engine->config->interleave ? set : UINT64_MAX;
}

/* From object `from` on: the first whose register is known, or is not. */
static size_t next(const fp3_origin *o, uint32_t reg, int is_known, size_t from, size_t end) {
    while (from < end && (int)(o->known[from] >> reg & 1) != is_known)
        from++;
    return from;
}

/* Of those objects of which it is not known. */
static fp3_status read_register(fp3_engine *engine, const fp3_members *group, uint32_t reg) {
    const fp3_origin *o = engine->origin;
    const size_t end = fp3_members_end(group);
    fp3_cells cells = {FP3_CELLS_REGISTER, reg, next(o, reg, 0, fp3_members_begin(group), end), 0};
    fp3_status status = FP3_OK;
    while (!status && cells.first < end) {
        const size_t known = next(o, reg, 1, cells.first, end);
        cells.count = known - cells.first;
        status = engine->backend->read(engine, cells, find(engine, cells));
        for (size_t i = cells.first; !status && i < known; i++)
            o->known[i] |= (uint64_t)1 << reg;
        cells.first = next(o, reg, 0, known, end);
    }
    return status;
}

/* Most registers are known of all objects of a group or of none: only the others are looked at
 * object by object. */
static fp3_status read_group(fp3_engine *engine, const fp3_members *group, uint64_t wanted) {
    const fp3_origin *o = engine->origin;
    const size_t begin = fp3_members_begin(group), end = fp3_members_end(group);
    uint64_t of_all = UINT64_MAX, of_any = 0;
    for (size_t i = begin; i < end; i++) {
        of_all &= o->known[i];
        of_any |= o->known[i];
    }
    const uint64_t whole = wanted & ~of_any;
    fp3_status status = FP3_OK;
    for (uint64_t left = wanted & ~of_all; !status && left; left &= left - 1) {
        const uint32_t reg = (uint32_t)__builtin_ctzll(left);
        const fp3_cells cells = {FP3_CELLS_REGISTER, reg, begin, end - begin};
        status = whole >> reg & 1 ? engine->backend->read(engine, cells, find(engine, cells))
                                  : read_register(engine, group, reg);
    }
    for (size_t i = begin; !status && whole && i < end; i++)
        o->known[i] |= whole;
    return status;
}

static uint64_t below(uint32_t count) {
    return count < 64 ? ((uint64_t)1 << count) - 1 : UINT64_MAX;
}

static fp3_status read_all(fp3_engine *engine) {
    fp3_origin *o = engine->origin;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const int slept = group->program.slept;
        /* A state that is only stored may be left as it is; so may what says that an object sleeps.
         */
        const uint64_t wanted = named_by(engine, group, FP3_OP_LD, FP3_OP_LDS) |
                                fp3_engine_states_of(group) |
                                (slept < 0 ? 0 : (uint64_t)1 << slept);
        const uint32_t room = 1u << group->log2, has = engine->config->registers;
        const fp3_cells constants = {FP3_CELLS_CONSTANT, i, 0, has};
        status = read_group(engine, group, wanted & below(room < has ? room : has));
        if (!status && !o->has_constants)
            status = engine->backend->read(engine, constants, find(engine, constants));
    }
    memcpy(o->began, o->known, engine->objects * sizeof *o->began);
    o->has_constants |= !status;
    return status;
}

/* What entries remember. */
static fp3_status save_remembered(fp3_engine *engine) {
    const fp3_layout *layout = &engine->layout;
    const uint32_t *row = engine->backend->rows ? engine->backend->rows(engine) : NULL;
    fp3_origin *o = engine->origin;
    fp3_status status = FP3_OK;
    int is_any = 0;
    forget_remembered(o);
    for (uint32_t i = 0; i < layout->count; i++)
        is_any |= fp3_lists_remember(&layout->groups[i].lists);
    if (!is_any)
        return FP3_OK;
    o->remembered = calloc(layout->count, sizeof *o->remembered);
    o->rows = calloc(layout->count, sizeof *o->rows);
    if (!o->remembered || !o->rows)
        return fp3_no_memory(engine->def.error);
    o->groups = layout->count;
    for (uint32_t i = 0; i < layout->count; i++) {
        const fp3_members *group = &layout->groups[i];
        o->rows[i] = group->rows;
        for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++)
            if (fp3_list_remembers(&group->lists.lists[k]))
                status = fp3_list_save(&group->lists.lists[k], row, group->rows,
                                       &o->remembered[i][k], engine->def.error);
    }
    return status;
}

fp3_status fp3_origin_remember(const fp3_engine *engine, const uint32_t *row, fp3_layout *layout,
                               fp3_error *error) {
    const fp3_origin *o = engine->origin;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < o->groups; i++) {
        fp3_members *group = &layout->groups[i];
        group->rows = o->rows[i];
        for (uint32_t k = 0; !status && k < group->lists.shape.list_count; k++)
            if (fp3_list_remembers(&group->lists.lists[k]))
                status = fp3_list_restore(&group->lists.lists[k], row, group->rows,
                                          &o->remembered[i][k], error);
    }
    return status;
}

fp3_status fp3_origin_begin(fp3_engine *engine, uint32_t steps) {
    fp3_origin *o = engine->origin;
    fp3_status status = o->registers ? read_all(engine) : FP3_OK;
    if (!status && o->registers)
        status = save_remembered(engine);
    o->clock = engine->clock;
    o->made = engine->made;
    o->visit = engine->def.visit;
    o->seed = engine->def.seed;
    o->steps = steps;
    o->is_complete = 0;
    return status;
}

void fp3_origin_end(fp3_engine *engine, int is_complete, uint32_t flags) {
    fp3_origin *o = engine->origin;
    for (uint32_t i = 0; o->known && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (is_complete && !group->steps && group->lists.shape.is_any)
            continue; /* all were asleep: such a program has no part but its step */
        const uint64_t changed = named_by(engine, group, FP3_OP_ST, FP3_OP_ST);
        for (uint32_t n = fp3_members_begin(group); n < fp3_members_end(group); n++)
            o->known[n] &= ~changed;
    }
    o->flags = flags;
    o->is_complete = is_complete;
}
