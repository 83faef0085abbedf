/* SPDX-License-Identifier: Apache-2.0 */
/* kinds.c - programs of groups that see each other: what each reads of the others, and the phases
 * of all of them. */
#include <fp3/program.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "base/nearest.h"
#include "compiler/start.h"
#include "compiler/step/adapt.h"
#include "kinds_steps.h"
#include "language/unit.h"
#include "relations.h"

#define NONE SIZE_MAX

static const fp3_model *model_of(const fp3_joined *g) { return g->program->model; }

/* Whether a relation sees objects of it. */
static int is_used(const fp3_model *m, uint32_t kind) {
    for (uint32_t i = 0; i < m->relation_count; i++)
        if (m->relations[i].of_kind == kind)
            return 1;
    return 0;
}

/* ---- which group a kind is ---- */

static fp3_status find_group(const fp3_joined *list, size_t count, size_t of, const fp3_kind *kind,
                             size_t *group, fp3_error *error) {
    const fp3_joined *g = &list[of];
    const fp3_token wanted = {.text = kind->name, .length = strlen(kind->name)};
    const char *near = NULL;
    *group = NONE;
    for (size_t i = 0; i < count; i++) {
        if (!list[i].name) /* no model, and none given */
            continue;
        if (i != of)
            fp3_nearest(wanted, list[i].name, &near);
        if (strcmp(list[i].name, kind->name) != 0)
            continue;
        if (i == of)
            return fp3_kinds_refuse(
                g, kind->line, error,
                "kind '%s' is this group itself, which relations without a kind see", kind->name);
        if (*group != NONE)
            return fp3_kinds_refuse(g, kind->line, error, "there are two groups '%s'", kind->name);
        *group = i;
    }
    if (*group == NONE)
        return fp3_kinds_refuse(g, kind->line, error, "there is no group '%s'%s%s%s", kind->name,
                                near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    if (!model_of(&list[*group]))
        return fp3_kinds_refuse(
            g, kind->line, error,
            "group '%s' is no model, and only of a model it is known what its words are",
            kind->name);
    return FP3_OK;
}

/* ---- its words ---- */

static const char *word_of(const fp3_model *m, const fp3_kind *kind, uint32_t param) {
    return m->params[param].name + strlen(kind->name) + 1;
}

/* The state or param of this name; NULL: there is none. */
static const fp3_quantity *quantity(const fp3_model *m, const char *name) {
    const uint32_t state = fp3_model_state(m, name), param = fp3_model_param(m, name);
    return state != FP3_NONE                                      ? &m->states[state]
           : param != FP3_NONE && !fp3_model_is_foreign(m, param) ? &m->params[param]
                                                                  : NULL;
}

static void component(char *text, const char *word, size_t base, unsigned number) {
    if (word[base + 1] == '1')
        snprintf(text, FP3_NAME_SIZE, "%.*s_%u", (int)base, word, number + 1);
    else
        snprintf(text, FP3_NAME_SIZE, "%.*s_%c", (int)base, word, 'x' + (int)number);
}

/* Where a word is the first component of a vector: how many it has, and how many it has there. */
static int has_other_size(const fp3_model *m, const fp3_kind *kind, uint32_t param,
                          const fp3_model *other) {
    const char *word = word_of(m, kind, param), *end = strrchr(word, '_');
    char text[FP3_NAME_SIZE];
    unsigned own = 1, theirs = 1;
    if (!end || end == word || (strcmp(end, "_x") != 0 && strcmp(end, "_1") != 0))
        return 0;
    const size_t base = (size_t)(end - word);
    for (component(text, word, base, own); param + own < kind->first + kind->count &&
                                           strcmp(word_of(m, kind, param + own), text) == 0;
         component(text, word, base, ++own))
        ;
    for (component(text, word, base, theirs); quantity(other, text);
         component(text, word, base, ++theirs))
        ;
    return own > 1 && own != theirs;
}

static fp3_status no_word(const fp3_joined *g, uint32_t line, const fp3_joined *other,
                          const char *word, fp3_error *error) {
    const fp3_model *m = model_of(other);
    const fp3_token wanted = {.text = word, .length = strlen(word)};
    const char *near = NULL;
    for (uint32_t i = 0; i < m->state_count; i++)
        fp3_nearest(wanted, m->states[i].name, &near);
    for (uint32_t i = 0; i < m->param_count; i++)
        if (!fp3_model_is_foreign(m, i))
            fp3_nearest(wanted, m->params[i].name, &near);
    return fp3_kinds_refuse(
        g, line, error, "the model of group '%s' has no state or param '%s'%s%s%s", other->name,
        word, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static fp3_status check_word(const fp3_joined *g, const fp3_kind *kind, uint32_t param,
                             const fp3_joined *other, fp3_error *error) {
    const fp3_model *m = model_of(g);
    const fp3_quantity *own = &m->params[param];
    const char *word = word_of(m, kind, param);
    const fp3_quantity *theirs = quantity(model_of(other), word);
    if (has_other_size(m, kind, param, model_of(other)))
        return fp3_kinds_refuse(g, own->line, error,
                                "'%.*s' has another size in the model of group '%s'",
                                (int)(strrchr(word, '_') - word), word, other->name);
    if (!theirs)
        return no_word(g, own->line, other, word, error);
    for (uint32_t i = 0; i < m->relation_count; i++)
        if (m->relations[i].kind == FP3_NEAR && m->relations[i].their_radius == param &&
            fp3_model_state(model_of(other), word) != FP3_NONE)
            return fp3_kinds_refuse(
                g, m->relations[i].line, error,
                "'%s' is a state in the model of group '%s', and a reach changes with "
                "params alone: who is near is found before a step, by what stays as it is",
                word, other->name);
    const int fits = fp3_units_fit(own->dimension, theirs->dimension);
    return fits < 0 ? fp3_no_memory(error)
           : fits
               ? FP3_OK
               : fp3_kinds_refuse(g, own->line, error, "'%s' is in [%s], and in [%s] in group '%s'",
                                  word, own->dimension, theirs->dimension, other->name);
}

/* ---- what the program reads ---- */

/* The word of the program that is this param and nothing else; is_low: its second word, in
 * double-single. NULL: the program has none. */
static const char *param_word(const fp3_compiled *c, uint32_t param, int is_low) {
    for (uint32_t i = 0; i < c->input_count; i++)
        if ((is_low ? fp3_start_low_param : fp3_start_param)(c, i) == param)
            return c->inputs[i].name;
    return NULL;
}

/* What is read of objects says where they are: nothing else of the program names their group. */
static fp3_status check_reads(const fp3_joined *g, const fp3_kind *kind, fp3_error *error) {
    const fp3_model *m = model_of(g);
    const fp3_compiled *c = g->program->compiled;
    const fp3_relation *of = NULL;
    for (uint32_t i = 0; i < m->relation_count; i++)
        if (m->relations[i].of_kind != FP3_NONE && &m->kinds[m->relations[i].of_kind] == kind &&
            fp3_image_find(c->image, m->relations[i].name, FP3_CLASSES_OBJECT))
            of = &m->relations[i];
    for (uint32_t p = kind->first; p < kind->first + kind->count; p++)
        if (param_word(c, p, 0))
            of = NULL;
    return of ? fp3_kinds_refuse(g, of->line, error,
                                 "sums over '%s' read no word of '%s': expected one that does, as "
                                 "sum(o in %s: 0*o.%s)",
                                 of->name, kind->name, of->name, word_of(m, kind, kind->first))
              : FP3_OK;
}

static fp3_status check_kind(const fp3_joined *list, size_t count, size_t of, const fp3_kind *kind,
                             size_t *group, fp3_error *error) {
    fp3_status status = find_group(list, count, of, kind, group, error);
    for (uint32_t p = kind->first; !status && p < kind->first + kind->count; p++)
        status = check_word(&list[of], kind, p, &list[*group], error);
    if (!status)
        status = fp3_kinds_check_steps(&list[of], kind->line, &list[*group], error);
    return status ? status : check_reads(&list[of], kind, error);
}

/* ---- who reads what ---- */

static const char *state_word(const fp3_compiled *c, uint32_t state, int is_low) {
    for (uint32_t i = 0; i < c->input_count; i++)
        if ((is_low ? c->inputs[i].low_of : c->inputs[i].state) == state)
            return c->inputs[i].name;
    return NULL;
}

typedef struct {
    fp3_coupling coupling;
    size_t group_of[FP3_KINDS_MAX]; /* of each kind that a relation uses, else NONE */
    size_t
        part; /* groups that see each other are of one part, and so are all with adaptive steps */
    int is_coupled;
} member;

static void note_words(const fp3_joined *list, size_t of, member *members) {
    const fp3_model *m = model_of(&list[of]);
    for (uint32_t k = 0; m && k < m->kind_count; k++) {
        const size_t group = members[of].group_of[k];
        const fp3_kind *kind = &m->kinds[k];
        for (uint32_t p = kind->first; group != NONE && p < kind->first + kind->count; p++) {
            const fp3_model *other = model_of(&list[group]);
            const uint32_t state = fp3_model_state(other, word_of(m, kind, p));
            if (!param_word(list[of].program->compiled, p, 0))
                continue; /* no loop reads it */
            if (state != FP3_NONE)
                members[group].coupling.seen |= UINT64_C(1) << state;
            else
                members[group].coupling.params |= UINT64_C(1)
                                                  << fp3_model_param(other, word_of(m, kind, p));
        }
    }
}

static int sees(const member *one, size_t group) {
    for (uint32_t k = 0; k < FP3_KINDS_MAX; k++)
        if (one->group_of[k] == group)
            return 1;
    return 0;
}

static int is_adaptive(const fp3_joined *g) {
    return model_of(g) && fp3_model_adapted(model_of(g)) != FP3_NONE;
}

/* Whether one sees the other; where any that are adaptive do, all adaptive groups are together. */
static int are_together(const fp3_joined *list, const member *members, size_t i, size_t k,
                        int is_common) {
    return sees(&members[i], k) || sees(&members[k], i) ||
           (is_common && i != k && is_adaptive(&list[i]) && is_adaptive(&list[k]));
}

static void find_parts(const fp3_joined *list, member *members, size_t count) {
    int is_common = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < count; k++)
            is_common |= sees(&members[i], k) && (is_adaptive(&list[i]) || is_adaptive(&list[k]));
    for (int is_new = 1; is_new;) {
        is_new = 0;
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < count; k++)
                if (are_together(list, members, i, k, is_common) &&
                    members[i].part != members[k].part) {
                    const size_t least =
                        members[i].part < members[k].part ? members[i].part : members[k].part;
                    members[i].part = members[k].part = least;
                    is_new = 1;
                }
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < count; k++)
            members[i].is_coupled |= are_together(list, members, i, k, is_common);
        members[i].coupling.is_common = is_common && is_adaptive(&list[i]);
        for (size_t k = 0; k < count; k++)
            members[i].coupling.is_one_by_one |= (sees(&members[i], k) || sees(&members[k], i)) &&
                                                 !fp3_kinds_never_move(model_of(&list[k]));
    }
}

static fp3_status find_members(const fp3_joined *list, size_t count, member *members,
                               fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < count; i++) {
        const fp3_model *m = model_of(&list[i]);
        members[i].part = i;
        for (uint32_t k = 0; k < FP3_KINDS_MAX; k++) {
            members[i].group_of[k] = NONE;
            if (!status && m && k < m->kind_count && is_used(m, k))
                status = check_kind(list, count, i, &m->kinds[k], &members[i].group_of[k], error);
        }
    }
    for (size_t i = 0; !status && i < count; i++)
        note_words(list, i, members);
    if (!status)
        find_parts(list, members, count);
    return status;
}

/* ---- phases that fit each other ---- */

static fp3_status compile_again(const fp3_joined *g, const fp3_coupling *coupling,
                                fp3_error *error) {
    fp3_program *p = g->program;
    fp3_compile_def how = g->def->compile;
    fp3_compiled *made = NULL;
    fp3_error why;
    how.coupling = coupling;
    if (!how.config)
        how.config = FP3_WORLD;
    const fp3_status status = fp3_compile(p->model, p->integrator, &how, &made, &why);
    if (status)
        return fp3_fail_at(error, status, p->source, why.line, why.column, "group '%s': %s",
                           g->name, why.text + why.message);
    fp3_compiled_free(&p->compiled);
    p->compiled = made;
    p->image = made->image;
    p->config = how.config;
    p->sees_others = 1;
    return FP3_OK;
}

/* Where others look at it. */
static uint64_t looked_at(const fp3_joined *list, size_t count, const member *members, size_t of) {
    uint64_t looked = 0;
    for (size_t i = 0; members[of].coupling.seen && i < count; i++)
        if (sees(&members[i], of))
            looked |= list[i].program->compiled->looks;
    return looked;
}

/* What objects of all groups of a part compare. */
static unsigned compared_in(const fp3_joined *list, size_t count, const member *members,
                            size_t part) {
    unsigned compared = 0;
    for (size_t i = 0; i < count; i++)
        if (members[i].part == part && members[i].coupling.is_common)
            compared |= list[i].program->compiled->compares;
    return compared;
}

/* The phase of each place, and behind all phases where the group does not show what others look at:
 * they see what it ends with. Returns the set of these places. */
static uint64_t places_of(const fp3_program *program, const member *one,
                          uint8_t phase[FP3_PLACES]) {
    const fp3_compiled *c = program->compiled;
    const uint64_t hidden =
        fp3_kinds_never_move(program->model) ? 0 : one->coupling.looked & ~c->shows;
    const uint64_t has = c->looks | c->shows | hidden;
    for (uint32_t p = 0; p < FP3_PLACES; p++)
        phase[p] = !(has >> p & 1) ? 0 : hidden >> p & 1 ? (uint8_t)c->phases : c->phase[p];
    return has;
}

/* The place before the step, which comes behind the stages, and behind the one where a recurrence
 * is estimated. */
static uint64_t before(const fp3_program *program) {
    const fp3_integrator *integrator = program->integrator;
    const uint32_t stages =
        integrator->kind == FP3_CHEBYSHEV
            ? integrator->recurrence.stages + (uint32_t)fp3_model_chooses_steps(program->model)
            : integrator->stages;
    return stages < FP3_PLACES ? UINT64_C(1) << stages : 0;
}

/* Later places are not in earlier phases. */
static void sort(uint64_t has, uint8_t phase[FP3_PLACES]) {
    for (uint32_t p = 0; p < FP3_PLACES; p++)
        for (uint32_t q = p + 1; q < FP3_PLACES; q++)
            if (has >> p & has >> q & 1 && phase[p] > phase[q]) {
                const uint8_t later = phase[p];
                phase[p] = phase[q];
                phase[q] = later;
            }
}

static int raise(const uint8_t *least, uint32_t count, int is_one, uint8_t *phase) {
    int is_new = 0;
    for (uint32_t p = 0; p < count && !(is_one && is_new); p++)
        if (least[p] > phase[p]) {
            phase[p] = least[p];
            is_new = 1;
        }
    return is_new;
}

/* A phase is as late as the latest group needs it. Two places that need not be in a certain order
 * may be in another one in each group: so all of them take the order of the places, if they can,
 * and else the first place is decided before the others. */
static int raise_phases(const fp3_joined *list, size_t count, const member *members, size_t part,
                        fp3_coupling *asked) {
    int is_new = 0;
    for (int is_one = 0; !is_new && is_one < 2; is_one++)
        for (size_t i = 0; i < count && !(is_one && is_new); i++) {
            uint8_t least[FP3_PLACES];
            if (members[i].part != part || !members[i].is_coupled)
                continue;
            const uint64_t has = places_of(list[i].program, &members[i], least);
            if (!is_one)
                sort(has & ~before(list[i].program), least);
            is_new |= raise(least, FP3_PLACES, is_one, asked->phase);
            is_new |= raise(list[i].program->compiled->behind, FP3_COMPARISONS, 0, asked->behind);
        }
    return is_new;
}

/* Each round some phase becomes later, or what others look at has changed. */
static fp3_status fit(const fp3_joined *list, size_t count, member *members, size_t part,
                      fp3_error *error) {
    enum { ROUNDS = 128 };
    fp3_coupling asked = {.compared = 0};
    fp3_status status = FP3_OK;
    for (unsigned round = 0; !status && round < ROUNDS; round++) {
        int is_new = round == 0;
        for (size_t i = 0; i < count; i++) {
            if (members[i].part != part || !members[i].is_coupled)
                continue;
            const uint64_t looked = looked_at(list, count, members, i);
            is_new |= looked != members[i].coupling.looked;
            members[i].coupling.looked = looked;
        }
        const unsigned compared = compared_in(list, count, members, part);
        is_new |= compared != asked.compared;
        asked.compared = compared;
        is_new |= round > 0 && raise_phases(list, count, members, part, &asked);
        if (!is_new)
            return FP3_OK;
        for (size_t i = 0; !status && i < count; i++) {
            if (members[i].part != part || !members[i].is_coupled)
                continue;
            memcpy(members[i].coupling.phase, asked.phase, sizeof asked.phase);
            memcpy(members[i].coupling.behind, asked.behind, sizeof asked.behind);
            members[i].coupling.compared = asked.compared;
            status = compile_again(&list[i], &members[i].coupling, error);
        }
    }
    return status ? status
                  : fp3_kinds_refuse(
                        &list[part], 0, error,
                        "it and the groups that it sees find no phases that fit each other");
}

/* The engine compares their words, so programs have them. */
static uint64_t common_params(const fp3_model *m) {
    const uint32_t until = fp3_model_param(m, "until"), locate = fp3_model_param(m, "locate");
    return UINT64_C(1) << until | (locate == FP3_NONE ? 0 : UINT64_C(1) << locate);
}

/* All that are adaptive have the same states and params for it. */
static fp3_status make_alike(const fp3_joined *list, size_t count, member *members,
                             fp3_error *error) {
    fp3_model **models = calloc(count + 1u, sizeof(fp3_model *));
    size_t found = 0;
    if (!models)
        return fp3_no_memory(error);
    for (size_t i = 0; i < count; i++)
        if (members[i].coupling.is_common)
            models[found++] = list[i].program->model;
    fp3_status status = found ? fp3_kinds_check_all(list, count, error) : FP3_OK;
    if (!status && found)
        status = fp3_models_adapt_alike(models, found, error);
    for (size_t i = 0; !status && i < count; i++)
        if (members[i].coupling.is_common)
            members[i].coupling.params |= common_params(model_of(&list[i]));
    free(models);
    return status;
}

fp3_status fp3_programs_join(const fp3_joined *list, size_t count, fp3_error *error) {
    FP3_HOST;
    member *members = calloc(count + 1u, sizeof *members);
    if (!members)
        return fp3_no_memory(error);
    fp3_status status = find_members(list, count, members, error);
    if (!status)
        status = make_alike(list, count, members, error);
    for (size_t i = 0; !status && i < count; i++)
        if (members[i].is_coupled && members[i].part == i)
            status = fit(list, count, members, i, error);
    free(members);
    return status;
}

/* ---- for the engine ---- */

/* A word of the other group's program that is this state or param. */
static const char *their_word(const fp3_program *other, const char *name, int is_low) {
    const uint32_t state = fp3_model_state(other->model, name);
    const uint32_t param = fp3_model_param(other->model, name);
    return state != FP3_NONE   ? state_word(other->compiled, state, is_low)
           : param != FP3_NONE ? param_word(other->compiled, param, is_low)
                               : NULL;
}

fp3_status fp3_program_foreign(const fp3_joined *list, size_t count, size_t of,
                               fp3_foreign **foreign, size_t *foreign_count, fp3_error *error) {
    const fp3_program *program = list[of].program;
    const fp3_model *m = program->model;
    fp3_status status = FP3_OK;
    *foreign_count = 0;
    *foreign = calloc(2u * (m ? m->param_count : 0) + 1u, sizeof **foreign);
    if (!*foreign)
        return fp3_no_memory(error);
    for (uint32_t k = 0; !status && m && k < m->kind_count; k++) {
        const fp3_kind *kind = &m->kinds[k];
        size_t group = NONE;
        if (is_used(m, k))
            status = find_group(list, count, of, kind, &group, error);
        for (uint32_t n = 0; !status && group != NONE && n < 2 * kind->count; n++) {
            const uint32_t p = kind->first + n / 2;
            const char *word = param_word(program->compiled, p, n % 2), *name = word_of(m, kind, p);
            const char *theirs = their_word(list[group].program, name, n % 2);
            if (word && !theirs)
                status = fp3_kinds_refuse(
                    &list[of], kind->line, error,
                    "the program of group '%s' has no word '%s': join the programs", kind->name,
                    name);
            else if (word)
                (*foreign)[(*foreign_count)++] = (fp3_foreign){word, group, theirs};
        }
    }
    if (status) {
        free(*foreign);
        *foreign = NULL;
        *foreign_count = 0;
    }
    return status;
}
