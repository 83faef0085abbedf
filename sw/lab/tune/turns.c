/* SPDX-License-Identifier: Apache-2.0 */
/* turns.c - see turns.h. */
#include "turns.h"

#include "engine/common/inside.h"
#include "machine/phased.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How long the longest list of each batch is, at one look. */
typedef struct {
    char name[FP3_NAME_SIZE];
    size_t group;
    unsigned look;
    uint32_t *longest;
} list_turns;

struct fp3_turns {
    const fp3_scene *scene;
    const fp3_config *config;
    list_turns *lists;
    size_t count;
    unsigned looks;
};

fp3_status fp3_turns_open(const fp3_scene *scene, fp3_turns **turns, fp3_error *error) {
    fp3_turns *t = *turns = calloc(1, sizeof *t);
    if (!t)
        return fp3_no_memory(error);
    t->scene = scene;
    const fp3_status status = fp3_config_choose(scene->config, &t->config, error);
    if (status)
        fp3_turns_free(turns);
    return status;
}

void fp3_turns_free(fp3_turns **turns) {
    fp3_turns *t = *turns;
    for (size_t i = 0; t && i < t->count; i++)
        free(t->lists[i].longest);
    if (t)
        free(t->lists);
    free(t);
    *turns = NULL;
}

/* Lanes take objects in turn. */
static void find_longest(const fp3_turns *t, const fp3_members *members, const fp3_list *list,
                         list_turns *to) {
    const uint32_t most = t->config->contexts * t->config->lanes;
    for (uint32_t i = 0; i < members->objects && (list->is_all || list->begin); i++) {
        uint32_t *longest = &to->longest[(members->slot ? members->slot[i] : i) / most];
        const uint32_t length = fp3_list_length(list, i);
        if (length > *longest)
            *longest = length;
    }
}

static fp3_status look_at(fp3_turns *t, const fp3_members *members, size_t group, uint32_t number,
                          fp3_error *error) {
    const fp3_list *list = &members->lists.lists[number];
    list_turns *more = realloc(t->lists, (t->count + 1) * sizeof *more);
    if (!more)
        return fp3_no_memory(error);
    t->lists = more;
    list_turns *to = &more[t->count];
    *to = (list_turns){.group = group, .look = t->looks};
    snprintf(to->name, sizeof to->name, "%s", fp3_image_name(members->image, list->reg));
    to->longest =
        calloc(t->scene->groups[group].objects / t->config->contexts + 2u, sizeof *to->longest);
    if (!to->longest)
        return fp3_no_memory(error);
    t->count++;
    find_longest(t, members, list, to);
    return FP3_OK;
}

fp3_status fp3_turns_look(fp3_turns *t, fp3_engine *engine, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t k = 0; k < t->scene->group_count; k++) {
        const fp3_members *members = fp3_engine_members(engine, (uint32_t)k);
        for (uint32_t i = 0; !status && members && i < members->lists.shape.list_count; i++)
            status = look_at(t, members, k, i, error);
    }
    t->looks++;
    return status;
}

/* A group at one of the looks. */
typedef struct {
    const fp3_turns *t;
    const fp3_image *image;
    size_t group;
    unsigned look;
} moment;

static uint32_t longest_of(const void *user, uint32_t reg, uint32_t first, uint32_t rows) {
    const moment *m = user;
    const char *name = fp3_image_name(m->image, reg);
    (void)rows; /* those of a batch */
    for (size_t i = 0; i < m->t->count; i++) {
        const list_turns *l = &m->t->lists[i];
        if (l->group == m->group && l->look == m->look && strcmp(l->name, name) == 0)
            return l->longest[first / m->t->config->contexts];
    }
    return 0;
}

double fp3_turns_cycles(const fp3_turns *t, const fp3_program *programs) {
    double cycles = 0;
    for (unsigned look = 0; look < t->looks; look++)
        for (size_t i = 0; i < t->scene->group_count; i++) {
            const fp3_image *image = programs[i].image;
            const moment m = {t, image, i, look};
            const fp3_phased program = {image->decoded, image->code_count};
            const uint32_t lanes = t->config->lanes,
                           objects = (uint32_t)t->scene->groups[i].objects;
            const fp3_phased_run run = {
                .rows = (objects + lanes - 1) / lanes, .longest = longest_of, .user = &m};
            cycles += (double)fp3_phased_cycles(t->config, &program, &run) / t->looks;
        }
    return cycles;
}
