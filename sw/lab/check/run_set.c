/* SPDX-License-Identifier: Apache-2.0 */
/* run_set.c - see run_set.h. */
#include "run_set.h"

#include "engine/common/inside.h"

#include <stdlib.h>
#include <string.h>

/* Whether the objects of one group see those of the other. */
static int sees(const fp3_scene *scene, size_t one, size_t other) {
    const fp3_model *m = scene->groups[one].program->model;
    for (uint32_t r = 0; m && r < m->relation_count; r++)
        if (m->relations[r].of_kind != FP3_NONE && scene->groups[other].name &&
            !strcmp(m->kinds[m->relations[r].of_kind].name, scene->groups[other].name))
            return 1;
    return 0;
}

/* Of each group the lowest number of those in its set. */
static void find(const fp3_scene *scene, size_t count, size_t *set_of) {
    for (size_t i = 0; i < count; i++)
        set_of[i] = i;
    for (size_t i = 0; scene && i < count; i++)
        for (size_t k = 0; k < count; k++) {
            const size_t from = set_of[i] > set_of[k] ? set_of[i] : set_of[k],
                         to = set_of[i] < set_of[k] ? set_of[i] : set_of[k];
            for (size_t n = 0; from != to && sees(scene, i, k) && n < count; n++)
                set_of[n] = set_of[n] == from ? to : set_of[n];
        }
}

static fp3_status take(fp3_run_set *set, const fp3_scene *scene, const fp3_run_part *parts,
                       size_t count, const size_t *set_of, size_t of, fp3_error *error) {
    set->scene = scene;
    set->parts = calloc(count + 1, sizeof *set->parts);
    set->groups = calloc(count + 1, sizeof *set->groups);
    if (!set->parts || !set->groups)
        return fp3_no_memory(error);
    for (size_t i = 0; i < count; i++)
        if (set_of[i] == of) {
            set->parts[set->count] = parts[i];
            set->groups[set->count++] = scene ? &scene->groups[i] : NULL;
        }
    return FP3_OK;
}

fp3_status fp3_run_sets_make(const fp3_scene *scene, const fp3_run_part *parts, size_t count,
                             fp3_run_set **sets, size_t *set_count, fp3_error *error) {
    size_t *set_of = calloc(count + 1, sizeof *set_of);
    fp3_run_set *made = calloc(count + 1, sizeof *made);
    fp3_status status = set_of && made ? FP3_OK : fp3_no_memory(error);
    *set_count = 0;
    if (!status)
        find(scene, count, set_of);
    for (size_t i = 0; !status && i < count; i++)
        if (set_of[i] == i)
            status = take(&made[(*set_count)++], scene, parts, count, set_of, i, error);
    free(set_of);
    if (status)
        fp3_run_sets_free(&made, *set_count);
    *sets = made;
    return status;
}

void fp3_run_sets_free(fp3_run_set **sets, size_t set_count) {
    for (size_t i = 0; *sets && i < set_count; i++) {
        free((*sets)[i].parts);
        free((void *)(*sets)[i].groups);
    }
    free(*sets);
    *sets = NULL;
}

size_t fp3_run_set_of(const fp3_run_set *sets, size_t set_count, const fp3_run_part *part) {
    for (size_t i = 0; i < set_count; i++)
        for (size_t k = 0; k < sets[i].count; k++)
            if (sets[i].parts[k].first == part->first)
                return i;
    return SIZE_MAX;
}

const char *fp3_run_set_name(const fp3_run_set *set, size_t part) {
    const fp3_model *model = set->parts[part].program->model;
    return set->groups[part] ? set->groups[part]->name : model ? model->name : NULL;
}

int fp3_run_set_changes(const fp3_run_set *set) {
    int changes = 0;
    for (size_t i = 0; i < set->count; i++) {
        const fp3_model *model = set->parts[i].program->model;
        changes |=
            fp3_engine_has_lives(set->parts[i].engine) || (model && fp3_model_removes(model));
    }
    return changes;
}
