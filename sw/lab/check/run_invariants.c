/* SPDX-License-Identifier: Apache-2.0 */
/* run_invariants.c - see run_invariants.h. */
#include "run_invariants.h"

#include "invariants.h"

#include "world/apply.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Terms: fewer than this take a fraction of a second. */
#define QUICK 4194304

struct fp3_run_invariants {
    const fp3_run_set *set;
    fp3_invariant_group *groups;
    double **columns; /* of each group */
    fp3_invariants *of;
    fp3_invariant *first, *last, *again;
    int has_again;
};

static fp3_status take_start(const fp3_run_part *part, double *columns, fp3_error *error) {
    const uint32_t states = part->program->model->state_count;
    const size_t last = part->objects - 1;
    fp3_object_values values = {0};
    fp3_status status = fp3_object_values_open(part->program, part->params, &values, error);
    for (size_t i = 0; !status && i < part->objects; i++) {
        status = fp3_object_values_at(&values, last ? (double)i / (double)last : 0, error);
        for (uint32_t s = 0; !status && s < states; s++)
            columns[s * part->objects + i] = (double)(float)values.initial[s];
    }
    fp3_object_values_free(&values);
    return status;
}

static fp3_status take_end(fp3_run_invariants *r, size_t number, const fp3_program *program,
                           fp3_engine *engine, size_t first, fp3_error *error) {
    const size_t objects = r->groups[number].objects;
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < program->model->state_count; s++)
        status = fp3_run_state_read(program, engine, s, first, objects,
                                    r->columns[number] + s * objects, error);
    return status;
}

/* The time of a group at the start, or after its run: of adaptive steps that of its first object.
 */
static double time_of(const fp3_run_part *part, const double *columns, uint64_t steps) {
    const uint32_t t = fp3_model_adapted(part->program->model);
    fp3_object_values values = {0};
    double time = 0;
    if (t != FP3_NONE)
        return columns[t * part->objects];
    if (!fp3_object_values_open(part->program, part->params, &values, NULL) &&
        !fp3_object_values_at(&values, 0, NULL))
        time = (double)(float)values.h * (values.steps + (double)steps);
    fp3_object_values_free(&values);
    return time;
}

static fp3_status open(fp3_run_invariants *r, const fp3_run_set *set, fp3_error *error) {
    r->set = set;
    r->groups = calloc(set->count + 1, sizeof *r->groups);
    r->columns = calloc(set->count + 1, sizeof *r->columns);
    fp3_status status = r->groups && r->columns ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < set->count; i++) {
        const fp3_run_part *part = &set->parts[i];
        r->columns[i] =
            calloc(part->program->model->state_count * part->objects + 1, sizeof **r->columns);
        status = r->columns[i] ? take_start(part, r->columns[i], error) : fp3_no_memory(error);
        r->groups[i] = (fp3_invariant_group){fp3_run_set_name(set, i),
                                             part->program,
                                             part->params,
                                             part->objects,
                                             r->columns[i],
                                             status ? 0 : time_of(part, r->columns[i], 0)};
    }
    if (!status)
        status = fp3_invariants_open(r->groups, set->count, &r->of, error);
    const size_t count = status ? 0 : fp3_invariants_count(r->of);
    r->first = calloc(3 * count + 1, sizeof *r->first);
    r->last = r->first + count;
    r->again = r->last + count;
    return status ? status : r->first ? FP3_OK : fp3_no_memory(error);
}

static size_t count_of(const fp3_run_set *set) {
    size_t count = 0;
    for (size_t i = 0; i < set->count; i++) {
        if (!set->parts[i].program->model)
            return 0;
        count += set->parts[i].program->model->group_invariant_count;
    }
    return count;
}

fp3_status fp3_run_invariants_open(const fp3_run_set *set, int is_quick, fp3_run_invariants **of,
                                   fp3_error *error) {
    *of = NULL;
    if (!count_of(set) || fp3_run_set_changes(set))
        return FP3_OK;
    fp3_run_invariants *r = *of = calloc(1, sizeof *r);
    fp3_status status = r ? open(r, set, error) : fp3_no_memory(error);
    const int is_long = !status && is_quick && fp3_invariants_work(r->of) > QUICK;
    if (!status && !is_long)
        status = fp3_invariants_find(r->of, r->first, error);
    if (status || is_long)
        fp3_run_invariants_close(of);
    return status;
}

void fp3_run_invariants_close(fp3_run_invariants **of) {
    fp3_run_invariants *r = *of;
    if (!r)
        return;
    fp3_invariants_close(&r->of);
    for (size_t i = 0; r->columns && i < r->set->count; i++)
        free(r->columns[i]);
    free(r->columns);
    free(r->groups);
    free(r->first);
    free(r);
    *of = NULL;
}

fp3_status fp3_run_invariants_end(fp3_run_invariants *r, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; r && !status && i < r->set->count; i++) {
        const fp3_run_part *part = &r->set->parts[i];
        status = take_end(r, i, part->program, part->engine, part->first, error);
        r->groups[i].t = status ? 0 : time_of(part, r->columns[i], part->steps);
    }
    return r && !status ? fp3_invariants_find(r->of, r->last, error) : status;
}

fp3_status fp3_run_invariants_end_again(fp3_run_invariants *r, const fp3_second *second,
                                        fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; r && !status && i < second->count; i++) {
        const fp3_second_part *part = &second->parts[i];
        status = take_end(r, i, &part->program, second->engine, part->first, error);
    }
    if (!r || status)
        return status;
    r->has_again = 1;
    return fp3_invariants_find(r->of, r->again, error);
}

void fp3_run_invariants_print(const fp3_run_invariants *r) {
    for (size_t i = 0; r && i < fp3_invariants_count(r->of); i++) {
        printf("%-16s %s of all objects: was %.9g, changed by %.1e, relative %.1e", "invariant",
               fp3_invariants_name(r->of, i), r->first[i].value,
               r->last[i].value - r->first[i].value,
               fp3_invariant_change(&r->first[i], &r->last[i]));
        if (r->has_again)
            printf("; in the second run by %.1e", r->again[i].value - r->first[i].value);
        putchar('\n');
    }
}

void fp3_run_invariants_judge(const fp3_run_invariants *r, double bound,
                              char text[FP3_RUN_INVARIANTS_TEXT_SIZE]) {
    *text = '\0';
    for (size_t i = 0; r && !*text && i < fp3_invariants_count(r->of); i++) {
        const double change = fp3_invariant_change(&r->first[i], &r->last[i]);
        if (!(fabs(change) <= bound))
            snprintf(text, FP3_RUN_INVARIANTS_TEXT_SIZE,
                     "%s of all objects has changed by %.2g of its size, from %.4g to %.4g",
                     fp3_invariants_name(r->of, i), change, r->first[i].value, r->last[i].value);
    }
}
