/* SPDX-License-Identifier: Apache-2.0 */
/* around.c - see around.h. */
#include "around.h"

#include "block.h"
#include "raised.h"

#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

/* ---- a program ---- */

unsigned fp3_fast_native_lanes(const fp3_fast *fast) {
    return fast->native.library ? fast->sweep->lanes : 0;
}

size_t fp3_fast_records(const fp3_fast *fast, uint32_t objects) {
    return ((size_t)objects + FP3_BLOCK) * fp3_fast_record(&fast->plan);
}

uint32_t fp3_fast_phases(const fp3_fast *fast) {
    return fast->plan.around.is_any ? fast->plan.around.distinct : 0;
}

uint32_t fp3_fast_made(const fp3_fast *fast) {
    return fast->plan.around.is_any ? fast->plan.around.phases : 0;
}

uint32_t fp3_fast_phase_at(const fp3_fast *fast, uint32_t n) { return fast->plan.order[n]; }

uint64_t fp3_fast_doubled(const fp3_fast *fast) {
    return fast->plan.around.published & fast->plan.stored;
}

/* ---- interpreted ---- */

typedef struct {
    const fp3_fast *fast;
    const fp3_fast_group *group;
    fp3_fast_worker *worker;
    fp3_fast_lanes *lanes;
    uint32_t first; /* object of lane 0 */
    fp3_fast_run run;
} interpreter;

static void run_words(const interpreter *in, fp3_fast_lanes *lanes, uint32_t first, uint32_t end) {
    const fp3_fast_place place = fp3_fast_place_of(lanes, &in->run, in->fast);
    if (first < end)
        in->fast->sweep->run_words(&in->fast->plan, &place, first, end);
}

/* Whether an object has a neighbour at this turn. */
static int has(const fp3_fast_given *list, uint32_t object, uint32_t turn) {
    return list->begin ? turn < list->begin[object + 1] - list->begin[object]
                       : turn >= list->first && turn != object;
}

/* A word of the neighbours of these lanes, or a field, to this row. which: lanes of the block. */
static void look(const interpreter *in, const fp3_fast_given *list, const fp3_fast_word *word,
                 uint32_t turn, const uint32_t *which, fp3_fast_lanes *to, uint32_t row) {
    for (uint32_t i = 0; i < to->count; i++) {
        const size_t at = list->begin ? list->begin[in->first + which[i]] + (size_t)turn : 0;
        const void *from =
            word->gives == FP3_GIVES_FIELD
                ? &list->field[at * list->fields + word->number]
                : &in->group->own[word->number][list->begin ? list->other[at] : turn];
        memcpy(&to->rows[row][i], from, sizeof(float));
    }
    fp3_fast_fill_row(to, row);
}

/* A field of the entries of these lanes. */
static void remember(const interpreter *in, const fp3_fast_given *list, const fp3_fast_word *word,
                     uint32_t turn, const uint32_t *which, const fp3_fast_lanes *from) {
    for (uint32_t i = 0; i < from->count; i++) {
        const size_t at = list->begin[in->first + which[i]] + (size_t)turn;
        const float value = from->rows[word->in.d][i];
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        if (word->is_one_nan && (bits & 0x7fffffffu) > 0x7f800000u)
            bits = FP3_BITS_NAN;
        list->field[at * list->fields + word->number] = bits;
    }
}

static void run_body(const interpreter *in, const fp3_fast_loop *loop, uint32_t turn,
                     const uint32_t *which, fp3_fast_lanes *lanes) {
    const fp3_fast_given *list = &in->group->lists[loop->list].given;
    for (uint32_t pc = loop->first; pc < loop->end; pc++) {
        const fp3_fast_word *word = &in->fast->plan.code[pc];
        const int is_load = word->in.op == FP3_OP_LDN || word->in.op == FP3_OP_LDL;
        if (word->gives != FP3_GIVES_NOTHING)
            look(in, list, word, turn, which, lanes, is_load ? word->in.d : FP3_BANK_OBJECT_COUNT);
        if (word->in.op == FP3_OP_STL)
            remember(in, list, word, turn, which, lanes);
        else if (!is_load)
            run_words(in, lanes, pc, pc + 1);
    }
}

/* The lanes that have a neighbour for this turn. */
static uint32_t find_living(const interpreter *in, const fp3_fast_given *list, uint32_t turn,
                            uint32_t *which) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < in->lanes->count; i++)
        if (has(list, in->first + i, turn))
            which[count++] = i;
    return count;
}

/* Of the longest list in the block. */
static uint32_t turns_in_block(const interpreter *in, const fp3_fast_given *list) {
    uint32_t most = list->begin ? 0 : list->end;
    for (uint32_t i = in->first; list->begin && i < in->first + in->lanes->count; i++)
        if (list->begin[i + 1] - list->begin[i] > most)
            most = list->begin[i + 1] - list->begin[i];
    return most;
}

/* Where only some have a neighbour these are taken aside, so that nothing is computed, and no flag
 * raised, for the others. */
static void run_loop(const interpreter *in, const fp3_fast_loop *loop) {
    fp3_fast_lanes *all = in->lanes, *some = &in->worker->aside;
    const uint64_t taken = loop->outside | loop->kept;
    const fp3_fast_given *list = &in->group->lists[loop->list].given;
    const uint32_t turns = turns_in_block(in, list);
    uint32_t which[FP3_BLOCK];
    for (uint32_t turn = 0; turn < turns; turn++) {
        const uint32_t count = find_living(in, list, turn, which);
        if (count == 0)
            continue;
        if (count == all->count) {
            run_body(in, loop, turn, which, all);
            continue;
        }
        some->count = count;
        FP3_EACH_REGISTER (taken, reg)
            for (uint32_t i = 0; i < count; i++)
                some->rows[reg][i] = all->rows[reg][which[i]];
        fp3_fast_fill(some, taken, 0);
        run_body(in, loop, turn, which, some);
        FP3_EACH_REGISTER (loop->kept, reg)
            for (uint32_t i = 0; i < count; i++)
                all->rows[reg][which[i]] = some->rows[reg][i];
    }
    fp3_fast_fill(all, loop->kept, 0);
}

static void point(const interpreter *in, uint32_t *const *columns, uint64_t set) {
    FP3_EACH_REGISTER (set, reg)
        in->lanes->records[reg] = in->lanes->own[reg];
    FP3_EACH_REGISTER (set, reg)
        memcpy(in->lanes->own[reg], columns[reg] + in->first, in->lanes->count * sizeof(uint32_t));
    fp3_fast_fill(in->lanes, 0, set);
}

static void write_back(const interpreter *in, uint64_t set) {
    FP3_EACH_REGISTER (set, reg)
        memcpy(in->group->next[reg] + in->first, in->lanes->own[reg],
               in->lanes->count * sizeof(uint32_t));
}

static void interpret(const interpreter *in, uint32_t phase) {
    const fp3_fast_plan *plan = &in->fast->plan;
    uint64_t read = 0, stored = 0;
    for (uint32_t pc = plan->phase[phase]; pc < plan->phase[phase + 1]; pc++) {
        const fp3_instruction *word = &plan->code[pc].in;
        read |= word->op == FP3_OP_LD ? UINT64_C(1) << word->d : 0;
        stored |= word->op == FP3_OP_ST ? UINT64_C(1) << word->d : 0;
    }
    FP3_EACH_REGISTER (read | stored, reg)
        in->lanes->records[reg] = in->lanes->own[reg];
    point(in, in->group->own, read);
    for (uint32_t pc = plan->phase[phase], loop; pc < plan->phase[phase + 1]; pc++) {
        if (plan->code[pc].ends_phase)
            break;
        for (loop = 0; loop < plan->loop_count && plan->loops[loop].first != pc + 1; loop++)
            ;
        if (plan->code[pc].in.op != FP3_OP_EACH) {
            run_words(in, in->lanes, pc, pc + 1);
            continue;
        }
        run_loop(in, &plan->loops[loop]);
        pc = plan->loops[loop].end;
    }
    write_back(in, stored);
}

/* ---- native ---- */

/* Vectors that are whole are worked on in place. The last one, if it is not, is copied, and filled
 * with its last object. */
static void run_native(const interpreter *in, uint32_t phase) {
    const unsigned wide = in->fast->sweep->lanes;
    const uint32_t count = in->lanes->count, whole = count / wide, first = in->first / wide;
    const float *own[FP3_BANK_OBJECT_COUNT], *seen[FP3_BANK_OBJECT_COUNT];
    float *next[FP3_BANK_OBJECT_COUNT];
    const fp3_fast_plan *plan = &in->fast->plan;
    fp3_fast_list lists[FP3_LISTS_MAX];
    for (uint32_t i = 0; i < plan->around.list_count; i++)
        lists[i] = in->group->lists[i].list;
    fp3_fast_around a = {.own = own,
                         .next = next,
                         .seen = seen,
                         .constants = (const int *)in->group->constants,
                         .table = in->fast->table,
                         .lists = lists,
                         .records = in->group->records};
    FP3_EACH_REGISTER (plan->read | plan->stored, reg) {
        own[reg] = seen[reg] = (const float *)(const void *)in->group->own[reg];
        next[reg] = (float *)(void *)in->group->next[reg];
    }
    if (whole)
        in->fast->native.around(&a, phase, first, first + whole);
    if (count == whole * wide)
        return;
    fp3_fast_lanes *rest = in->lanes;
    const uint32_t from = in->first + whole * wide, left = count - whole * wide;
    rest->count = left;
    FP3_EACH_REGISTER (plan->read | plan->stored, reg) {
        memcpy(rest->rows[reg], in->group->own[reg] + from, left * sizeof(float));
        memcpy(rest->own[reg], in->group->next[reg] + from, left * sizeof(float));
        own[reg] = rest->rows[reg];
        next[reg] = rest->own[reg];
    }
    fp3_fast_fill(rest, plan->read | plan->stored, 0);
    a.bias = first + whole;
    in->fast->native.around(&a, phase, first + whole, first + whole + 1);
    FP3_EACH_REGISTER (plan->stored, reg)
        memcpy(in->group->next[reg] + from, rest->own[reg], left * sizeof(float));
}

/* ---- a phase of a block ---- */

/* What a phase reads of a block's objects and writes there again. */
static uint64_t kept_in_place(const interpreter *in) {
    return in->fast->plan.stored & ~in->fast->plan.around.published;
}

/* What a phase is only hinted at by the processor. It raises underflow too early, and in turns of
 * loops that are no folds objects without a neighbour raise what they like. */
static uint32_t hints_of(const fp3_fast_plan *plan, uint32_t phase) {
    return !fp3_fast_folds(plan, phase) ? UINT32_MAX : FP3_FPU_IS_EARLY ? FP3_FLAG_UNDERFLOW : 0;
}

/* With a hint the phase is made again by what knows. */
static void run_native_with_hints(const interpreter *in, uint32_t phase, uint32_t hints) {
    const size_t size = in->lanes->count * sizeof(float);
    const uint32_t count = in->lanes->count;
    FP3_EACH_REGISTER (kept_in_place(in), reg)
        memcpy(in->worker->rows[reg], in->group->own[reg] + in->first, size);
    run_native(in, phase);
    if (!(fp3_fast_raised(0) & hints))
        return;
    FP3_EACH_REGISTER (kept_in_place(in), reg)
        memcpy(in->group->own[reg] + in->first, in->worker->rows[reg], size);
    fp3_fpu_forget();
    in->lanes->count = count;
    interpret(in, phase);
}

/* A phase that has changed what entries remember cannot be made again. */
static void run_or_interpret(const interpreter *in, uint32_t phase, uint32_t hints) {
    if (!hints)
        run_native(in, phase);
    else if (fp3_fast_remembers(&in->fast->plan, phase))
        interpret(in, phase);
    else
        run_native_with_hints(in, phase, hints);
}

void fp3_fast_phase(const fp3_fast *fast, fp3_fast_worker *worker, const fp3_fast_group *group,
                    uint32_t phase, uint32_t first, uint32_t count) {
    const uint64_t callers = fp3_fpu_begin(fast->plan.config->nearest);
    interpreter in = {.fast = fast,
                      .group = group,
                      .worker = worker,
                      .lanes = &worker->now,
                      .first = first,
                      .run = {.constants = group->constants}};
    worker->now.count = count;
    worker->now.seen = worker->aside.seen = 0;
    fp3_fast_wake(&worker->now);
    fp3_fast_wake(&worker->aside);
    const int is_phase = phase < fp3_fast_phases(fast);
    if (is_phase && !fp3_fast_native_for(fast, group->constants))
        interpret(&in, phase);
    else
        run_or_interpret(&in, phase,
                         is_phase ? hints_of(&fast->plan, phase) & ~worker->confirmed : 0);
    worker->confirmed |= fp3_fast_raised(worker->now.seen | worker->aside.seen);
    fp3_fpu_set(callers);
}
