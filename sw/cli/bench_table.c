/* SPDX-License-Identifier: Apache-2.0 */
/* bench_table.c - see bench_table.h. */
#include "bench_table.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PAPER_FIRST 445
#define PAPER_NEXT 418

/* Of a counter, what each step after the first adds. */
static double per_step(const fp3_bench_outcome *o, fp3_counter counter) {
    return ((double)o->got.all.counter[counter] - (double)o->got.one.counter[counter]) /
           (double)(o->what.steps - 1);
}

static double rate(const fp3_bench_outcome *o) {
    const fp3_stats *all = &o->got.all;
    return all->seconds > 0 ? (double)all->counter[FP3_COUNTER_CYCLES] / all->seconds : 0;
}

/* Instructions that a scheduler may issue in a cycle. */
static uint32_t at_once(const fp3_bench_outcome *o) { return 1 + o->config->dual; }

/* No schedule of this program on this organisation takes fewer cycles per object-step. A step has I
 * instructions, A of them for the adder and M for the multiplier (a madd counts in both). In a tile
 * a scheduler issues one instruction per cycle for L lanes, two with `dual`, and there are S
 * schedulers (S or L is 1): I / (S * L), or half. An adder begins one sum per cycle, and there is
 * one for each lane: A / L; likewise M / L. The largest of the three, shared by all tiles. */
static double bound(const fp3_bench_outcome *o) {
    const fp3_config *c = o->config;
    const double issue = (double)o->got.issues / (c->schedulers * at_once(o));
    const double uses = o->got.adds > o->got.muls ? o->got.adds : o->got.muls;
    return (issue > uses ? issue : uses) / c->lanes / c->tiles;
}

static double issued_per_step(const fp3_bench_outcome *o) {
    double sum = 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (strncmp(fp3_counter_name((fp3_counter)i), "issued_", 7) == 0)
            sum += per_step(o, (fp3_counter)i);
    return sum;
}

void fp3_bench_head(uint64_t steps, const fp3_program *program, const char *name) {
    const fp3_symbol *state;
    const int is_ship = fp3_bench_is_ship(program);
    printf("The %s%s, one %s and %" PRIu64
           " more (many objects share them). first, next: cycles; /object: next per "
           "object-step.\n\n",
           is_ship ? "ship of Equations (1)" : "program ", is_ship ? "" : name,
           is_ship ? "integration" : "step", steps);
    printf("%-24s %7s %9s %7s %7s %7s", "program, config", "first", "next", "objects", "/object",
           "bound");
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10s", fp3_counter_name((fp3_counter)i) + strlen("stall_"));
    for (unsigned i = 0; (state = fp3_bench_state(program->image, i)); i++)
        printf("%*serror %s", strlen(state->name) < 3 ? (int)(4 - strlen(state->name)) : 1, "",
               state->name);
    printf(" %9s\n", "cycles/s");
    if (is_ship)
        printf("%-24s %7d %9d\n", "the paper", PAPER_FIRST, PAPER_NEXT);
}

void fp3_bench_row(const fp3_bench_outcome *o) {
    char name[64];
    const double next = per_step(o, FP3_COUNTER_CYCLES);
    snprintf(name, sizeof name, "%s, %s", o->program, o->what.config);
    printf("%-24s %7" PRIu64 " %9.6g %7" PRIu64 " %7.2f %7.2f", name,
           o->got.one.counter[FP3_COUNTER_CYCLES], next, o->got.objects,
           next / (double)o->got.objects, bound(o));
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10.6g", per_step(o, (fp3_counter)i));
    for (unsigned i = 0; fp3_bench_state(o->what.program->image, i); i++)
        printf(" %9.2e", o->got.error[i]);
    printf(" %9.2e  mismatches %" PRIu64 " of %" PRIu64 " words%s%s\n", rate(o), o->got.mismatches,
           o->got.words, o->got.failure[0] ? "; failed: " : "", o->got.failure);
    fflush(stdout);
}

static void put_integer(json_t *to, const char *name, uint64_t value) {
    json_object_set_new(to, name, json_integer((json_int_t)value));
}

static void put_real(json_t *to, const char *name, double value) {
    json_object_set_new(to, name, json_real(value));
}

json_t *fp3_bench_common_json(const fp3_bench_outcome *o) {
    json_t *object = json_object();
    json_object_set_new(object, "config", json_string(o->what.config));
    json_object_set_new(object, "program", json_string(o->program));
    put_integer(object, "objects", o->got.objects);
    put_integer(object, "steps", o->what.steps);
    put_integer(object, "words", o->got.words);
    put_integer(object, "mismatches", o->got.mismatches);
    put_integer(object, "object_steps", o->got.all.object_steps);
    put_real(object, "cycles_per_second", rate(o));
    if (o->got.failure[0])
        json_object_set_new(object, "failed", json_string(o->got.failure));
    return object;
}

/* Of the cycles that a step adds, in how many a unit of each kind is used, on average. */
static json_t *utilisation_json(const fp3_bench_outcome *o) {
    const double cycles = per_step(o, FP3_COUNTER_CYCLES) * o->config->tiles;
    const double chain = per_step(o, FP3_COUNTER_ISSUED_CHAIN);
    json_t *object = json_object();
    put_real(object, "add", (per_step(o, FP3_COUNTER_ISSUED_ADD) + chain) / cycles);
    put_real(object, "mul", (per_step(o, FP3_COUNTER_ISSUED_MUL) + chain) / cycles);
    put_real(object, "issue", issued_per_step(o) / cycles / (o->config->schedulers * at_once(o)));
    return object;
}

/* "rel_err_v" and so on. */
static void put_errors(json_t *to, const fp3_bench_outcome *o) {
    const fp3_symbol *state;
    for (unsigned i = 0; (state = fp3_bench_state(o->what.program->image, i)); i++) {
        char name[FP3_NAME_SIZE + 8];
        snprintf(name, sizeof name, "rel_err_%s", state->name);
        json_object_set_new(to, name,
                            isfinite(o->got.error[i]) ? json_real(o->got.error[i]) : json_null());
    }
}

json_t *fp3_bench_json(const fp3_bench_outcome *o) {
    json_t *stalls = json_object(), *object = fp3_bench_common_json(o);
    const uint64_t *one = o->got.one.counter, *all = o->got.all.counter;
    const uint64_t added = all[FP3_COUNTER_CYCLES] - one[FP3_COUNTER_CYCLES];
    const double next = per_step(o, FP3_COUNTER_CYCLES);
    put_integer(object, "first_cycles", one[FP3_COUNTER_CYCLES]);
    json_object_set_new(object, "next_cycles",
                        added % (o->what.steps - 1) ? json_real(next)
                                                    : json_integer((json_int_t)next));
    put_real(object, "cycles_per_object_step", next / (double)o->got.objects);
    put_real(object, "bound", bound(o));
    put_errors(object, o);
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        const char *name = fp3_counter_name((fp3_counter)i);
        const int is_stall = fp3_counter_is_stall((fp3_counter)i);
        put_integer(is_stall ? stalls : object, is_stall ? name + strlen("stall_") : name, all[i]);
    }
    json_object_set_new(object, "stalls", stalls);
    json_object_set_new(object, "unit_utilisation", utilisation_json(o));
    return object;
}
