/* SPDX-License-Identifier: Apache-2.0 */
/* fast.c - see fast.h: a program made ready, and a block of objects taken through a run. */
#include "fast.h"

#include "base/fpu.h"
#include "block.h"
#include "drive.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <machine/estimate.h>
#include <machine/execute.h>
#include <machine/live.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN 40 /* characters shown of an unknown word */

/* ---- a program ---- */

fp3_status fp3_fast_wished(fp3_fast_wish *w, fp3_error *error) {
    static const char separators[] = ",";
    const char *asked = secure_getenv("FP3_FAST");
    *w = (fp3_fast_wish){0};
    for (; asked && *asked; asked += strspn(asked, separators)) {
        const size_t length = strcspn(asked, separators);
        char word[16];
        snprintf(word, sizeof word, "%.*s", (int)length, asked);
        if (!strcmp(word, "interpreter"))
            w->is_interpreted = 1;
        else if (length < sizeof word && fp3_sweep_is_kind(word))
            memcpy(w->most, word, sizeof word);
        else
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "FP3_FAST: found '%.*s', expected interpreter, %s",
                            (int)(length < SHOWN ? length : SHOWN), asked, fp3_sweep_kinds);
        asked += length;
    }
    return FP3_OK;
}

/* The processor has none of these operations, or not `rcp` and `rsqrt`. */
static int lacks_native(const fp3_config *config) {
    return fp3_execute_is_of_words(config) || config->mixed;
}

/* Its flags are those of the processor, which must have some. */
static void open_native(fp3_fast *f, int is_interpreted, int may_compile) {
    fp3_error why = {.text = "asked for"};
    fp3_status status = FP3_E_SYSTEM;
    if (FP3_FPU_IS_SOFT)
        fp3_fail(&why, FP3_E_SYSTEM, "no flags here");
    else if (lacks_native(f->plan.config))
        fp3_fail(&why, FP3_E_SYSTEM, "the processor lacks arithmetic of '%s'",
                 f->plan.config->name);
    else if (!is_interpreted && !f->native.library)
        status = fp3_fast_native_open(&f->plan, f->sweep->name, may_compile, &f->native, &why);
    if (status && !f->native.library)
        snprintf(f->how, sizeof f->how, "interpreter %s (%.120s)", f->sweep->name, why.text);
    else
        snprintf(f->how, sizeof f->how,
                 *f->native.no_cache ? "native %s (no cache: %s)" : "native %s", f->sweep->name,
                 f->native.no_cache);
}

static fp3_status no_native(const fp3_fast *f, const char *path, fp3_error *error) {
    return fp3_fail(
        error, FP3_E_ARGUMENT,
        "%s: configuration '%s' has no native code, as the processor lacks its arithmetic", path,
        f->plan.config->name);
}

/* Of a lesser kind of processor than this one, maybe. */
static fp3_status open_file(fp3_fast *f, const char *path, fp3_error *error) {
    fp3_fast_kind kind;
    if (FP3_FPU_IS_SOFT)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: native code needs a processor with flags",
                        path);
    if (lacks_native(f->plan.config))
        return no_native(f, path, error);
    fp3_status status = fp3_fast_native_kind(path, &kind, error);
    if (status)
        return status;
    f->sweep = fp3_sweep_choose(f->plan.config, kind.name);
    if (strcmp(f->sweep->name, kind.name) != 0)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s is native code for %s; this processor is %s at most", path, kind.name,
                        f->sweep->name);
    return fp3_fast_native_load(&f->plan, path, f->sweep->name, &f->native, error);
}

fp3_status fp3_fast_make(const fp3_fast_def *def, fp3_fast **fast, fp3_error *error) {
    fp3_fast_wish w;
    fp3_fast *f = *fast = calloc(1, sizeof *f);
    if (!f)
        return fp3_no_memory(error);
    fp3_status status = fp3_fast_wished(&w, error);
    if (!status)
        status =
            fp3_fast_plan_make(def->config, def->code, def->states, def->around, &f->plan, error);
    f->sweep = fp3_sweep_choose(def->config, w.most);
    if (!status && FP3_FPU_IS_SOFT && !def->config->nearest)
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "configuration '%s' truncates, and engine 'fast' only rounds to nearest "
                          "here: engine 'isa' does both",
                          def->config->name);
    if (!status && def->native && !def->is_interpreted && !w.is_interpreted)
        status = open_file(f, def->native, error);
    if (status) {
        fp3_fast_free(fast);
        return status;
    }
    f->watch = (fp3_watch_plan){&f->plan, def->is_ahead, def->states, fp3_live_between(def->code)};
    fp3_estimate_table(f->table);
    fp3_table_finish(f->table);
    if (!f->sweep->are_estimates_exact(f->table))
        f->table[FP3_AT_ABOVE] = 0; /* they are looked up */
    open_native(f, def->is_interpreted || w.is_interpreted, !def->is_without_compiler);
    return FP3_OK;
}

fp3_status fp3_fast_check(const fp3_fast_def *def, fp3_error *error) {
    fp3_fast_def dry = *def;
    fp3_fast *fast = NULL;
    dry.is_interpreted |= !def->native; /* nothing is compiled for it */
    const fp3_status status = fp3_fast_make(&dry, &fast, error);
    fp3_fast_free(&fast);
    return status;
}

fp3_status fp3_fast_write_native(const fp3_fast *f, const char *path, fp3_error *error) {
    if (lacks_native(f->plan.config))
        return no_native(f, path, error);
    return fp3_fast_native_write(&f->plan, path, f->sweep->name, error);
}

void fp3_fast_free(fp3_fast **fast) {
    if (!*fast)
        return;
    fp3_fast_native_close(&(*fast)->native);
    fp3_fast_plan_free(&(*fast)->plan);
    free(*fast);
    *fast = NULL;
}

const char *fp3_fast_how(const fp3_fast *fast) { return fast->how; }

int fp3_fast_is_native(const fp3_fast *fast) { return fast->native.library != NULL; }

/* Where nothing interleaves an object keeps all registers, and they are its record. */
static uint64_t rows_in(const fp3_fast *f) {
    const fp3_fast_plan *p = &f->plan;
    const uint64_t set =
        p->written | (p->slept < 0 ? 0 : (uint64_t)1 << p->slept) | p->entered | p->live;
    return p->config->interleave
               ? 0
               : set &
                     (((p->config->registers < 64) ? (uint64_t)1 << p->config->registers : 0) - 1);
}

uint64_t fp3_fast_columns(const fp3_fast *f) {
    return rows_in(f) | f->plan.read | f->plan.stored | f->watch.states;
}

/* ---- a worker ---- */

fp3_status fp3_fast_worker_make(fp3_fast_worker **worker, fp3_error *error) {
    *worker = aligned_alloc(64, (sizeof **worker + 63) / 64 * 64);
    if (!*worker)
        return fp3_no_memory(error);
    memset(*worker, 0, sizeof **worker);
    return FP3_OK;
}

void fp3_fast_worker_free(fp3_fast_worker **worker) {
    if (*worker)
        free((*worker)->failures);
    free(*worker);
    *worker = NULL;
}

uint32_t fp3_fast_flags(fp3_fast_worker *worker) { return worker->confirmed; }

size_t fp3_fast_failures(const fp3_fast_worker *worker, const fp3_failed **failures) {
    *failures = worker->failures;
    return worker->failure_count;
}

void fp3_fast_forget(fp3_fast_worker *worker) {
    worker->confirmed = 0;
    worker->failure_count = 0;
}

/* ---- a block ---- */

typedef struct {
    const fp3_fast *fast;
    fp3_fast_worker *worker;
    const fp3_fast_run *run;
    fp3_error *error;
    fp3_status status;
} block;

static uint64_t words(const fp3_fast *f) { return f->plan.read | f->plan.stored; }

static int is_interleaved(const fp3_fast *f) { return f->plan.config->interleave != 0; }

/* What a run changes of an object. */
static uint64_t changed(const fp3_fast *f) {
    return is_interleaved(f) ? f->plan.stored : rows_in(f);
}

static void begin(fp3_fast_lanes *l, const uint32_t *list, uint32_t first, uint32_t count) {
    l->list = list;
    l->first = list ? list[0] : first;
    l->count = count;
    l->is_counted = l->is_tiny = 0;
    l->is_dense = !list || list[count - 1] - list[0] == count - 1; /* it ascends */
}

/* Objects side by side in whole vectors need no copy; nor do the last ones of all. */
static int is_direct(const block *b) {
    const fp3_fast_lanes *l = &b->worker->now;
    const int is_last = l->first % 16 == 0 && l->first + l->count == b->run->objects;
    return is_interleaved(b->fast) && l->is_dense && (l->count % 16 == 0 || is_last);
}

static void take_up(const block *b) {
    fp3_fast_worker *w = b->worker;
    fp3_fast_lanes *l = &w->now;
    fp3_drive_know(b->run, l);
    l->is_direct = is_direct(b);
    FP3_EACH_REGISTER (words(b->fast), reg)
        l->records[reg] =
            l->is_direct ? (float *)(void *)(b->run->columns[reg] + l->first) : l->own[reg];
    if (!l->is_direct)
        fp3_fast_gather(l, l->own, b->run->columns, words(b->fast));
    fp3_fast_gather(l, l->rows, b->run->columns, rows_in(b->fast));
    fp3_fast_gather(l, w->origin, b->run->columns, changed(b->fast));
    fp3_fast_fill(l, rows_in(b->fast), words(b->fast));
}

/* ---- who failed ---- */

/* The words of a state, lane by lane: where it is when a run has ended. */
static const float *state_of(const block *b, const fp3_fast_lanes *l, uint32_t reg) {
    if (!is_interleaved(b->fast))
        return l->rows[reg];
    return words(b->fast) >> reg & 1 ? l->records[reg] : NULL;
}

static int is_finite(uint32_t bits) { return (~bits & 0x7f800000u) != 0; }

/* One that no visit touches is what the host wrote. */
static int is_astray(const block *b, const fp3_fast_lanes *l, uint32_t lane, uint32_t reg) {
    const float *row = state_of(b, l, reg);
    uint32_t bits = b->run->columns[reg][fp3_fast_object(l, lane)];
    if (row)
        memcpy(&bits, &row[lane], sizeof bits);
    return !is_finite(bits);
}

static void suspect(const block *b, const fp3_fast_lanes *l, uint32_t lane, int astray) {
    fp3_fast_worker *w = b->worker;
    w->suspects[w->suspect_count++] = (fp3_fast_suspect){l->lane[lane], astray};
}

static int is_any_astray(const block *b, const fp3_fast_lanes *l) {
    int is_any = 0;
    FP3_EACH_REGISTER (b->fast->watch.states, reg) {
        const float *row = state_of(b, l, reg);
        if (row)
            is_any |= b->fast->sweep->is_any_astray(row, l->count);
        else
            for (uint32_t i = 0; i < l->count; i++)
                is_any |= is_astray(b, l, i, reg);
    }
    return is_any;
}

static void look_for_failures(const block *b, fp3_fast_lanes *l) {
    if (!is_any_astray(b, l) && !b->worker->is_grave)
        return;
    fp3_fast_count(l, b->run->status);
    for (uint32_t i = 0; i < l->count; i++) {
        int astray = 0;
        FP3_EACH_REGISTER (b->fast->watch.states, reg)
            astray |= is_astray(b, l, i, reg);
        if (astray || l->grave[i])
            suspect(b, l, i, astray);
    }
}

/* Registers that nothing stores are as the processor left them: a NaN becomes the one of the
 * machine. */
static void make_one_nan(const block *b, const fp3_fast_lanes *l) {
    if (is_interleaved(b->fast) || b->fast->plan.sleeps || b->fast->plan.config->finite)
        return;
    FP3_EACH_REGISTER (b->fast->plan.written, reg)
        for (uint32_t i = 0; i < l->count; i++) {
            uint32_t *word = &b->run->columns[reg][fp3_fast_object(l, i)];
            *word = (*word & 0x7fffffffu) > 0x7f800000u ? FP3_BITS_NAN : *word;
        }
}

/* Objects that are through. */
static void settle(void *user, fp3_fast_lanes *l) {
    const block *b = user;
    const float *from[FP3_BANK_OBJECT_COUNT];
    const uint64_t moved = l->is_direct ? 0 : changed(b->fast);
    look_for_failures(b, l);
    FP3_EACH_REGISTER (moved, reg)
        from[reg] = is_interleaved(b->fast) ? l->records[reg] : l->rows[reg];
    fp3_fast_scatter(l, from, b->run->columns, moved);
    make_one_nan(b, l);
}

/* ---- the failures once more, with a witness ---- */

static void begin_again(const block *b) {
    fp3_fast_worker *w = b->worker;
    fp3_fast_lanes *l = &w->again;
    uint32_t list[FP3_BLOCK];
    for (uint32_t i = 0; i < w->suspect_count; i++)
        list[i] = w->list ? w->list[w->suspects[i].lane] : w->first + w->suspects[i].lane;
    begin(l, list, 0, w->suspect_count);
    l->is_dense = 0; /* those who fall asleep come before others */
    fp3_fast_count(l, NULL);
    l->list = NULL;
    float(*to)[FP3_BLOCK] = is_interleaved(b->fast) ? l->own : l->rows;
    l->is_direct = 0;
    fp3_fast_wake(l);
    memset(&l->witness, 0, sizeof l->witness);
    const uint64_t all = fp3_fast_columns(b->fast);
    fp3_fast_gather(l, to, b->run->columns, all & ~changed(b->fast));
    for (uint32_t i = 0; i < l->count; i++) {
        l->known[i] = w->suspects[i].is_astray;
        FP3_EACH_REGISTER (changed(b->fast), reg)
            to[reg][i] = w->origin[reg][w->suspects[i].lane];
    }
    FP3_EACH_REGISTER (all, reg)
        l->records[reg] = l->own[reg];
    FP3_EACH_REGISTER (is_interleaved(b->fast) ? b->fast->watch.states : 0, reg)
        memcpy(l->rows[reg], to[reg], sizeof l->rows[reg]);
    fp3_fast_fill(l, all, all);
}

/* States that were not finite before the run. */
static void look_before(const block *b) {
    fp3_fast_lanes *l = &b->worker->again;
    FP3_EACH_REGISTER (b->fast->watch.states, reg)
        for (uint32_t i = 0; i < l->count; i++) {
            uint32_t bits;
            memcpy(&bits, &l->rows[reg][i], sizeof bits);
            if (is_finite(bits) || l->witness.is_strayed[i])
                continue;
            l->witness.is_strayed[i] = -1;
            l->witness.strayed[i] = (int)b->run->clock;
            l->witness.reg[i] = (int)reg;
            l->witness.bits[i] = (int)bits;
        }
}

static fp3_failed failure_of(const block *b, const fp3_fast_lanes *l, uint32_t i) {
    const fp3_witness *w = &l->witness;
    const uint32_t clock = b->run->clock;
    return (fp3_failed){l->object[i],
                        {.is_astray = l->known[i],
                         .raised = w->is_raised[i] ? (uint32_t)w->raised[i] - clock : FP3_NEVER,
                         .strayed = w->is_strayed[i] ? (uint32_t)w->strayed[i] - clock : FP3_NEVER,
                         .flags = (uint32_t)w->raised_flags[i],
                         .reg = (uint32_t)w->reg[i],
                         .bits = (uint32_t)w->bits[i]}};
}

static int grow(block *b) {
    fp3_fast_worker *w = b->worker;
    if (w->failure_count < w->failure_room)
        return 1;
    const size_t room = w->failure_room ? 2 * w->failure_room : FP3_BLOCK;
    fp3_failed *more = realloc(w->failures, room * sizeof *more);
    if (!more) {
        b->status = fp3_no_memory(b->error);
        return 0;
    }
    w->failures = more;
    w->failure_room = room;
    return 1;
}

/* Without `flags` states alone tell a failure. */
static void settle_again(void *user, fp3_fast_lanes *l) {
    block *b = user;
    for (uint32_t i = 0; i < l->count; i++) {
        const fp3_failed f = failure_of(b, l, i);
        const int is_raised = f.watched.raised != FP3_NEVER && b->fast->plan.config->flags;
        if ((f.watched.is_astray || is_raised) && grow(b))
            b->worker->failures[b->worker->failure_count++] = f;
    }
}

fp3_status fp3_fast_block(fp3_fast *fast, fp3_fast_worker *worker, const fp3_fast_run *run,
                          const uint32_t *list, uint32_t first, uint32_t count, fp3_error *error) {
    block b = {fast, worker, run, error, FP3_OK};
    const uint64_t callers = fp3_fpu_begin(fast->plan.config->nearest);
    fp3_drive drive = {fast, worker, run, &worker->now, 0, settle, &b};
    begin(&worker->now, list, first, count);
    worker->list = list;
    worker->first = first;
    take_up(&b);
    worker->suspect_count = 0;
    worker->is_grave = 0;
    fp3_drive_run(&drive);
    if (worker->suspect_count) {
        begin_again(&b);
        look_before(&b);
        drive = (fp3_drive){fast, worker, run, &worker->again, 1, settle_again, &b};
        fp3_drive_run(&drive);
    }
    fp3_fpu_set(callers);
    return b.status;
}
