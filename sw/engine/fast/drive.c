/* SPDX-License-Identifier: Apache-2.0 */
/* drive.c - see drive.h. */
#include "drive.h"

#include "raised.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <string.h>

#define CHUNK 128u    /* steps from one look at the flags, and at who sleeps, to the next */
#define FIRST 16u     /* ... at first: subnormal numbers may be slow */
#define LONG 0x10000u /* ... without a progress callback */
/* What the processor may raise where the program does not. */
#define HINTS (FP3_FPU_IS_EARLY ? FP3_FLAG_UNDERFLOW : 0u)

/* So many steps of a visit, the first of them before + 1. */
typedef struct {
    unsigned parts; /* FP3_BEGINS, FP3_ENDS: with the first part, with the last */
    uint32_t steps, before;
} stretch;

/* Does something with each part of it. */
#define EACH_PART(s, make)                                                                         \
    if ((s)->parts & FP3_BEGINS)                                                                   \
        make(FP3_PART_FIRST, 1, (s)->before);                                                      \
    make(FP3_PART_STEP, (s)->steps, (s)->before);                                                  \
    if ((s)->parts & FP3_ENDS)                                                                     \
    make(FP3_PART_LAST, 1, (s)->before + (s)->steps)

/* ---- executing ---- */

static void execute(const fp3_drive *d, fp3_fast_lanes *lanes, const stretch *s) {
    const fp3_fast_place place = fp3_fast_place_of(lanes, d->run, d->fast);
    const fp3_fast *f = d->fast;
    lanes->seen = 0;
    lanes->is_awake &= !f->plan.sleeps;
#define MAKE(part, steps, number)                                                                  \
    (lanes->is_tiny ? f->sweep->run_tiny : f->sweep->run)(&f->plan, &place, part, steps, number)
    if (!lanes->is_tiny && fp3_fast_native_for(f, d->run->constants))
        f->native.stretch(&place, s->parts, s->steps, s->before);
    else {
        EACH_PART(s, MAKE);
    }
#undef MAKE
}

static void watch(const fp3_drive *d, fp3_fast_lanes *lanes, const stretch *s) {
    const fp3_fast_place place = fp3_fast_place_of(lanes, d->run, d->fast);
    lanes->is_awake &= !d->fast->plan.sleeps;
#define WATCH(part, steps, number)                                                                 \
    d->fast->sweep->watch(&d->fast->watch, &place, part, steps, number, &lanes->witness)
    EACH_PART(s, WATCH);
#undef WATCH
    fp3_fpu_forget(); /* it has computed more than the program */
}

/* ---- whose flags they are ---- */

/* What it takes to execute a stretch again: sets of rows that it reads, of those that it writes; of
 * words in records likewise. */
typedef struct {
    uint64_t read, written, words, stored;
} trace;

static trace trace_of(const fp3_drive *d, const stretch *s) {
    const fp3_fast_plan *plan = &d->fast->plan;
    trace t = {.read = s->parts & FP3_BEGINS ? plan->entered : plan->live};
    for (fp3_fast_part_number i = FP3_PART_FIRST; i < FP3_PARTS; i++) {
        if ((i == FP3_PART_FIRST && !(s->parts & FP3_BEGINS)) ||
            (i == FP3_PART_LAST && !(s->parts & FP3_ENDS)))
            continue;
        t.written |= plan->part[i].written;
        t.words |= plan->part[i].words;
        t.stored |= plan->part[i].stored;
    }
    return t;
}

/* Records are then as they were when the block was taken up. */
static int is_first(const fp3_drive *d, const stretch *s) {
    return s->parts & FP3_BEGINS && s->before == d->run->clock;
}

/* What a stretch starts from and does not leave as it is. */
static void remember(const fp3_drive *d, const stretch *s) {
    fp3_fast_worker *w = d->worker;
    const trace t = trace_of(d, s);
    const size_t size = d->lanes->count * sizeof(float);
    FP3_EACH_REGISTER (t.read &t.written, reg)
        memcpy(w->rows[reg], d->lanes->rows[reg], size);
    FP3_EACH_REGISTER (is_first(d, s) ? 0 : t.stored, reg)
        memcpy(w->records[reg], d->lanes->records[reg], size);
    if (d->fast->plan.sleeps)
        memcpy(w->awake, d->lanes->awake, d->lanes->count * sizeof *w->awake);
}

/* These lanes as they were. */
static void pick_remembered(const fp3_drive *d, const stretch *s, const uint32_t *which,
                            uint32_t count) {
    const trace t = trace_of(d, s);
    const uint32_t *lane = d->lanes->lane;
    fp3_fast_worker *w = d->worker;
    fp3_fast_lanes *to = &w->aside;
    fp3_fast_pick(d->lanes, which, count, t.read & ~t.written, t.words & ~t.stored, to);
    FP3_EACH_REGISTER (t.read &t.written, reg)
        for (uint32_t i = 0; i < count; i++)
            to->rows[reg][i] = w->rows[reg][which[i]];
    FP3_EACH_REGISTER (t.stored, reg) {
        for (uint32_t i = 0; i < count; i++)
            to->own[reg][i] =
                is_first(d, s) ? w->origin[reg][lane[which[i]]] : w->records[reg][which[i]];
        to->records[reg] = to->own[reg];
    }
    for (uint32_t i = 0; d->fast->plan.sleeps && i < count; i++)
        to->awake[i] = w->awake[which[i]];
    fp3_fast_fill(to, t.read, t.words);
    memset(&to->witness, 0, sizeof to->witness);
}

/* An object's status: flags, and the first step in which one of them was grave. */
static void note_status(const fp3_drive *d, uint32_t object, uint32_t flags, uint32_t failed) {
    uint32_t *word = d->run->status ? &d->run->status[object] : NULL;
    if (!word)
        return;
    *word |= flags;
    if (flags & FP3_FLAGS_GRAVE && !(*word >> FP3_STATUS_STEP_LO))
        *word |= failed << FP3_STATUS_STEP_LO;
}

/* The stretch once more, for those of whom what it raised is not known. */
static void find_out(const fp3_drive *d, const stretch *s, const uint32_t *which, uint32_t count) {
    fp3_fast_worker *w = d->worker;
    pick_remembered(d, s, which, count);
    watch(d, &w->aside, s);
    const fp3_witness *is = &w->aside.witness;
    for (uint32_t i = 0; i < count; i++) {
        d->lanes->known[which[i]] |= is->flags[i];
        d->lanes->grave[which[i]] |= is->grave[i];
        w->confirmed |= (uint32_t)is->flags[i];
        w->is_grave |= is->grave[i];
        note_status(d, d->lanes->object[which[i]], (uint32_t)is->flags[i], (uint32_t)is->failed[i]);
    }
    fp3_drive_know(d->run, d->lanes);
}

/* What the stretch raised, and is not known of a lane. Of an object that sleeps the processor
 * raises what the program does not, as where there are hints: there only what was found out counts.
 */
static uint32_t unknown_of(const fp3_drive *d, uint32_t lane, uint32_t flags) {
    const fp3_fast_lanes *l = d->lanes;
    const uint32_t *word = d->run->status ? &d->run->status[l->object[lane]] : NULL;
    const int has_step = !word || *word >> FP3_STATUS_STEP_LO; /* the first part's may be 0 */
    const uint32_t grave = flags & FP3_FLAGS_GRAVE & ~(has_step ? (uint32_t)l->grave[lane] : 0);
    const uint32_t others = flags & ~FP3_FLAGS_GRAVE & ~(uint32_t)l->known[lane];
    const uint32_t all =
        flags & (d->fast->plan.sleeps ? UINT32_MAX : HINTS) & ~d->worker->confirmed;
    return grave | (d->run->status ? others : 0) | all;
}

void fp3_drive_know(const fp3_fast_run *run, fp3_fast_lanes *l) {
    uint32_t common = UINT32_MAX;
    const size_t count = run->status ? l->count : 0;
    const uint32_t *word = count ? &run->status[l->first] : NULL;
    if (l->is_dense)
        for (size_t i = 0; i < count; i++)
            common &= word[i];
    else
        for (uint32_t i = 0; i < count; i++)
            common &= run->status[fp3_fast_object(l, i)];
    l->common = common & ~FP3_FLAGS_GRAVE;
}

/* Whoever is awake after a stretch has been awake in all of it. */
static int are_all_awake(const fp3_fast_lanes *l) {
    int is_any_asleep = 0;
    for (uint32_t i = 0; i < l->count; i++)
        is_any_asleep |= !l->awake[i];
    return !is_any_asleep;
}

static void ask_flags(const fp3_drive *d, const stretch *s, uint32_t flags) {
    const uint32_t hints = d->lanes->seen & FP3_SEEN_UNDERFLOW ? 0 : HINTS;
    uint32_t which[FP3_BLOCK], count = 0;
    if (!d->fast->plan.sleeps || (flags & ~d->worker->confirmed && are_all_awake(d->lanes)))
        d->worker->confirmed |= flags & ~hints;
    if (!(flags & ~(d->lanes->common & d->worker->confirmed)))
        return;
    fp3_fast_count(d->lanes, d->run->status);
    for (uint32_t i = 0; i < d->lanes->count; i++) {
        which[count] = i;
        count += unknown_of(d, i, flags) != 0;
    }
    if (count)
        find_out(d, s, which, count);
}

/* A product may be slow from now on, or no more. */
static void look_for_subnormals(fp3_fast_lanes *l) {
    l->is_tiny =
        l->is_tiny ? (l->seen & FP3_SEEN_SUBNORMAL) != 0 : (fp3_fpu_get() & FP3_FPU_SLOW) != 0;
}

static void make(const fp3_drive *d, const stretch *s) {
    if (d->is_watching) {
        watch(d, d->lanes, s);
    } else if (!d->fast->plan.config->flags) {
        fp3_fpu_forget();
        execute(d, d->lanes, s);
        look_for_subnormals(d->lanes);
    } else {
        remember(d, s);
        fp3_fpu_forget();
        execute(d, d->lanes, s);
        const uint32_t flags = fp3_fast_raised(d->lanes->seen);
        look_for_subnormals(d->lanes);
        ask_flags(d, s, flags);
    }
}

/* ---- who sleeps ---- */

static uint32_t find(const fp3_fast_lanes *lanes, int awake, uint32_t *which) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < lanes->count; i++) {
        which[count] = i;
        count += lanes->awake[i] == awake;
    }
    return count;
}

/* What moves with a lane: words of its record, with those states that no visit touches where
 * somebody looks at them; rows. */
static uint64_t words_of(const fp3_drive *d) {
    const fp3_fast_plan *p = &d->fast->plan;
    const int looks = d->is_watching && p->config->interleave;
    return p->read | p->stored | (looks ? d->fast->watch.states : 0);
}

static uint64_t all_rows(const fp3_drive *d) {
    const fp3_fast_plan *p = &d->fast->plan;
    return p->config->interleave ? p->live | d->fast->watch.states : UINT64_MAX;
}

/* Lanes whose records are columns cannot be moved. */
static void detach(const fp3_drive *d) {
    fp3_fast_lanes *l = d->lanes;
    FP3_EACH_REGISTER (l->is_direct ? words_of(d) : 0, reg) {
        memcpy(l->own[reg], l->records[reg], l->count * sizeof *l->own[reg]);
        l->records[reg] = l->own[reg];
    }
    l->is_direct = 0;
}

static void take_out(const fp3_drive *d, const uint32_t *which, uint32_t count) {
    fp3_fast_lanes *to = &d->worker->leaving;
    fp3_fast_pick(d->lanes, which, count, all_rows(d), words_of(d), to);
    fp3_fast_pick_witness(d->lanes, which, count, to);
}

/* Those of lanes that sleep are through. In the middle of a visit they make its last part now. */
static void let_go(const fp3_drive *d, int is_in_visit, uint32_t end) {
    uint32_t asleep[FP3_BLOCK], awake[FP3_BLOCK];
    const uint32_t count = find(d->lanes, 0, asleep), others = find(d->lanes, -1, awake);
    fp3_drive of = *d;
    if (!count)
        return;
    fp3_fast_count(d->lanes, d->run->status);
    detach(d);
    take_out(d, asleep, count);
    of.lanes = &d->worker->leaving;
    if (is_in_visit)
        make(&of, &(stretch){FP3_ENDS, 0, end});
    for (uint32_t i = 0; !d->is_watching && d->run->slept_in && i < count; i++)
        d->run->slept_in[of.lanes->object[i]] = d->run->number;
    d->settle(d->user, of.lanes);
    fp3_fast_keep(d->lanes, awake, others, all_rows(d), words_of(d));
}

/* Whose word for sleep is not 0 makes no visit: its program wrote the word itself. */
static void leave_out(const fp3_drive *d) {
    const fp3_fast_plan *p = &d->fast->plan;
    fp3_fast_lanes *l = d->lanes;
    if (!p->has_lds || !(p->written >> p->slept & 1))
        return;
    const uint32_t *word = (const uint32_t *)(const void *)l->records[p->slept];
    for (uint32_t i = 0; i < l->count; i++)
        l->awake[i] = word[i] ? 0 : -1;
    l->is_awake = 0;
    let_go(d, 0, 0);
}

/* ---- a run ---- */

/* Nothing that is still to come changes what is known of the lanes' failures. */
static int is_settled(const fp3_drive *d) {
    const fp3_fast_lanes *l = d->lanes;
    for (uint32_t i = 0; i < l->count; i++)
        if (!d->is_watching || !l->witness.is_raised[i] ||
            (l->known[i] && !l->witness.is_strayed[i]))
            return 0;
    return 1;
}

/* New objects raise inexact in their first step, and all know it then. */
static uint32_t chunk_of(const fp3_drive *d, uint32_t number, uint32_t left) {
    const fp3_fast_plan *p = &d->fast->plan;
    uint32_t most = p->config->flags || p->sleeps || d->is_watching ? CHUNK : LONG;
    const uint32_t begun = number - d->run->clock;
    most = d->lanes->is_tiny ? CHUNK : begun < most ? begun + FIRST : most;
    if (number == d->run->clock && d->run->status && !(d->lanes->common & FP3_FLAG_INEXACT))
        most = 1;
    return left < most ? left : most;
}

/* Those who sleep leave when it is worth it. Returns 1 if all of them do: they are at the end of
 * the visit. */
static int is_over(const fp3_drive *d, uint32_t end) {
    uint32_t which[FP3_BLOCK];
    const uint32_t count = d->lanes->count; /* before some leave */
    const uint32_t asleep = d->fast->plan.sleeps ? find(d->lanes, 0, which) : 0;
    if (asleep == count)
        make(d, &(stretch){FP3_ENDS, 0, end});
    else if (asleep * 4 >= count)
        let_go(d, 1, end);
    return asleep == count;
}

static void visit(const fp3_drive *d, uint32_t number, uint32_t end) {
    stretch s = {.parts = FP3_BEGINS};
    fp3_fast_wake(d->lanes);
    if (d->is_watching)
        memset(d->lanes->witness.ahead, 0, sizeof d->lanes->witness.ahead);
    leave_out(d);
    while (number != end && d->lanes->count && !is_settled(d)) {
        s.steps = chunk_of(d, number, end - number);
        s.before = number;
        number += s.steps;
        s.parts |= number == end ? FP3_ENDS : 0;
        make(d, &s);
        s.parts = 0;
        if (d->run->tell && !d->is_watching)
            d->run->tell(d->run->user, number - d->run->clock);
        if (number != end && is_over(d, end))
            break;
    }
    if (d->fast->plan.sleeps)
        let_go(d, 0, end);
}

void fp3_drive_run(fp3_drive *d) {
    for (uint32_t made = 0; made < d->run->steps && d->lanes->count && !is_settled(d);) {
        const uint32_t left = d->run->steps - made;
        const uint32_t steps = left < d->run->visit ? left : d->run->visit;
        visit(d, d->run->clock + made, d->run->clock + made + steps);
        made += steps;
    }
    if (d->lanes->count)
        d->settle(d->user, d->lanes);
}
