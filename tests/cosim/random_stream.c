/* random_stream.c - random programs: the hardware against the isa engine at every retirement.
 *
 *     random_stream [--engine fast] [--vary] [--instructions N] [--config NAME] [--seed S]
 * [--streams N] [--trace]
 *
 * The hardware's units finish out of order, but each register of an object is written in program
 * order: the isa engine runs first and leaves a queue per register, from which each retirement of
 * the hardware takes one. Values, flags, final registers, the status of objects, sticky flags,
 * steps and counts must agree. A run that ends before its time, at an illegal word or because it is
 * stopped, retires the beginning of what the isa engine does, and leaves each object as one of its
 * visits left it.
 *
 * A session opens both engines for a random number of objects and runs some streams; between the
 * runs of a stream the host writes, wakes and removes objects. A session has its own seed:
 * --seed S --streams 1 repeats it alone, --trace prints what it does.
 *
 * The fast engine instead of the hardware retires nothing and runs no illegal words: what is left
 * after each run is compared. With --vary each session has its own rounding, flushing and flags.
 */
#include "engine/common/inside.h"
#include "machine/ahead.h"
#include "machine/cycles.h"
#include "stream.h"

#include <fp3/image.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdlib.h>

enum { STREAMS = 4, RUNS_MAX = 3, STEPS_MAX = 5, OBJECTS_MAX = 200 };

/* Many objects execute many instructions in few streams: so many make a session in any case. */
#define SESSION_INSTRUCTIONS 15000

/* ---- what is compared ---- */

typedef struct {
    fp3_retirement *expected; /* the isa engine's, in program order */
    size_t *next;             /* of the same register, or 0 */
    size_t count, room;       /* entry 0 stays empty */
    size_t *head, *tail;      /* of each register of each object */
} queues;

/* What a run of the isa engine leaves after each round of visits: one of these is what an object
 * has when the hardware was stopped. */
typedef struct {
    uint32_t *records; /* rounds + 1, each of all registers of all objects */
    uint32_t rounds;
} history;

typedef struct {
    fp3_engine *engine[2]; /* isa, rtl */
    fp3_error error[2];
    const char *other; /* the engine that is compared with isa */
    int is_fast, is_varied;
    const fp3_config *config;
    fp3_config varied;
    uint32_t objects, words; /* of a record that is kept */
    queues q;
    history past;
    stream s;
    uint64_t enough; /* instructions, behind which a session ends with half of its streams */
    uint64_t issued; /* as watched, in a run */
    int is_apart;    /* the engines' objects are not alike: all are written before the next run */
    int is_trace;
    const char *wrong; /* NULL, or the first thing that is */
    fp3_error why;
    uint64_t instructions, cycles, faults, stops, slept, failed, nans, subnormals, predicted;
} bench;

#define WRONG(...)                                                                                 \
    do {                                                                                           \
        fp3_fail(&b->why, FP3_E_MISMATCH, __VA_ARGS__);                                            \
        b->wrong = b->why.text;                                                                    \
        return;                                                                                    \
    } while (0)

static size_t cell_of(const bench *b, uint32_t object, uint32_t reg) {
    return (size_t)object * b->config->registers + reg;
}

static void print(const bench *b, const char *who, const fp3_retirement *r) {
    if (b->is_trace)
        printf(
            "  %s %8" PRIu64 ": object %" PRIu32 " r%" PRIu32 " = 0x%08" PRIx32
            " flags 0x%02" PRIx32 " (scheduler %" PRIu32 " lane %" PRIu32 " context %" PRIu32 ")\n",
            who, r->cycle, r->object, r->reg, r->bits, r->flags, r->scheduler, r->lane, r->context);
}

static void fill(void *user, const fp3_retirement *r) {
    bench *b = user;
    queues *q = &b->q;
    const size_t cell = cell_of(b, r->object, r->reg), i = ++q->count;
    if (i >= q->room) {
        q->room *= 2;
        q->expected = realloc(q->expected, q->room * sizeof *q->expected);
        q->next = realloc(q->next, q->room * sizeof *q->next);
        if (!q->expected || !q->next)
            abort();
    }
    print(b, "isa", r);
    q->expected[i] = *r;
    q->next[i] = 0;
    if (q->head[cell])
        q->next[q->tail[cell]] = i;
    else
        q->head[cell] = i;
    q->tail[cell] = i;
    b->nans += (r->bits & 0x7fffffffu) > 0x7f800000u;
    b->subnormals += (r->bits & 0x7fffffffu) - 1 < 0x7fffffu;
}

static void take(void *user, const fp3_retirement *r) {
    bench *b = user;
    if (b->wrong)
        return;
    print(b, "rtl  ", r);
    if (r->object >= b->objects || r->reg >= b->config->registers ||
        r->object % fp3_engine_layout(b->engine[1])->groups[0].columns !=
            r->scheduler * b->config->lanes + r->lane ||
        r->context >= b->config->contexts)
        WRONG("cycle %" PRIu64 ": a retirement of object %" PRIu32 " r%" PRIu32
              ", scheduler %" PRIu32 ", lane %" PRIu32 ", context %" PRIu32,
              r->cycle, r->object, r->reg, r->scheduler, r->lane, r->context);
    const size_t cell = cell_of(b, r->object, r->reg), i = b->q.head[cell];
    if (!i)
        WRONG("cycle %" PRIu64 ": object %" PRIu32 " r%" PRIu32 " got 0x%08" PRIx32
              ", expected no more writes",
              r->cycle, r->object, r->reg, r->bits);
    const fp3_retirement *e = &b->q.expected[i];
    b->q.head[cell] = b->q.next[i];
    if (e->bits != r->bits || e->flags != r->flags)
        WRONG("cycle %" PRIu64 ": object %" PRIu32 " r%" PRIu32 " got 0x%08" PRIx32
              " flags 0x%02" PRIx32 ", expected 0x%08" PRIx32 " flags 0x%02" PRIx32
              " (instruction %" PRIu64 " of the isa engine)",
              r->cycle, r->object, r->reg, r->bits, r->flags, e->bits, e->flags, e->cycle);
}

/* What lane 0 ends: all that was issued, as the program has it. */
static void count_issue(void *user, const fp3_traced *issue) {
    bench *b = user;
    if (issue->lane)
        return;
    b->issued++;
    if (b->wrong)
        return;
    const fp3_code *program = &fp3_engine_layout(b->engine[1])->groups[0].program;
    if (issue->pc >= program->count || issue->word != program->code[issue->pc] ||
        issue->context >= b->config->contexts)
        WRONG("cycle %" PRIu64 ": scheduler %" PRIu32 ", context %" PRIu32 " issues 0x%08" PRIx32
              " at word %" PRIu32,
              issue->issued, issue->scheduler, issue->context, issue->word, issue->pc);
}

/* ---- what both engines get ---- */

static void set(bench *b, uint32_t object, uint32_t reg, uint32_t bits) {
    if (b->is_trace)
        printf("  host: object %" PRIu32 " r%" PRIu32 " = 0x%08" PRIx32 "\n", object, reg, bits);
    for (int k = 0; k < 2; k++)
        if (fp3_engine_write_words(b->engine[k], object, 1, reg, &bits))
            b->wrong = b->error[k].text;
}

static void set_constants(bench *b, chance *c) {
    for (uint32_t reg = 0; reg < b->config->registers; reg++) {
        const uint32_t bits = value(c);
        if (b->is_trace)
            printf("  host: k%" PRIu32 " = 0x%08" PRIx32 "\n", reg, bits);
        for (int k = 0; k < 2; k++)
            if (fp3_engine_write_shared_words(b->engine[k], 0, reg, 1, &bits))
                b->wrong = b->error[k].text;
    }
}

/* Who sleeps at first: mostly nobody. */
static void set_objects(bench *b, chance *c, uint32_t words) {
    const int is_mixed = below(c, 4) == 0,
              slept = fp3_engine_layout(b->engine[0])->groups[0].program.slept;
    for (uint32_t object = 0; object < b->objects && !b->wrong; object++)
        for (uint32_t reg = 0; reg < words && !b->wrong; reg++) {
            const int is_slept = (int)reg == slept;
            set(b, object, reg,
                !is_slept                 ? object_value(c, b->config)
                : is_mixed && below(c, 2) ? value(c)
                                          : 0);
        }
}

static void clear_status(bench *b) {
    for (int k = 0; k < 2 && b->config->status; k++)
        if (fp3_engine_clear_status(b->engine[k], 0, b->objects))
            b->wrong = b->error[k].text;
}

/* The host's work between two runs of a stream. */
static void disturb(bench *b, chance *c) {
    const uint32_t first = below(c, b->objects), count = 1 + below(c, b->objects - first);
    const uint32_t what = below(c, 4);
    if (fp3_engine_layout(b->engine[0])->groups[0].program.slept >= 0 && what < 3) {
        if (b->is_trace)
            printf("  host: %s %" PRIu32 " + %" PRIu32 "\n", what ? "wake" : "remove", first,
                   count);
        for (int k = 0; k < 2; k++)
            if ((what ? fp3_engine_wake : fp3_engine_remove)(b->engine[k], first, count))
                b->wrong = b->error[k].text;
    }
    for (uint32_t i = below(c, 8); i > 0; i--) {
        const uint32_t reg = below(c, b->s.pool);
        if ((int)reg != b->s.slept)
            set(b, below(c, b->objects), reg, object_value(c, b->config));
    }
    if (below(c, 8) == 0)
        clear_status(b);
}

static void load(bench *b) {
    const fp3_image image = stream_image(&b->s);
    for (int k = 0; k < 2 && !b->wrong; k++)
        if (fp3_engine_load_unchecked(b->engine[k], &image))
            b->wrong = b->error[k].text;
    const fp3_code *program = &fp3_engine_layout(b->engine[0])->groups[0].program;
    for (uint32_t i = 0; b->is_trace && !b->wrong && i < program->count; i++) {
        char text[FP3_WORD_TEXT_SIZE] = "illegal";
        fp3_word_text(program->code[i], NULL, text, NULL);
        printf("  %3" PRIu32 "%s 0x%08" PRIx32 " %s\n", i,
               i == program->step   ? " step:"
               : i == program->last ? " last:"
                                    : "      ",
               program->code[i], text);
    }
}

/* ---- what is left in the end ---- */

static uint32_t kept(bench *b, int k, uint32_t object, uint32_t reg) {
    uint32_t word = 0;
    if (fp3_engine_read_words(b->engine[k], object, 1, reg, &word))
        b->wrong = b->error[k].text;
    return word;
}

static void compare_objects(bench *b, uint32_t words) {
    for (uint32_t object = 0; object < b->objects; object++)
        for (uint32_t reg = 0; reg < words; reg++) {
            const uint32_t expected = kept(b, 0, object, reg), got = kept(b, 1, object, reg);
            if (b->wrong)
                return;
            if (got != expected)
                WRONG("at the end: object %" PRIu32 " r%" PRIu32 " got 0x%08" PRIx32
                      ", expected 0x%08" PRIx32,
                      object, reg, got, expected);
        }
}

static void compare_constants(bench *b) {
    for (uint32_t reg = 0; reg < b->config->registers; reg++) {
        uint32_t bits[2] = {0, 0};
        for (int k = 0; k < 2; k++)
            if (fp3_engine_read_shared_words(b->engine[k], 0, reg, 1, &bits[k]))
                b->wrong = b->error[k].text;
        if (bits[0] != bits[1])
            WRONG("at the end: k%" PRIu32 " got 0x%08" PRIx32 ", expected 0x%08" PRIx32, reg,
                  bits[1], bits[0]);
    }
}

/* is_part: an end before its time, when only some of what the isa engine did was done. */
static void compare_status(bench *b, int is_part) {
    for (uint32_t object = 0; object < b->objects && !b->wrong; object++) {
        fp3_object_status s[2];
        for (int k = 0; k < 2; k++)
            if (fp3_engine_status(b->engine[k], object, 1, &s[k]))
                b->wrong = b->error[k].text;
        if (is_part ? s[1].flags & ~s[0].flags : memcmp(&s[0], &s[1], sizeof s[0]) != 0)
            WRONG("status of object %" PRIu32 ": got flags 0x%02" PRIx32 " failed %" PRIu32
                  " slept %" PRIu32 ", expected 0x%02" PRIx32 " %" PRIu32 " %" PRIu32,
                  object, s[1].flags, s[1].failed, s[1].slept, s[0].flags, s[0].failed, s[0].slept);
    }
}

/* Whether an instruction of the step or the last part counts for the step that follows, which need
 * not be made. */
static int has_ahead(const fp3_members *group) {
    const fp3_code *program = &group->program;
    uint8_t *is_ahead = calloc(program->count + 1u, sizeof *is_ahead);
    int has = !is_ahead;
    if (is_ahead)
        fp3_ahead_find(program, fp3_engine_states_of(group), is_ahead);
    for (uint32_t pc = program->step; pc < program->count && !has; pc++)
        has = is_ahead[pc];
    free(is_ahead);
    return has;
}

/* An object that sleeps all the time has no retirements. One that fell asleep in step 0 reads as
 * awake, and whoever repeats the run does not know: then nobody's failures are compared. */
static int is_unseen(bench *b, uint32_t object) {
    const int slept = fp3_engine_layout(b->engine[0])->groups[0].program.slept;
    int is_there = slept < 0 || kept(b, 0, object, (uint32_t)slept) != 0;
    for (size_t i = 1; i <= b->q.count; i++)
        is_there |= b->q.expected[i].object == object;
    return !is_there;
}

/* What the retirements of the isa engine and the states in the end say about an object. Where
 * something is ahead, an exception alone may be of a step that nobody makes; so may that of an
 * object that sleeps. */
static int is_told_right(bench *b, uint32_t object, int is_told) {
    const fp3_members *group = &fp3_engine_layout(b->engine[0])->groups[0];
    const uint64_t states = fp3_engine_states_of(group);
    int is_there = 0, is_raised = 0, is_astray = 0;
    for (size_t i = 1; i <= b->q.count; i++) {
        const int is_its = b->q.expected[i].object == object;
        is_there |= is_its;
        is_raised |= is_its && (b->q.expected[i].flags & FP3_FLAGS_GRAVE) != 0;
    }
    if (!is_there && group->program.slept >= 0)
        return 1;
    for (uint32_t reg = 0; reg < b->config->registers; reg++)
        is_astray |= states >> reg & 1 && !fp3_watch_is_finite(kept(b, 0, object, reg));
    if (is_told)
        return is_raised || is_astray || b->config->storage; /* a store retires nothing */
    return !is_astray && !(is_raised && group->program.slept < 0 && !has_ahead(group));
}

static int is_same_failure(const fp3_failure *a, const fp3_failure *b) {
    return a->failed == b->failed && a->object == b->object && a->step == b->step &&
           a->is_before == b->is_before && a->flags == b->flags && a->state == b->state &&
           memcmp(&a->value, &b->value, sizeof a->value) == 0;
}

/* Both engines tell the same failures: those that were seen, not before the step that the
 * hardware's status has. */
static void compare_failures(bench *b, int has_steps) {
    size_t failed = 0;
    fp3_failure all, f[2];
    for (uint32_t i = 0; i < b->objects; i++)
        if (is_unseen(b, i))
            return;
    for (uint32_t object = 0; object < b->objects; object++) {
        fp3_object_status s = {0};
        for (int k = 0; k < 2; k++)
            if (fp3_engine_failure(b->engine[k], object, 1, &f[k]) ||
                fp3_engine_status(b->engine[1], object, 1, &s))
                WRONG("failure of object %" PRIu32 ": %.200s", object, b->error[k].text);
        failed += f[1].failed;
        b->failed += f[1].failed;
        if (!is_same_failure(&f[0], &f[1]))
            WRONG("object %" PRIu32 " (%zu) fails in step %" PRIu32 " by 0x%02" PRIx32
                  " or r%" PRIu32 ", the isa engine (%zu) in step %" PRIu32 " by 0x%02" PRIx32
                  " or r%" PRIu32,
                  object, f[1].failed, f[1].step, f[1].flags, f[1].state, f[0].failed, f[0].step,
                  f[0].flags, f[0].state);
        if (b->config->flags && !is_told_right(b, object, f[0].failed != 0))
            WRONG("object %" PRIu32 ": %zu failures are told", object, f[0].failed);
        /* A status has no step 0, which is that of the first part of the first visit. */
        if (has_steps && f[0].flags && f[0].step > 1 && s.failed > f[0].step)
            WRONG("object %" PRIu32 " fails in step %" PRIu32 ", its status says %" PRIu32, object,
                  f[0].step, s.failed);
    }
    if (fp3_engine_failure(b->engine[1], 0, b->objects, &all) || all.failed != failed)
        WRONG("%zu failures are told of all objects, %zu one by one", all.failed, failed);
}

/* Of objects that all execute all, the hardware issues what the isa engine does; with several lanes
 * only once, and lane 0 has objects wherever another lane has. */
static void compare_counters(bench *b, const fp3_stats stats[2]) {
    const uint32_t columns = fp3_engine_layout(b->engine[0])->groups[0].columns,
                   lanes = b->config->lanes;
    uint64_t issued = 0, in_lane_0 = 0;
    for (uint32_t i = 0; i < b->objects; i++)
        in_lane_0 += i % columns % lanes == 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        const char *name = fp3_counter_name((fp3_counter)i);
        const uint64_t got = stats[1].counter[i];
        const uint64_t expected = stats[0].counter[i] / b->objects * in_lane_0;
        if (strncmp(name, "issued_", 7) != 0)
            continue;
        issued += got;
        if (fp3_engine_layout(b->engine[0])->groups[0].program.slept < 0 && got != expected)
            WRONG("%s: got %" PRIu64 ", expected %" PRIu64, name, got, expected);
    }
    const uint64_t retired =
        stats[1].counter[FP3_COUNTER_RETIRED] + stats[1].counter[FP3_COUNTER_PAIRED];
    if (issued != b->issued || issued != retired)
        WRONG("%" PRIu64 " issued and %" PRIu64 " retired are counted, %" PRIu64 " were seen",
              issued, retired, b->issued);
}

static void compare_end(bench *b, const fp3_stats stats[2]) {
    for (uint32_t object = 0; !b->is_fast && object < b->objects; object++)
        for (uint32_t reg = 0; reg < b->config->registers; reg++)
            if (b->q.head[cell_of(b, object, reg)])
                WRONG("object %" PRIu32 " r%" PRIu32 " got too few writes: 0x%08" PRIx32
                      " is missing (instruction %" PRIu64 " of the isa engine)",
                      object, reg, b->q.expected[b->q.head[cell_of(b, object, reg)]].bits,
                      b->q.expected[b->q.head[cell_of(b, object, reg)]].cycle);
    if (stats[0].flags != stats[1].flags || stats[0].object_steps != stats[1].object_steps)
        WRONG("flags 0x%02" PRIx32 ", expected 0x%02" PRIx32 "; object-steps %" PRIu64
              ", expected %" PRIu64,
              stats[1].flags, stats[0].flags, stats[1].object_steps, stats[0].object_steps);
    if (!b->is_fast && b->config->counters)
        compare_counters(b, stats);
    if (!b->wrong)
        compare_objects(b, b->s.pool);
    if (!b->wrong)
        compare_status(b, 0);
}

/* Where one scheduler has the arithmetic, and nobody sleeps, each cycle is known beforehand; else
 * 0. */
static uint64_t predict(bench *b, uint32_t steps) {
    fp3_engine *engine = b->engine[1];
    const fp3_code *program = &fp3_engine_layout(engine)->groups[0].program;
    const uint32_t rows = fp3_placement_fullest(b->config, b->objects, 1);
    const uint32_t of = fp3_engine_definition(engine)->visit, visit = of && of < steps ? of : steps;
    if (b->is_fast || !b->config->interleave || fp3_config_schedulers(b->config) > 1 || !steps ||
        program->slept >= 0)
        return 0;
    fp3_swept swept = {program->decoded, program->count, program->step, program->last, visit};
    uint64_t expected = fp3_cycles_interleaved(b->config, rows, steps / visit, &swept);
    swept.steps = steps % visit;
    if (swept.steps)
        expected += fp3_cycles_interleaved(b->config, rows, 1, &swept) -
                    fp3_cycles_interleaved(b->config, rows, 0, &swept);
    return expected;
}

static void compare_cycles(bench *b, uint32_t steps, uint64_t got) {
    const uint64_t expected = b->config->counters ? predict(b, steps) : 0;
    b->predicted += expected != 0;
    if (expected && got != expected)
        WRONG("%" PRIu64 " cycles, predicted %" PRIu64 ": %" PRIu32 " objects, %" PRIu32
              " steps, visits of %" PRIu32,
              got, expected, b->objects, steps, fp3_engine_definition(b->engine[1])->visit);
}

/* ---- runs that end before their time ---- */

static void compare_part(bench *b, const fp3_stats stats[2]) {
    b->is_apart = 1;
    if (stats[1].flags & ~stats[0].flags)
        WRONG("flags 0x%02" PRIx32 " of a part, 0x%02" PRIx32 " of all", stats[1].flags,
              stats[0].flags);
    if (stats[1].object_steps)
        WRONG("%" PRIu64 " object-steps of a run that did not end", stats[1].object_steps);
    compare_status(b, 1);
}

/* The objects that are visited first have done everything before the illegal word. */
static void compare_first_visits(bench *b) {
    const fp3_members *group = &fp3_engine_layout(b->engine[1])->groups[0];
    if (fp3_config_schedulers(b->config) > 1 || group->program.slept >= 0)
        return;
    for (uint32_t object = 0; object < b->objects; object++)
        for (uint32_t reg = 0; reg < b->config->registers; reg++)
            if (object / group->columns < b->config->contexts && b->q.head[cell_of(b, object, reg)])
                WRONG("object %" PRIu32 " r%" PRIu32 " was not written before the illegal word",
                      object, reg);
}

/* What the hardware retired before an illegal word, the isa engine did as well, and nothing was
 * stored. */
static void end_at_illegal(bench *b, const fp3_stats stats[2]) {
    b->faults++;
    if (strcmp(b->error[0].text, b->error[1].text) != 0)
        WRONG("the end: got '%.200s', expected '%.200s'", b->error[1].text, b->error[0].text);
    if (b->config->interleave)
        compare_part(b, stats);
    else
        compare_end(b, stats);
    if (!b->wrong && b->config->interleave)
        compare_first_visits(b);
    if (!b->wrong)
        compare_objects(b, b->s.pool);
}

static void keep_round(bench *b) {
    const size_t size = (size_t)b->objects * b->config->registers;
    uint32_t *to = b->past.records + size * b->past.rounds++;
    for (uint32_t object = 0; object < b->objects; object++)
        for (uint32_t reg = 0; reg < b->s.pool; reg++)
            to[cell_of(b, object, reg)] = kept(b, 0, object, reg);
}

/* The isa engine makes the same rounds one by one. */
static fp3_status run_rounds(bench *b, uint32_t steps, fp3_stats *stats) {
    fp3_engine *isa = b->engine[0];
    const uint32_t visit =
        fp3_engine_definition(isa)->visit ? fp3_engine_definition(isa)->visit : steps;
    fp3_status status = FP3_OK;
    *stats = (fp3_stats){0};
    b->past.rounds = 0;
    keep_round(b);
    for (uint32_t left = steps, now; left && !status; left -= now) {
        fp3_stats round;
        now = left < visit ? left : visit;
        status = fp3_engine_run(isa, now, &round);
        stats->flags |= round.flags;
        keep_round(b);
    }
    return status;
}

static int is_as_in(bench *b, uint32_t round, uint32_t object) {
    const uint32_t *record = b->past.records + (size_t)b->objects * b->config->registers * round;
    for (uint32_t reg = 0; reg < b->s.pool; reg++)
        if (record[cell_of(b, object, reg)] != kept(b, 1, object, reg))
            return 0;
    return 1;
}

static void end_at_stop(bench *b, const fp3_stats stats[2]) {
    b->stops++;
    compare_part(b, stats);
    for (uint32_t object = 0; object < b->objects && !b->wrong; object++) {
        int found = 0;
        for (uint32_t round = 0; round < b->past.rounds && !found; round++)
            found = is_as_in(b, round, object);
        if (!found)
            WRONG("stopped: object %" PRIu32 " is as none of its visits left it", object);
    }
}

/* Stops the hardware somewhere, or near the end, where it stores. What it has in the end only part
 * of the objects have: all are written anew before they are looked at again. */
static void run_and_stop(bench *b, chance *c, uint32_t steps) {
    fp3_stats stats[2];
    fp3_engine *rtl = b->engine[1];
    const uint64_t limit = fp3_engine_definition(rtl)->cycle_limit;
    if (run_rounds(b, steps, &stats[0])) {
        b->wrong = b->error[0].text;
        return;
    }
    const fp3_code *program = &fp3_engine_layout(rtl)->groups[0].program;
    const uint64_t all = below(c, 2) ? predict(b, steps) : 0;
    const uint64_t end = 50 + (uint64_t)(program->count - program->last) * 2 * b->config->contexts;
    fp3_engine_definition(rtl)->cycle_limit =
        all ? all - below(c, (uint32_t)(end < all ? end : all))
            : 1 + below(c, below(c, 2) ? 100 : 3000);
    const fp3_status status = fp3_engine_run(rtl, steps, &stats[1]);
    fp3_engine_definition(rtl)->cycle_limit = limit;
    if (b->wrong)
        return;
    if (status == FP3_E_LIMIT)
        end_at_stop(b, stats);
    else if (status)
        b->wrong = b->error[1].text;
    else
        compare_objects(b, b->s.pool);
}

/* ---- a run ---- */

static void forget(bench *b) {
    memset(b->q.head, 0, (size_t)b->objects * b->config->registers * sizeof *b->q.head);
    b->q.count = 0;
    b->issued = 0;
}

/* Steps, steps per visit, the number of the first step. */
static uint32_t set_run(bench *b, chance *c) {
    const uint32_t steps = below(c, 40) ? 1 + below(c, STEPS_MAX) : 0;
    const uint32_t visit = below(c, 2) ? 0 : 1 + below(c, 3);
    const uint32_t kind = below(c, 8), clock = (uint32_t)next64(c);
    const uint32_t seed = b->config->storage && below(c, 2) ? (uint32_t)next64(c) : 0;
    for (int k = 0; k < 2; k++) {
        fp3_engine_definition(b->engine[k])->visit = visit;
        fp3_engine_definition(b->engine[k])->seed = seed;
        if (kind == 0)
            *fp3_engine_clock(b->engine[k]) = clock;
        if (kind == 1) /* it wraps */
            *fp3_engine_clock(b->engine[k]) = 0u - 1 - steps / 2;
    }
    forget(b);
    if (b->is_trace)
        printf("  run: %" PRIu32 " steps, visits of %" PRIu32 ", clock 0x%" PRIx32 "\n", steps,
               visit, *fp3_engine_clock(b->engine[0]));
    return steps;
}

static void run(bench *b, chance *c) {
    const uint32_t steps = set_run(b, c), first = *fp3_engine_clock(b->engine[0]);
    const int is_clear = below(c, 2) == 0;
    fp3_stats stats[2];
    fp3_status status[2];
    if (is_clear)
        clear_status(b);
    for (int k = 0; k < 2; k++) {
        b->error[k].text[0] = '\0';
        status[k] = fp3_engine_run(b->engine[k], steps, &stats[k]);
        if (b->is_trace)
            printf("  %s ends: status %d '%s'\n", k ? "rtl" : "isa", (int)status[k],
                   b->error[k].text);
        if (b->wrong)
            return;
    }
    if (!status[0] && !status[1])
        compare_failures(b, is_clear && b->config->status && (uint64_t)first + steps < 1u << 27);
    if (b->wrong)
        return;
    b->instructions += b->q.count;
    b->cycles += stats[1].counter[FP3_COUNTER_CYCLES];
    b->slept += !status[0] && stats[0].object_steps < (uint64_t)steps * b->objects;
    if (status[0] != status[1])
        WRONG("the end: got %d '%.200s', expected %d '%.200s'", (int)status[1], b->error[1].text,
              (int)status[0], b->error[0].text);
    if (status[0] == FP3_E_PROGRAM)
        end_at_illegal(b, stats);
    else if (status[0])
        b->wrong = b->error[0].text;
    else
        compare_end(b, stats);
    if (!status[0] && !b->wrong)
        compare_cycles(b, steps, stats[1].counter[FP3_COUNTER_CYCLES]);
}

static void run_stream(bench *b, chance *c) {
    do
        make_stream(c, &b->s, b->config, b->words);
    while (b->is_fast && b->s.illegal != NOWHERE);
    load(b);
    set_constants(b, c);
    set_objects(b, c, b->is_apart ? b->words : b->s.pool);
    if (b->is_apart || below(c, 4) == 0)
        clear_status(b);
    b->is_apart = 0;
    /* Where a program stores before its end, an object may be left with half of what it stores. */
    const int is_stopped = !b->is_fast && b->config->interleave && b->s.illegal == NOWHERE &&
                           b->s.make != COMPOSED && below(c, 6) == 0;
    for (uint32_t i = 0, runs = 1 + below(c, RUNS_MAX); i < runs && !b->is_apart && !b->wrong;
         i++) {
        if (i)
            disturb(b, c);
        if (!b->wrong)
            run(b, c);
    }
    if (is_stopped && !b->wrong)
        run_and_stop(b, c, set_run(b, c));
}

/* ---- sessions ---- */

/* Few, as many as there are contexts, or more, up to three times as many. */
static uint32_t how_many(chance *c, const fp3_config *config) {
    const uint32_t columns = fp3_config_schedulers(config) * config->lanes;
    const uint32_t records = config->store_words / 8;
    const uint32_t most = columns * (records < 65536 ? records : 65536);
    const uint32_t full = columns * config->contexts;
    const uint32_t enough = 2 * columns > OBJECTS_MAX     ? 2 * columns
                            : 3 * full <= 2 * OBJECTS_MAX ? 3 * full
                                                          : OBJECTS_MAX;
    const uint32_t picks[] = {1 + below(c, 2 * columns), full, 1 + below(c, 3 * full),
                              full + below(c, columns), 3 * full - below(c, full)};
    const uint32_t pick = picks[below(c, 5)];
    if (!config->interleave)
        return 1;
    return pick > most ? most : pick > enough ? enough : pick;
}

/* Whether its records could have 16 bits. */
static int may_halve(const fp3_config *config) {
    return config->interleave && !config->neighbours && !config->dual && !config->logarithmic &&
           !config->finite;
}

/* Both engines compute as another configuration would. */
static void vary(bench *b, chance *c) {
    for (int k = 0; k < 2 && !b->wrong; k++) {
        chance own = *c;
        fp3_config *config = fp3_engine_config(b->engine[k]);
        config->nearest = below(&own, 2);
        config->subnormal = below(&own, 2);
        if (config->mixed) /* needs both */
            config->nearest = config->subnormal = 1;
        config->finite = !config->nearest && !config->subnormal && !config->fused && below(&own, 4);
        config->flags = config->status || below(&own, 2);
        config->storage = may_halve(config) ? below(&own, 3) : 0;
        if (!config->finite && !config->logarithmic && !config->dual && !config->mixed &&
            below(&own, 4) == 0)
            config->fraction = 7 + below(&own, 17);
        b->varied = *config;
    }
    if (!b->wrong)
        b->config = &b->varied;
    next64(c);
}

static void open_session(bench *b, chance *c) {
    b->objects = how_many(c, b->config);
    for (int k = 0; k < 2 && !b->wrong; k++) {
        fp3_engine_def def = fp3_engine_default();
        def.engine = k ? b->other : "isa";
        def.config = b->config->name;
        def.objects = b->objects;
        def.cycle_limit = k && b->is_fast ? 0 : 10000000;
        def.retire = !k ? fill : b->is_fast ? NULL : take;
        def.trace = k && !b->is_fast ? count_issue : NULL;
        def.retire_user = def.trace_user = b;
        def.error = &b->error[k];
        if (fp3_engine_open(&def, &b->engine[k]))
            b->wrong = b->error[k].text;
    }
    if (b->is_varied)
        vary(b, c);
    const size_t cells = (size_t)b->objects * b->config->registers;
    b->q.room = 1024;
    b->q.expected = malloc(b->q.room * sizeof *b->q.expected);
    b->q.next = malloc(b->q.room * sizeof *b->q.next);
    b->q.head = calloc(cells, sizeof *b->q.head);
    b->q.tail = calloc(cells, sizeof *b->q.tail);
    b->past.records = malloc((STEPS_MAX + 1) * cells * sizeof *b->past.records);
    if (!b->q.expected || !b->q.next || !b->q.head || !b->q.tail || !b->past.records)
        b->wrong = "out of memory";
    b->is_apart = 1;
    if (!b->wrong)
        b->words = b->config->registers >> fp3_engine_layout(b->engine[0])->groups[0].log2
                       ? 1u << fp3_engine_layout(b->engine[0])->groups[0].log2
                       : b->config->registers;
    if (b->is_trace)
        printf("%" PRIu32 " objects, nearest %" PRIu32 ", subnormal %" PRIu32 ", flags %" PRIu32
               "\n",
               b->objects, b->config->nearest, b->config->subnormal, b->config->flags);
}

static void close_session(bench *b) {
    for (int k = 0; k < 2; k++)
        fp3_engine_close(&b->engine[k]);
    free(b->q.expected);
    free(b->q.next);
    free(b->q.head);
    free(b->q.tail);
    free(b->past.records);
}

static void run_session(bench *b, uint64_t seed) {
    chance c = {.state = seed};
    open_session(b, &c);
    for (int i = 0; i < STREAMS && !b->wrong && (i < STREAMS / 2 || b->instructions < b->enough);
         i++)
        run_stream(b, &c);
    if (!b->wrong && !b->is_apart) {
        compare_objects(b, b->words);
        compare_constants(b);
    }
    close_session(b);
}

static uint64_t number(const char *text) {
    char *end;
    const uint64_t value = strtoull(text, &end, 0);
    if (end != text && !*end && value > 0)
        return value;
    fprintf(stderr, "random_stream: '%s' is no number above 0\n", text);
    exit(2);
}

typedef struct {
    const char *program, *engine;
    uint64_t seed, instructions, sessions;
    int is_trace, is_varied;
} options;

/* Exit code. */
static int run_config(const options *o, const fp3_config *config) {
    static bench b;
    b = (bench){.other = o->engine,
                .is_fast = strcmp(o->engine, "fast") == 0,
                .is_varied = o->is_varied,
                .is_trace = o->is_trace,
                .enough = o->instructions};
    const uint64_t least = o->instructions / SESSION_INSTRUCTIONS;
    uint64_t n = 0;
    for (; n < o->sessions && (n < least || b.instructions < o->instructions); n++) {
        b.config = config;
        run_session(&b, o->seed + n);
        if (!b.wrong)
            continue;
        printf("FAIL %s, session %" PRIu64
               ": %s\n  replay: %s --engine %s%s --config %s --seed %" PRIu64
               " --streams 1 --trace\n",
               config->name, n, b.wrong, o->program, o->engine, o->is_varied ? " --vary" : "",
               config->name, o->seed + n);
        return 1;
    }
    const double part = b.instructions ? 100.0 / (double)b.instructions : 0;
    printf("%s: %" PRIu64 " instructions in %" PRIu64 " streams and %" PRIu64
           " cycles agree; %" PRIu64 " runs ended at an illegal word, %" PRIu64
           " were stopped, in %" PRIu64 " objects fell asleep, %" PRIu64
           " objects failed; %.0f%% NaN, %.0f%% subnormal\n",
           config->name, b.instructions, n * STREAMS, b.cycles, b.faults, b.stops, b.slept,
           b.failed, part * (double)b.nans, part * (double)b.subnormals);
    return 0;
}

int main(int argc, char **argv) {
    static const struct option table[] = {{"instructions", required_argument, NULL, 'i'},
                                          {"config", required_argument, NULL, 'c'},
                                          {"seed", required_argument, NULL, 's'},
                                          {"streams", required_argument, NULL, 'n'},
                                          {"engine", required_argument, NULL, 'e'},
                                          {"vary", no_argument, NULL, 'v'},
                                          {"trace", no_argument, NULL, 't'},
                                          {0}};
    options o = {.program = argv[0],
                 .engine = "rtl",
                 .seed = 1,
                 .instructions = 1200000,
                 .sessions = UINT64_MAX};
    const fp3_config *only = NULL;
    for (int key; (key = getopt_long(argc, argv, "", table, NULL)) != -1;)
        switch (key) {
        case 'i':
            o.instructions = number(optarg);
            break;
        case 'c':
            if (!(only = fp3_config_find(optarg))) {
                fprintf(stderr, "random_stream: no configuration '%s'\n", optarg);
                return 2;
            }
            break;
        case 's':
            o.seed = number(optarg);
            break;
        case 'n': /* a session is what a seed repeats */
            o.sessions = (number(optarg) + STREAMS - 1) / STREAMS;
            break;
        case 'e':
            o.engine = optarg;
            break;
        case 'v':
            o.is_varied = 1;
            break;
        case 't':
            o.is_trace = 1;
            break;
        default:
            return 2;
        }
    printf("seed %" PRIu64 "\n", o.seed);
    if (only)
        return run_config(&o, only);
    int code = 0;
    o.instructions = (o.instructions + fp3_config_count - 1) / fp3_config_count;
    for (uint32_t i = 0; i < fp3_config_count; i++)
        code |= run_config(&o, &fp3_configs[i]);
    return code;
}
