/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_worst.c - words that all objects of all groups compare between two phases: those of one
 * name. */
#include "kinds_inside.h"

#include <inttypes.h>
#include <string.h>

/* What the group has stored in the phase before this one. */
static uint64_t stored_before(const fp3_members *group, uint32_t phase) {
    uint32_t begin, end;
    return group->lists.shape.worst && fp3_neighbourhood_phase(&group->program, phase, &begin, &end)
               ? fp3_neighbourhood_compared(&group->lists.shape, &group->program, begin)
               : 0;
}

static const char *name_of(const fp3_members *group, uint32_t reg) {
    const char *name = "";
    for (uint32_t i = 0; i < group->image->symbol_count; i++)
        if (group->image->symbols[i].symbol_class == FP3_SYMBOL_WORST &&
            group->image->symbols[i].index == reg)
            name = group->image->symbols[i].name;
    return name;
}

/* The register of the group's word of this name, if it is of the set. */
static int find(const fp3_members *group, uint64_t set, const char *name, uint32_t *reg) {
    const fp3_symbol *word =
        set ? fp3_image_find(group->image, name, FP3_CLASS(FP3_SYMBOL_WORST)) : NULL;
    *reg = word ? word->index : 0;
    return word && set >> word->index & 1;
}

/* ---- in a run ---- */

/* The words of one name, in the registers of these groups; UINT32_MAX: it has none. */
static fp3_status compare(fp3_engine *engine, const uint32_t reg[FP3_JOINED_MAX]) {
    fp3_kinds *self = fp3_kinds_of(engine);
    fp3_status status = FP3_OK;
    uint64_t worst = 0;
    for (uint32_t i = 0; !status && i < self->count; i++) {
        const fp3_cells cells = {FP3_CELLS_REGISTER, reg[i], 0, self->kinds[i].awake};
        if (reg[i] == UINT32_MAX || !cells.count)
            continue;
        status = self->kinds[i].own->backend->read(self->kinds[i].own, cells, self->words);
        for (uint32_t n = 0; !status && n < cells.count; n++) {
            const uint64_t key = fp3_worst_key(self->words[n]);
            worst = key > worst ? key : worst;
        }
    }
    for (uint32_t n = 0; n < engine->objects; n++)
        self->words[n] = (uint32_t)worst;
    for (uint32_t i = 0; !status && i < self->count; i++) {
        const fp3_cells cells = {FP3_CELLS_REGISTER, reg[i], 0, self->kinds[i].awake};
        if (reg[i] != UINT32_MAX && cells.count)
            status = self->kinds[i].own->backend->write(self->kinds[i].own, cells, self->words);
    }
    return status;
}

fp3_status fp3_kinds_compare(fp3_engine *engine, uint32_t phase) {
    const fp3_layout *layout = &engine->layout;
    uint64_t set[FP3_JOINED_MAX];
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < layout->count; i++)
        set[i] = stored_before(&layout->groups[i], phase);
    for (uint32_t i = 0; !status && i < layout->count; i++)
        while (!status && set[i]) {
            uint32_t regs[FP3_JOINED_MAX], reg;
            const char *name = name_of(&layout->groups[i], (uint32_t)__builtin_ctzll(set[i]));
            for (uint32_t k = 0; k < layout->count; k++) {
                const int has = find(&layout->groups[k], set[k], name, &reg);
                regs[k] = has ? reg : UINT32_MAX;
                set[k] &= has ? ~(UINT64_C(1) << reg) : UINT64_MAX;
            }
            status = compare(engine, regs);
        }
    return status;
}

/* ---- before ---- */

static int takes_part(const fp3_members *group) {
    return group->lists.shape.worst || fp3_adaptive_is(group->image);
}

/* Whether another group has what one of them stores in the phase before this. */
static fp3_status check(const fp3_engine *engine, const fp3_layout *layout, uint32_t number,
                        uint32_t other, uint32_t phase) {
    const fp3_members *group = &layout->groups[number];
    uint64_t set = stored_before(group, phase);
    const uint64_t theirs = stored_before(&layout->groups[other], phase);
    for (uint32_t reg; set; set &= set - 1) {
        const char *name = name_of(group, (uint32_t)__builtin_ctzll(set));
        if (!find(&layout->groups[other], theirs, name, &reg))
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "phase %" PRIu32 " stores the .worst '%s', and that of group %" PRIu32
                            " does not: objects of all groups compare it",
                            phase - 1, name, other);
    }
    return FP3_OK;
}

fp3_status fp3_kinds_check_worst(const fp3_engine *engine, const fp3_layout *layout,
                                 uint32_t *group) {
    fp3_status status = FP3_OK;
    for (*group = 0; !status && *group < layout->count; *group += !status) {
        const fp3_members *g = &layout->groups[*group];
        for (uint32_t other = 0; !status && other < layout->count; other++)
            for (uint32_t phase = 1; !status && takes_part(g) && phase < g->lists.shape.phases &&
                                     takes_part(&layout->groups[other]);
                 phase++)
                status = check(engine, layout, *group, other, phase);
    }
    return status;
}
