/* SPDX-License-Identifier: Apache-2.0 */
/* run_print.c - see run_print.h. */
#include "run_print.h"

#include "cli.h"
#include "run_adaptive.h"
#include "run_ranks.h"

#include "engine/common/inside.h"

#include <fp3/trace.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define SHOWN 8 /* objects whose states are printed without --all */

/* The objects of one program. */
typedef struct {
    const fp3_program *program;
    const fp3_image *image;
    size_t first, objects;
    const fp3_run_check *check; /* NULL: no estimates */
    const fp3_failure *failure; /* of a run in parts; NULL: the engine is asked */
} part;

static void end_state(const part *of, const fp3_symbol *symbol, size_t object) {
    printf("   object %zu", object);
    fp3_run_check_print_state(of->check, symbol->name, object);
    putchar('\n');
}

static void print_state(fp3_engine *engine, const part *of, const fp3_symbol *symbol,
                        size_t object) {
    union {
        float value;
        uint32_t bits;
    } word;
    if (fp3_engine_read(engine, object, 1, symbol->index, &word.value))
        return;
    if ((int)symbol->index == fp3_image_slept(of->image))
        printf("%-16s %-16" PRIu32, symbol->name, word.bits);
    else
        printf("%-16s %-16.9g", symbol->name, (double)word.value);
    printf(" 0x%08" PRIx32, word.bits);
    end_state(of, symbol, object);
}

/* The register of the second word of a symbol's state; -1: it is in no double-single. */
static int low_of(const part *of, const fp3_symbol *symbol) {
    const fp3_compiled *compiled = of->program ? of->program->compiled : NULL;
    return compiled ? fp3_compiled_low(compiled, fp3_model_state(of->program->model, symbol->name))
                    : -1;
}

/* Whether it is the second word of a state, which is printed with the first. */
static int is_low(const part *of, const fp3_symbol *symbol) {
    const fp3_compiled *compiled = of->program ? of->program->compiled : NULL;
    for (uint32_t i = 0; compiled && i < compiled->input_count; i++)
        if (compiled->inputs[i].low_of != FP3_NONE &&
            strcmp(compiled->inputs[i].name, symbol->name) == 0)
            return 1;
    return 0;
}

/* The sum in double, then both words. */
static void print_sum(fp3_engine *engine, const part *of, const fp3_symbol *symbol, int low,
                      size_t object) {
    union {
        float value;
        uint32_t bits;
    } word[2];
    if (fp3_engine_read(engine, object, 1, symbol->index, &word[0].value) ||
        fp3_engine_read(engine, object, 1, (uint32_t)low, &word[1].value))
        return;
    printf("%-16s %-23.17g 0x%08" PRIx32 " 0x%08" PRIx32, symbol->name,
           (double)word[0].value + (double)word[1].value, word[0].bits, word[1].bits);
    end_state(of, symbol, object);
}

static void print_symbol(fp3_engine *engine, const part *of, const fp3_symbol *symbol,
                         size_t object) {
    const int low = low_of(of, symbol);
    if (is_low(of, symbol))
        return;
    if (low >= 0)
        print_sum(engine, of, symbol, low, object);
    else
        print_state(engine, of, symbol, object);
}

static void print_states(fp3_engine *engine, const part *of, int all) {
    const size_t shown = all || of->objects < SHOWN ? of->objects : SHOWN;
    for (size_t n = 0; n < shown; n++)
        for (uint32_t i = 0; i < of->image->symbol_count; i++)
            if (of->image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
                print_symbol(engine, of, &of->image->symbols[i], of->first + n);
    if (shown < of->objects)
        printf("%-16s %zu objects, which --all prints\n", "more", of->objects - shown);
}

/* How many objects sleep, and since which steps. */
static void print_asleep(fp3_engine *engine, const part *of) {
    size_t asleep = 0;
    uint32_t begin = UINT32_MAX, end = 0;
    if (fp3_image_slept(of->image) < 0)
        return;
    for (size_t i = of->first; i < of->first + of->objects; i++) {
        fp3_object_status status;
        if (fp3_engine_status(engine, i, 1, &status))
            return;
        if (status.slept && status.slept != FP3_REMOVED) {
            asleep++;
            begin = status.slept < begin ? status.slept : begin;
            end = status.slept > end ? status.slept : end;
        }
    }
    printf("%-16s %zu of %zu", "asleep", asleep, of->objects);
    if (asleep)
        printf(", since steps %" PRIu32 " to %" PRIu32, begin, end);
    putchar('\n');
}

/* Where objects may be born, gone or removed: how many are in each stage at the end. group: NULL:
 * of no scene. */
static void print_lives(const fp3_engine *engine, const part *of, const fp3_scene_group *group) {
    size_t count[FP3_GONE + 1] = {0};
    int is_any = of->image && fp3_image_removed(of->image) >= 0;
    for (size_t i = 0; i < of->objects; i++) {
        uint64_t born = 0, gone = FP3_FOREVER;
        if (group)
            fp3_scene_life(group, i, &born, &gone);
        is_any |= born || gone != FP3_FOREVER;
        count[fp3_engine_life(engine, of->first + i)]++;
    }
    if (is_any)
        printf("%-16s %zu of %zu, %zu not born yet, %zu gone\n", "alive", count[FP3_ALIVE],
               of->objects, count[FP3_UNBORN], count[FP3_GONE]);
}

/* text has room for both kinds. */
static fp3_status find_failed(fp3_engine *engine, const part *of, const fp3_cost *cost,
                              size_t *failed, char text[FP3_ADAPTIVE_TEXT_SIZE]) {
    fp3_failure failure = of->failure ? *of->failure : (fp3_failure){0};
    fp3_status status = FP3_OK;
    if (of->image && fp3_adaptive_is(of->image))
        return fp3_run_adaptive_failed(engine, of->first, of->objects, cost->stats.flags, failed,
                                       text);
    if (!of->failure)
        status = fp3_engine_failure(engine, of->first, of->objects, &failure);
    *failed = status ? 0 : failure.failed;
    if (*failed)
        fp3_engine_failure_text(engine, &failure, text);
    return status;
}

/* Nothing of a run that ended before its time. */
static void print_failed(fp3_engine *engine, const part *of, const fp3_cost *cost) {
    size_t failed;
    char text[FP3_ADAPTIVE_TEXT_SIZE];
    if (!find_failed(engine, of, cost, &failed, text) && failed)
        printf("%-16s %zu of %zu, first %s\n", "failed", failed, of->objects, text);
}

static void print_status(fp3_engine *engine, const part *of, const fp3_cost *cost) {
    if (fp3_adaptive_is(of->image))
        fp3_run_adaptive_print(engine, of->image, of->first, of->objects);
    else
        print_asleep(engine, of);
    print_failed(engine, of, cost);
}

/* Of a scheduler in all runs that this took: of one scheduler the sum is what it did. */
static fp3_status counters_of(fp3_engine *engine, const fp3_cost *cost, uint32_t scheduler,
                              uint64_t counter[FP3_COUNTER_COUNT]) {
    const uint64_t *known = cost->counter                 ? cost->counter[scheduler]
                            : cost->stats.schedulers == 1 ? cost->stats.counter
                                                          : NULL;
    if (!known)
        return fp3_engine_scheduler_counters(engine, scheduler, counter);
    memcpy(counter, known, FP3_COUNTER_COUNT * sizeof *counter);
    return FP3_OK;
}

static void print_occupancy(fp3_engine *engine, const fp3_cost *cost) {
    for (uint32_t scheduler = 0;
         !fp3_engine_is_divided(engine) && scheduler < cost->stats.schedulers; scheduler++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        if (!counters_of(engine, cost, scheduler, counter))
            fp3_occupancy_print(stdout, scheduler, counter);
    }
}

static void print_cost(const fp3_stats *stats, int has_counters) {
    static const char *const flags[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    printf("%-16s %" PRIu64 "\n", "object_steps", stats->object_steps);
    for (int i = 0; has_counters && i < FP3_COUNTER_COUNT; i++)
        printf("%-16s %" PRIu64 "\n", fp3_counter_name((fp3_counter)i), stats->counter[i]);
    printf("%-16s%s", "flags", stats->flags ? "" : " none");
    for (int i = 4; i >= 0; i--)
        if (stats->flags >> i & 1)
            printf(" %s", flags[i]);
    putchar('\n');
}

/* What the line carried, and how long the host waited for the run. */
static void print_line(const fp3_stats *stats, fp3_bus_use bus) {
    printf("%-16s %.3g s for the run; %" PRIu64 " requests on the line, %" PRIu64
           " sent again, %" PRIu64 " bytes\n",
           "board", stats->seconds, bus.requests, bus.repeats, bus.bytes);
}

/* What the cycles take on hardware with this clock, and what they took to simulate. */
static void print_time(const fp3_stats *stats, int has_cycles, int is_rtl, fp3_bus_use bus,
                       double clock) {
    const double cycles = (double)stats->counter[FP3_COUNTER_CYCLES];
    if (has_cycles && clock > 0) {
        printf("%-16s %.6g s at %.6g MHz: %.0f cycles\n", "time", cycles / clock, clock / 1e6,
               cycles);
        if (bus.cycles)
            printf("%-16s %.6g s: %" PRIu64 " transfers in %" PRIu64 " cycles\n", "bus",
                   (double)bus.cycles / clock, bus.transfers, bus.cycles);
        if (stats->object_steps)
            printf("%-16s %.6g s\n", "per object-step",
                   cycles / clock / (double)stats->object_steps);
    }
    if (bus.requests) {
        print_line(stats, bus);
        return;
    }
    printf("%-16s %.3g s", "simulator", stats->seconds);
    if (has_cycles && stats->seconds > 0)
        printf(", %.3g %s/second", cycles / stats->seconds, is_rtl ? "cycles" : "instructions");
    printf("; simulation time, not FPGA time\n");
}

/* An engine without cycles. */
static void print_speed(const fp3_stats *stats, const char *how) {
    printf("%-16s %.3g s", "time", stats->seconds);
    if (stats->seconds > 0 && stats->object_steps)
        printf(", %.4g object-steps/second", (double)stats->object_steps / stats->seconds);
    printf("; %s\n", how);
}

static part part_of(const fp3_scene *scene, size_t number, const fp3_cost *cost) {
    const fp3_scene_group *group = &scene->groups[number];
    return (part){.program = group->program,
                  .image = group->program->image,
                  .first = group->first,
                  .objects = group->objects,
                  .failure = cost->groups ? &cost->groups[number].failure : NULL};
}

/* program NULL: of several. */
static part part_of_all(const fp3_engine *engine, const fp3_program *program,
                        const fp3_cost *cost) {
    return (part){.program = program,
                  .image = program ? program->image : NULL,
                  .objects = fp3_engine_objects(engine),
                  .failure = cost->groups ? &cost->failure : NULL};
}

static void print_group(fp3_engine *engine, const fp3_scene *scene, size_t number,
                        const fp3_cost *cost, const fp3_run_check *check, int all) {
    const fp3_scene_group *group = &scene->groups[number];
    part of = part_of(scene, number, cost);
    of.check = check;
    fp3_cli_line(stdout, "group %-10zu %s, objects %zu to %zu", number, group->path, group->first,
                 group->first + group->objects - 1);
    print_states(engine, &of, all);
    print_lives(engine, &of, group);
    print_status(engine, &of, cost);
    const uint64_t steps = scene->group_count == 1 ? cost->stats.object_steps
                           : cost->groups          ? cost->groups[number].object_steps
                                                   : fp3_engine_group_steps(engine, number);
    printf("%-16s %" PRIu64 "\n", "object_steps", steps);
    fp3_run_check_print(check, group->first);
    putchar('\n');
}

/* Whose cycles each scheduler spent, and how long the first to end waited for the last. */
static void print_balance(fp3_engine *engine, const fp3_cost *cost) {
    uint64_t least = UINT64_MAX, most = 0;
    printf("balance of schedulers\n");
    for (uint32_t scheduler = 0; scheduler < cost->stats.schedulers; scheduler++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        fp3_scheduler_share share;
        if (counters_of(engine, cost, scheduler, counter) ||
            fp3_engine_scheduler_share(engine, scheduler, &share))
            return;
        const uint64_t cycles = counter[FP3_COUNTER_CYCLES];
        printf("  scheduler %-8" PRIu32 " %12" PRIu64 "  group %zu, %zu objects\n", scheduler,
               cycles, share.group, share.objects);
        least = cycles < least ? cycles : least;
        most = cycles > most ? cycles : most;
    }
    printf("  %-18s %12.1f %%\n", "imbalance",
           most ? 100.0 * (double)(most - least) / (double)most : 0.0);
}

void fp3_run_print(fp3_engine *engine, const fp3_run_task *of, const fp3_engine_def *def,
                   const fp3_cost *cost, const fp3_run_check *const *checks, int all,
                   double clock) {
    const fp3_stats *stats = &cost->stats;
    const fp3_engine_traits *is = fp3_engine_traits_of(def->engine, NULL);
    if (of->program) {
        part objects = part_of_all(engine, of->program, cost);
        objects.check = checks ? checks[0] : NULL;
        print_states(engine, &objects, all);
        print_lives(engine, &objects, NULL);
        print_status(engine, &objects, cost);
    }
    for (size_t i = 0; of->scene && i < of->scene->group_count; i++)
        print_group(engine, of->scene, i, cost, checks ? checks[i] : NULL, all);
    const char *how = fp3_engine_how(engine);
    fp3_error why = {.text = ""};
    const int has_counters = !fp3_engine_need_counters(engine, &why);
    print_cost(stats, has_counters && !*how);
    if (!has_counters)
        printf("%-16s none: %s%s\n", "counters", why.text,
               clock > 0 ? ", so the time at this clock is not known" : "");
    if (*how)
        print_speed(stats, how);
    else
        print_time(stats, has_counters, is->is_simulated, fp3_engine_bus(engine), clock);
    if (fp3_engine_is_divided(engine))
        fp3_run_ranks_print(engine);
    if (is->is_hardware && has_counters)
        print_occupancy(engine, cost);
    if (is->is_hardware && has_counters && of->scene && !fp3_engine_is_divided(engine) &&
        of->scene->group_count <= stats->schedulers)
        print_balance(engine, cost);
    if (checks && of->program)
        fp3_run_check_print(checks[0], 0);
    if (*cost->hash)
        printf("%-16s %s\n", "hash", cost->hash);
    if (*cost->chain)
        printf("%-16s %s\n", "chain", cost->chain);
}

int fp3_run_is_adaptive(const fp3_run_task *of) {
    int is_any = of->program && fp3_adaptive_is(of->program->image);
    for (size_t i = 0; of->scene && i < of->scene->group_count; i++)
        is_any |= fp3_adaptive_is(of->scene->groups[i].program->image);
    return is_any;
}

/* Of all objects, where steps have numbers that say who was the first; else group by group. */
static part part_to_judge(const fp3_engine *engine, const fp3_run_task *of, size_t number,
                          const fp3_cost *cost) {
    return of->scene && fp3_run_is_adaptive(of) ? part_of(of->scene, number, cost)
                                                : part_of_all(engine, of->program, cost);
}

fp3_status fp3_run_failed(fp3_engine *engine, const fp3_run_task *of, const fp3_cost *cost,
                          fp3_error *error) {
    const size_t parts = of->scene && fp3_run_is_adaptive(of) ? of->scene->group_count : 1;
    char first[FP3_ADAPTIVE_TEXT_SIZE] = "";
    fp3_status status = FP3_OK;
    size_t sum = 0;
    for (size_t i = 0; !status && i < parts; i++) {
        const part one = part_to_judge(engine, of, i, cost);
        size_t failed = 0;
        char text[FP3_ADAPTIVE_TEXT_SIZE];
        status = find_failed(engine, &one, cost, &failed, text);
        if (failed && !sum)
            strcpy(first, text);
        sum += failed;
    }
    if (status || !sum)
        return status;
    return fp3_fail(error, FP3_E_FAILED,
                    "%s; %zu of %zu objects failed (with --allow-failures the exit code is 0)",
                    first, sum, fp3_engine_objects(engine));
}
