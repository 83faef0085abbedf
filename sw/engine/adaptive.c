/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive.c - runs of adaptive steps, and what became of their objects. */
#include <fp3/engine.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "engine/common/backend.h"
#include "engine/common/cells.h"
#include "engine/common/checks.h"

#define WHOLE 0x1p100f     /* of steps that are not chosen: the next one is as long as all */
#define COUNT_MOST 0x1p32f /* what the host gives as a start may be anything */
#define RUN_LEAST 4 /* attempts that one object makes before the host looks again: at least, */
#define RUN_FIRST 8 /* and at most at first; one more for each RUN_GROWTH that it has made */
#define RUN_GROWTH 8
#define BLOCK 64 /* objects that are looked at together */

int fp3_adaptive_is(const fp3_image *image) {
    const unsigned state = FP3_CLASS(FP3_SYMBOL_STATE);
    return fp3_image_find(image, "t", state) && fp3_image_find(image, "h_next", state) &&
           fp3_image_find(image, "until", FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
}

/* 0 at the end. */
static float left_of(const fp3_adaptive_object *o) { return o->until - o->t - o->t_low; }

/* As the program has it; floats, in the host's rounding, are the same but where the configuration
 * truncates: then an object that is stuck may seem limited. */
static int has_step(const fp3_adaptive_object *o) {
    const float by = fminf(o->step + o->t_low, o->until - o->t);
    return by - o->t_low >= 0x1p-126f;
}

/* What objects of a group have by this name: a state, or what they share; 0 where the program has
 * none. */
static fp3_status read_number(fp3_engine *engine, const fp3_members *group, const char *name,
                              size_t first, size_t count, float *values) {
    const fp3_symbol *symbol =
        group->image ? fp3_image_find(group->image, name, FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED)
                     : NULL;
    memset(values, 0, count * sizeof *values);
    if (!symbol)
        return FP3_OK;
    if (!(FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_SHARED))
        return fp3_engine_read(engine, first, count, symbol->index, values);
    const size_t number = (size_t)(group - engine->layout.groups);
    const fp3_status status =
        fp3_engine_read_shared_of(engine, number, symbol->index, 1, &values[0]);
    for (size_t i = 1; i < count; i++)
        values[i] = values[0];
    return status;
}

/* What the search for an event keeps of roots: where a root has no value, it is not finite, and the
 * search goes on. */
static int is_of_search(const char *name) {
    return !strcmp(name, "root_before") || !strcmp(name, "root_behind");
}

/* The first state of each that is not finite. */
static fp3_status find_lost(fp3_engine *engine, const fp3_members *group, size_t first,
                            size_t count, fp3_adaptive_object *found) {
    const uint64_t states = fp3_engine_states_of(group);
    float values[BLOCK];
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < group->image->symbol_count; k++) {
        const fp3_symbol *symbol = &group->image->symbols[k];
        if (symbol->symbol_class != FP3_SYMBOL_STATE || !(states >> symbol->index & 1) ||
            is_of_search(symbol->name))
            continue;
        status = fp3_engine_read(engine, first, count, symbol->index, values);
        for (size_t i = 0; !status && i < count; i++)
            if (!found[i].state[0] && !isfinite(values[i]))
                strcpy(found[i].state, symbol->name);
    }
    return status;
}

static uint32_t count_of(float value) {
    return value > 0 && value < COUNT_MOST ? (uint32_t)value : 0;
}

static fp3_adaptive_end end_of(const fp3_adaptive_object *o) {
    const int has_stopped = o->step == 0 && signbit(o->step);
    if (left_of(o) > 0 && !has_stopped)
        return has_step(o) ? FP3_ADAPTIVE_LIMITED : FP3_ADAPTIVE_STUCK;
    return o->state[0]   ? FP3_ADAPTIVE_LOST
           : has_stopped ? FP3_ADAPTIVE_STOPPED
                         : FP3_ADAPTIVE_ENDED;
}

/* A block of a group. */
static fp3_status look(fp3_engine *engine, const fp3_members *group, size_t first, size_t count,
                       fp3_adaptive_object *found) {
    enum { T, T_LOW, STEP, UNTIL, ACCEPTED, REJECTED, SMALLEST, LARGEST, NUMBERS };
    static const char *const names[NUMBERS] = {"t",        "t_low",    "h_next",   "until",
                                               "accepted", "rejected", "smallest", "largest"};
    float is[NUMBERS][BLOCK];
    fp3_status status = FP3_OK;
    for (int k = 0; !status && k < NUMBERS; k++) {
        const int is_there =
            group->image &&
            fp3_image_find(group->image, names[k], FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
        if (k <= UNTIL && !is_there)
            return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                            "the program has no '%s': its steps are not adaptive", names[k]);
        status = read_number(engine, group, names[k], first, count, is[k]);
    }
    for (size_t i = 0; !status && i < count; i++)
        found[i] = (fp3_adaptive_object){.t = is[T][i],
                                         .t_low = is[T_LOW][i],
                                         .step = is[STEP][i],
                                         .until = is[UNTIL][i],
                                         .accepted = count_of(is[ACCEPTED][i]),
                                         .rejected = count_of(is[REJECTED][i]),
                                         .smallest = is[SMALLEST][i],
                                         .largest = is[LARGEST][i]};
    if (!status)
        status = find_lost(engine, group, first, count, found);
    for (size_t i = 0; !status && i < count; i++)
        found[i].end = end_of(&found[i]);
    return status;
}

fp3_status fp3_adaptive_look_all(fp3_engine *engine, size_t first, size_t count,
                                 fp3_adaptive_object *found) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    for (size_t i = first, now; !status && i < first + count; i += now) {
        const fp3_members *group = fp3_layout_group_of(&engine->layout, i);
        const size_t left = first + count - i;
        now = fp3_cells_of(group, 0, i, left < BLOCK ? left : BLOCK).count;
        status = look(engine, group, i, now, &found[i - first]);
    }
    return status;
}

fp3_status fp3_adaptive_look(fp3_engine *engine, size_t object, fp3_adaptive_object *found) {
    FP3_HOST;
    *found = (fp3_adaptive_object){.end = FP3_ADAPTIVE_ENDED};
    return fp3_adaptive_look_all(engine, object, 1, found);
}

void fp3_adaptive_text(size_t object, const fp3_adaptive_object *found,
                       char text[FP3_ADAPTIVE_TEXT_SIZE]) {
    FP3_HOST;
    char why[FP3_NAME_SIZE + 48] = "it has ended", counts[64] = "";
    if (found->end == FP3_ADAPTIVE_STOPPED)
        strcpy(why, "an event has stopped the object");
    if (found->end == FP3_ADAPTIVE_STUCK)
        strcpy(why, "the step that the tolerance allows is too short to change t");
    if (found->end == FP3_ADAPTIVE_LIMITED && found->step < WHOLE)
        snprintf(why, sizeof why, "no attempt is left, the next step is %.6g", (double)found->step);
    else if (found->end == FP3_ADAPTIVE_LIMITED)
        strcpy(why, "no attempt is left");
    if (found->state[0] && found->end != FP3_ADAPTIVE_STUCK)
        snprintf(why, sizeof why, "state %s is not finite", found->state);
    if (found->accepted || found->rejected) /* else it made none, or the program does not count */
        snprintf(counts, sizeof counts, ", after %u steps and %u rejected attempts",
                 found->accepted, found->rejected);
    snprintf(text, FP3_ADAPTIVE_TEXT_SIZE, "object %zu at t = %.9g of %.9g%s: %s", object,
             (double)found->t + (double)found->t_low, (double)found->until, counts, why);
}

/* ---- a run ---- */

static void add_stats(const fp3_stats *run, fp3_stats *sum) {
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        sum->counter[i] += run->counter[i];
    sum->schedulers = run->schedulers;
    sum->object_steps += run->object_steps;
    sum->flags |= run->flags;
    sum->seconds += run->seconds;
}

/* About half of what is left, if the steps stay as long as the next one. */
static uint64_t attempts_of(const fp3_adaptive_object *o, uint64_t made) {
    const uint64_t most = RUN_FIRST + made / RUN_GROWTH;
    const float wanted = ceilf(left_of(o) / (2 * o->step));
    return wanted < RUN_LEAST ? RUN_LEAST : wanted > (float)most ? most : (uint64_t)wanted;
}

/* One object that cannot sleep, or one of those that make their steps together: runs, and a look
 * after each. */
static fp3_status run_and_look(fp3_engine *engine, uint32_t object, uint64_t attempts,
                               fp3_stats *sum) {
    fp3_adaptive_object o;
    fp3_status status = fp3_adaptive_look(engine, object, &o);
    for (uint64_t made = 0; !status && made < attempts && left_of(&o) > 0 && has_step(&o);) {
        const uint64_t wanted = attempts_of(&o, made), left = attempts - made;
        fp3_stats run = {0};
        status = fp3_engine_run(engine, wanted < left ? wanted : left, &run);
        made += wanted;
        add_stats(&run, sum);
        if (!status)
            status = fp3_adaptive_look(engine, object, &o);
    }
    return status;
}

static int is_adaptive(const fp3_members *group) {
    return group->image && fp3_adaptive_is(group->image);
}

/* Else it would go on making attempts that change nothing. */
static fp3_status check_sleep(const fp3_engine *engine, const fp3_members *group) {
    const uint32_t count = engine->layout.count;
    if (!engine->config->interleave || group->lists.shape.is_any ||
        fp3_image_slept(group->image) >= 0)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "%sadaptive steps of many objects need 'sleep': expected a program that is "
                    "compiled for configuration '%s'",
                    fp3_engine_prefix((uint32_t)(group - engine->layout.groups), count).text,
                    engine->config->name);
}

/* ---- objects that see each other ---- */

/* The words of a group's objects: of each, or of all. */
static fp3_status read_words(fp3_engine *engine, const fp3_members *group, const fp3_symbol *s,
                             uint32_t *words) {
    const uint32_t number = (uint32_t)(group - engine->layout.groups);
    if (s->symbol_class != FP3_SYMBOL_SHARED)
        return engine->backend->read(
            engine, (fp3_cells){FP3_CELLS_REGISTER, s->index, group->first, group->objects}, words);
    const fp3_status status =
        engine->backend->read(engine, (fp3_cells){FP3_CELLS_CONSTANT, number, s->index, 1}, words);
    for (uint32_t i = 1; i < group->objects; i++)
        words[i] = words[0];
    return status;
}

static fp3_status differs(const fp3_engine *engine, uint32_t object, const char *name,
                          uint32_t other) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %" PRIu32 " has another '%s' than object %" PRIu32
                    ": objects that see each other make the same adaptive steps",
                    object, name, other);
}

/* The words of one name, which are those of the first object. */
static fp3_status check_name(fp3_engine *engine, uint32_t from, uint32_t end, const char *name,
                             uint32_t *words) {
    const fp3_members *first = &engine->layout.groups[from];
    uint32_t word = 0;
    fp3_status status = FP3_OK;
    for (uint32_t g = from; !status && g < end; g++) {
        const fp3_members *group = &engine->layout.groups[g];
        const fp3_symbol *s =
            fp3_image_find(group->image, name, FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
        if (!s || !is_adaptive(group))
            continue;
        status = read_words(engine, group, s, words);
        word = g == from ? words[0] : word;
        for (uint32_t i = 0; !status && i < group->objects; i++)
            if (words[i] != word)
                status = differs(engine, group->first + i, name, first->first);
    }
    return status;
}

/* What all objects of these groups, of which the first is adaptive, have in common: then they make
 * the same steps. */
static fp3_status check_common(fp3_engine *engine, uint32_t from, uint32_t end) {
    static const char *const names[] = {"t",           "t_low",    "h_next",   "until",
                                        "h_cut",       "h_before", "h_behind", "root_before",
                                        "root_behind", "maxstep",  "locate"};
    if (fp3_lives_vary(engine))
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "objects that see each other make the same adaptive steps: expected "
                        "objects that live from the first step to the last");
    uint32_t *words = malloc((engine->objects + (size_t)1) * sizeof *words);
    fp3_status status = words ? FP3_OK : fp3_no_memory(engine->def.error);
    for (size_t k = 0; !status && k < sizeof names / sizeof *names; k++)
        status = check_name(engine, from, end, names[k], words);
    free(words);
    return status;
}

/* Objects with fixed steps are gone after the last of them, and the others go on. */
static fp3_status end_fixed(fp3_engine *engine, uint64_t steps) {
    const uint64_t end = engine->made + steps;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (!is_adaptive(group))
            status = fp3_engine_live(engine, group->first, group->objects,
                                     end ? 0 : FP3_FOREVER - 1, end ? end : FP3_FOREVER);
    }
    return status;
}

/* Where other groups have steps of one length, a number is of these. */
static uint64_t attempts_most(const fp3_engine *engine, uint32_t adaptive, uint64_t most) {
    return adaptive < engine->layout.count && most < FP3_ADAPTIVE_ATTEMPTS ? FP3_ADAPTIVE_ATTEMPTS
                                                                           : most;
}

/* Groups that see each other make the same steps. One with steps of one length has objects that
 * never change: how many steps it makes is the same. */
static fp3_status run_joined(fp3_engine *engine, uint32_t first, uint32_t adaptive, uint64_t most,
                             fp3_stats *sum) {
    const fp3_status status = check_common(engine, first, engine->layout.count);
    most = attempts_most(engine, adaptive, most);
    return status ? status : run_and_look(engine, engine->layout.groups[first].first, most, sum);
}

static fp3_status run_apart(fp3_engine *engine, uint32_t adaptive, uint64_t most, fp3_stats *sum) {
    fp3_status status = FP3_OK;
    int is_awake = !engine->config->interleave;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        if (!is_adaptive(group))
            continue;
        status = check_sleep(engine, group);
        if (!status && group->lists.shape.is_any) {
            status = check_common(engine, i, i + 1);
            is_awake = 1;
        }
    }
    if (!status && adaptive < engine->layout.count)
        status = end_fixed(engine, most);
    if (status)
        return status;
    most = attempts_most(engine, adaptive, most);
    return is_awake ? run_and_look(engine, 0, most, sum) : fp3_engine_run(engine, most, sum);
}

fp3_status fp3_adaptive_run(fp3_engine *engine, uint64_t most, fp3_stats *stats) {
    FP3_HOST;
    fp3_stats sum = {0};
    uint32_t adaptive = 0, first = 0;
    for (uint32_t i = engine->layout.count; i-- > 0;)
        if (is_adaptive(&engine->layout.groups[i])) {
            first = i;
            adaptive++;
        }
    const fp3_status status = !adaptive ? fp3_engine_run(engine, most, &sum)
                              : fp3_layout_is_joined(&engine->layout)
                                  ? run_joined(engine, first, adaptive, most, &sum)
                                  : run_apart(engine, adaptive, most, &sum);
    if (stats)
        *stats = sum;
    return status;
}

/* ---- the report ---- */

static int compare_counts(const void *a, const void *b) {
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static fp3_adaptive_counts counts_of(uint32_t *list, size_t size) {
    qsort(list, size, sizeof *list, compare_counts);
    return (fp3_adaptive_counts){list[0], list[(size - 1) / 2], list[size - 1]};
}

static void take(size_t object, const fp3_adaptive_object *o, fp3_adaptive_report *report) {
    if (o->smallest <= o->largest && (report->smallest == 0 || o->smallest < report->smallest))
        report->smallest = o->smallest;
    report->largest = fmaxf(report->largest, o->largest);
    report->stopped += o->end == FP3_ADAPTIVE_STOPPED;
    if (fp3_adaptive_is_over(o->end))
        return;
    if (!report->failed++) {
        report->first = object;
        report->why = *o;
    }
}

fp3_status fp3_adaptive_report_make(fp3_engine *engine, size_t first, size_t size,
                                    fp3_adaptive_report *report) {
    fp3_status status = fp3_engine_check_objects(engine, first, size);
    *report = (fp3_adaptive_report){0};
    if (status || !size)
        return status;
    uint32_t *accepted = calloc(size, sizeof *accepted);
    uint32_t *rejected = calloc(size, sizeof *rejected);
    if (!accepted || !rejected)
        status = fp3_no_memory(engine->def.error);
    for (size_t done = 0; !status && done < size; done += BLOCK) {
        fp3_adaptive_object o[BLOCK];
        const size_t now = size - done < BLOCK ? size - done : BLOCK;
        status = fp3_adaptive_look_all(engine, first + done, now, o);
        for (size_t i = 0; !status && i < now; i++) {
            accepted[done + i] = o[i].accepted;
            rejected[done + i] = o[i].rejected;
            take(first + done + i, &o[i], report);
        }
    }
    if (!status) {
        report->accepted = counts_of(accepted, size);
        report->rejected = counts_of(rejected, size);
    }
    free(accepted);
    free(rejected);
    return status;
}
