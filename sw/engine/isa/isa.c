/* SPDX-License-Identifier: Apache-2.0 */
/* isa.c - the "isa" engine: the instruction set, one instruction after the other.
 *
 * It knows objects, visits and rounds of visits, but no contexts: within a round an instruction is
 * executed for all objects before the next one, as if there were a context for each.
 */
#include "engine/common/backend.h"
#include "engine/common/follow.h"

#include "gen/registers.h"

#include <fp3/isa.h>
#include <machine/execute.h>
#include <machine/operation.h>
#include <machine/storage.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TELL_INSTRUCTIONS 65536 /* from one report of progress to the next */

/* What an object does with an instruction of its visit. */
typedef enum {
    AWAY,   /* nothing: not in the round, or absent since its lds */
    AWAKE,  /* executes it */
    ASLEEP, /* executes it in the last part */
} presence;

typedef struct {
    uint32_t *registers; /* of all objects; what a visit does not load is never read */
    uint32_t *store;     /* interleaved: the records, as many words each as registers */
    uint32_t *before;    /* ... as they were before this round */
    uint32_t *status;
    uint32_t *shared;          /* of all groups */
    const uint32_t *constants; /* those of the group whose turn it is */
    presence *now;
    char *listed;            /* the next round visits the object */
    char *is_over;           /* the group's run has ended before its time */
    uint64_t executed, told; /* instructions of this run: all, and when that was last told */
    fp3_remembered remembered[FP3_LISTS_MAX]; /* by the lists of the group, before this round */
} isa;

/* A loop over neighbours: who has an entry for this turn goes through it. */
typedef struct {
    const fp3_list *list; /* NULL: there is no loop */
    uint32_t begin;       /* index of its `each` */
    uint32_t turn, turns; /* from 0; of the longest list */
    uint32_t loaded;      /* fields of an entry, by `ldl` */
} loop;

/* A round of a run, for one group. */
typedef struct {
    fp3_engine *engine;
    fp3_stats *stats;
    uint32_t group;
    uint32_t steps, seed;
    uint32_t number, end; /* of the step now; of the last one */
    int is_ahead;         /* the instruction now works for the step that follows */
    loop loop;
    fp3_repetition repetition;
} round_of;

static size_t words(const fp3_engine *engine) {
    return (size_t)engine->objects * engine->config->registers;
}

static fp3_status isa_open(fp3_engine *engine) {
    isa *self = engine->self = calloc(1, sizeof *self);
    if (self) {
        self->registers = calloc(words(engine), sizeof *self->registers);
        self->store = calloc(words(engine), sizeof *self->store);
        self->before = calloc(words(engine), sizeof *self->before);
        self->status = calloc(engine->objects, sizeof *self->status);
        self->now = calloc(engine->objects, sizeof *self->now);
        self->listed = calloc(engine->objects, sizeof *self->listed);
        self->is_over = calloc(fp3_config_schedulers(engine->config), sizeof *self->is_over);
        self->shared =
            calloc((size_t)fp3_config_schedulers(engine->config) * engine->config->registers,
                   sizeof *self->shared);
    }
    if (self && self->registers && self->store && self->before && self->status && self->now &&
        self->listed && self->is_over && self->shared)
        return FP3_OK;
    return fp3_no_memory(engine->def.error);
}

static void isa_close(fp3_engine *engine) {
    isa *self = engine->self;
    if (self) {
        free(self->registers);
        free(self->store);
        free(self->before);
        free(self->status);
        free(self->now);
        free(self->listed);
        free(self->is_over);
        free(self->shared);
        for (uint32_t i = 0; i < FP3_LISTS_MAX; i++)
            fp3_remembered_free(&self->remembered[i]);
    }
    free(self);
}

static fp3_status isa_load(fp3_engine *engine) {
    (void)engine; /* the programs of engine->layout are what runs */
    return FP3_OK;
}

/* The first of them; *stride: words to the next. */
static uint32_t *find(const fp3_engine *engine, fp3_cells cells, size_t *stride) {
    const isa *self = engine->self;
    const size_t registers = engine->config->registers;
    uint32_t *objects = engine->config->interleave ? self->store : self->registers;
    *stride = cells.kind == FP3_CELLS_REGISTER ? registers : 1;
    return cells.kind == FP3_CELLS_REGISTER ? &objects[cells.first * registers + cells.number]
           : cells.kind == FP3_CELLS_STATUS ? &self->status[cells.first]
                                            : &self->shared[cells.number * registers + cells.first];
}

static fp3_status isa_read(fp3_engine *engine, fp3_cells cells, void *words) {
    size_t stride;
    const uint32_t *from = find(engine, cells, &stride);
    for (size_t i = 0; i < cells.count; i++)
        memcpy((char *)words + i * sizeof *from, &from[i * stride], sizeof *from);
    return FP3_OK;
}

static fp3_status isa_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    size_t stride;
    uint32_t *to = find(engine, cells, &stride);
    for (size_t i = 0; i < cells.count; i++)
        memcpy(&to[i * stride], (const char *)words + i * sizeof *to, sizeof *to);
    return FP3_OK;
}

static fp3_status isa_list(fp3_engine *engine) {
    isa *self = engine->self;
    for (size_t i = 0; i < engine->objects; i++)
        self->listed[i] = (char)fp3_engine_is_awake(engine, i);
    return FP3_OK;
}

/* What the hardware's decoder refuses, too. */
static int is_legal(const fp3_config *config, const fp3_decoded *word) {
    const uint32_t in_bank = FP3_BANK_SHARED_BASE - 1;
    const fp3_instruction *in = &word->in;
    if (!word->of || in->d >= config->registers || (in->a & in_bank) >= config->registers ||
        (in->b & in_bank) >= config->registers || (in->c & in_bank) >= config->registers)
        return 0;
    return fp3_operation_lacks(config, in->op) == FP3_KEY_NONE && !fp3_operation_mixes(config, in);
}

/* ---- an instruction ---- */

static uint32_t operand(const isa *self, const uint32_t *object, uint32_t number) {
    return number >= FP3_BANK_SHARED_BASE ? self->constants[number - FP3_BANK_SHARED_BASE]
                                          : object[number];
}

/* The flags of an object, and the step in which it went wrong. */
static void note_flags(const round_of *r, uint32_t object, uint32_t flags) {
    fp3_watched *watched = r->engine->watched;
    uint32_t *word = &((isa *)r->engine->self)->status[object];
    r->stats->flags |= flags;
    if (watched && r->is_ahead)
        fp3_watch_ahead(&watched[object], flags);
    else if (watched && fp3_watch_flags(&watched[object], r->number - r->engine->began, flags))
        watched[object].partner = fp3_list_same_place(
            r->loop.list, ((const isa *)r->engine->self)->store, r->engine->config->registers,
            r->engine->layout.groups[r->group].first, object, r->loop.turn);
    *word |= flags;
    if (flags & FP3_FLAGS_GRAVE && !(*word >> FP3_STATUS_STEP_LO))
        *word |= r->number << FP3_STATUS_STEP_LO;
}

static void retire(const round_of *r, uint32_t object, uint32_t reg, uint32_t bits,
                   uint32_t flags) {
    const fp3_engine *engine = r->engine;
    const isa *self = engine->self;
    const fp3_retirement done = {
        .cycle = self->executed, .object = object, .reg = reg, .bits = bits, .flags = flags};
    self->registers[(size_t)object * engine->config->registers + reg] = bits;
    if (engine->def.retire)
        engine->def.retire(engine->def.retire_user, &done);
}

static const fp3_members *members(const round_of *r) { return &r->engine->layout.groups[r->group]; }

static uint32_t neighbours_word(const round_of *r, uint32_t object, uint32_t word) {
    const fp3_engine *engine = r->engine;
    const uint32_t first = members(r)->first;
    const size_t other = first + fp3_list_entry(r->loop.list, object - first, r->loop.turn);
    return ((const isa *)engine->self)->store[other * engine->config->registers + word];
}

static uint32_t *entrys_field(const round_of *r, uint32_t object, uint32_t number) {
    const fp3_list *list = r->loop.list;
    const size_t entry = list->begin[object - members(r)->first] + r->loop.turn;
    return &list->field[entry * list->fields + number];
}

/* What a neighbour gives an instruction. */
static uint32_t given(const round_of *r, uint32_t object, const fp3_decoded *word) {
    const char letter = word->of->number;
    const uint32_t number = letter ? fp3_operand(&word->in, letter) : r->loop.loaded;
    return word->of->gives == FP3_GIVES_WORD ? neighbours_word(r, object, number)
                                             : *entrys_field(r, object, number);
}

/* An instruction that an object executes. */
static void execute(const round_of *r, uint32_t object, const fp3_decoded *word) {
    const fp3_config *config = r->engine->config;
    const fp3_instruction *in = &word->in;
    isa *self = r->engine->self;
    const uint32_t *registers = &self->registers[(size_t)object * config->registers];
    uint32_t *record = &self->store[(size_t)object * config->registers];
    uint32_t operands[3] = {operand(self, registers, in->a), operand(self, registers, in->b),
                            operand(self, registers, in->c)};
    uint32_t flags = 0, bits;
    if (word->of->computes)
        fp3_operation_place(word->of, operands[0], given(r, object, word), &operands[0],
                            &operands[1]);
    switch (in->op) {
    case FP3_OP_ST:
        record[in->d] = (int)in->d == members(r)->program.slept
                            ? registers[in->d]
                            : fp3_stored(config, registers[in->d],
                                         &(fp3_draw){r->seed, object, r->number, in->d}, &flags);
        note_flags(r, object, flags);
        break;
    case FP3_OP_STL:
        *entrys_field(r, object, in->a) = registers[in->d];
        break;
    case FP3_OP_LD:
        retire(r, object, in->d, record[in->d], 0);
        break;
    case FP3_OP_LDN:
    case FP3_OP_LDL:
        retire(r, object, in->d, given(r, object, word), 0);
        break;
    case FP3_OP_LDS:
        if (record[in->d]) {
            self->now[object] = AWAY;
            self->listed[object] = 0;
        }
        retire(r, object, in->d, record[in->d], 0);
        break;
    case FP3_OP_SLEEP:
        if (self->now[object] == AWAKE && fp3_execute_sleeps(config, operands)) {
            self->now[object] = ASLEEP;
            self->listed[object] = 0;
            retire(r, object, in->d, r->number, 0);
        }
        break;
    default:
        bits =
            fp3_execute(config, word->of->computes ? word->of->computes : in->op, operands, &flags);
        note_flags(r, object, flags);
        retire(r, object, in->d, bits, flags);
    }
    self->executed++;
}

static int has_turn(const round_of *r, uint32_t object) {
    return !r->loop.list ||
           r->loop.turn < fp3_list_length(r->loop.list, object - members(r)->first);
}

/* One instruction for all objects that execute it. */
static void sweep(const round_of *r, const fp3_decoded *word, int is_last) {
    isa *self = r->engine->self;
    const uint64_t before = self->executed;
    const fp3_members *group = members(r);
    for (uint32_t i = fp3_members_begin(group); i < fp3_members_end(group); i++)
        if ((self->now[i] == AWAKE || (is_last && self->now[i] == ASLEEP)) && has_turn(r, i))
            execute(r, i, word);
    uint64_t *counter = r->engine->counters[0];
    counter[fp3_operation_counter(r->engine->config, word->of)] += self->executed - before;
    counter[FP3_COUNTER_CYCLES] = counter[FP3_COUNTER_RETIRED] = self->executed;
}

/* ---- a run ---- */

static int is_anybody_awake(const round_of *r) {
    const isa *self = r->engine->self;
    const fp3_members *group = members(r);
    for (uint32_t i = fp3_members_begin(group); i < fp3_members_end(group); i++)
        if (self->now[i] == AWAKE)
            return 1;
    return 0;
}

static void tell(const fp3_engine *engine) {
    isa *self = engine->self;
    self->told = self->executed;
    fp3_engine_tell(engine, self->executed);
}

/* After a step, or after the last part: whose states are numbers. in_records: those that are there.
 */
static void watch_states(const round_of *r, uint64_t in_records) {
    const isa *self = r->engine->self;
    const fp3_members *group = members(r);
    const uint64_t states = fp3_engine_states_of(group);
    const uint32_t words_each = r->engine->config->registers;
    for (uint32_t i = fp3_members_begin(group); i < fp3_members_end(group); i++) {
        uint32_t is[FP3_BANK_OBJECT_COUNT];
        if (self->now[i] == AWAY)
            continue;
        for (uint32_t reg = 0; reg < words_each; reg++)
            is[reg] = (in_records >> reg & 1 ? self->store
                                             : self->registers)[(size_t)i * words_each + reg];
        fp3_watch_states(&r->engine->watched[i], r->number - r->engine->began, states, is);
    }
}

/* What was computed ahead counts for those who make the step. */
static void begin_step(round_of *r) {
    const isa *self = r->engine->self;
    const fp3_members *group = members(r);
    r->number++;
    for (uint32_t i = fp3_members_begin(group); r->engine->watched && i < fp3_members_end(group);
         i++)
        if (self->now[i] == AWAKE)
            fp3_watch_step(&r->engine->watched[i], r->number - r->engine->began);
}

/* Where the program goes on after this word, which belongs to the sequence: within a round all
 * objects make an instruction before any makes the next one, so a phase ends by itself. */
static uint32_t follow(round_of *r, const fp3_decoded *program, uint32_t pc) {
    fp3_lists *lists = &r->engine->layout.groups[r->group].lists;
    loop *l = &r->loop;
    if (program[pc].in.op == FP3_OP_EACH) {
        *l = (loop){.list = fp3_lists_of(lists, program[pc].in.d), .begin = pc};
        const fp3_members *group = members(r);
        for (uint32_t i = group->from; i < group->from + group->objects; i++) {
            const uint32_t turns = fp3_list_length(l->list, i);
            l->turns = turns > l->turns ? turns : l->turns;
        }
        if (l->turns)
            return pc + 1;
        l->list = NULL;
        return fp3_neighbourhood_end(program, pc) + 1;
    }
    if (program[pc].in.op == FP3_OP_NEXT && ++l->turn < l->turns) {
        l->loaded = 0;
        return l->begin + 1;
    }
    l->list = NULL;
    return fp3_ends_phase(&program[pc]) ? fp3_neighbourhood_behind(program, pc, &r->repetition)
                                        : pc + 1;
}

/* When a phase begins: lists of those that are near. */
static fp3_status begin_phase(round_of *r, uint32_t begin) {
    const fp3_engine *engine = r->engine;
    const isa *self = engine->self;
    fp3_members *group = &r->engine->layout.groups[r->group];
    const uint32_t *words[FP3_BANK_OBJECT_COUNT];
    int is_new;
    fp3_status status = fp3_engine_compare(r->engine, group, begin);
    if (!status)
        status = fp3_engine_exchange(r->engine);
    if (status)
        return status;
    for (uint32_t reg = 0; reg < engine->config->registers; reg++)
        words[reg] = &self->store[(size_t)group->first * engine->config->registers + reg];
    return fp3_lists_follow(&group->lists, group->rows, group->rows, words, NULL,
                            engine->config->registers, NULL, &is_new, engine->def.error);
}

/* All visits of a round. Where nothing interleaves a run is one round. */
static fp3_status make_round(round_of *r) {
    const fp3_engine *engine = r->engine;
    const fp3_code *program = &members(r)->program;
    uint32_t first = 0, end = program->count;
    if (engine->only && members(r)->lists.shape.is_any)
        fp3_neighbourhood_phase(program, engine->only - 1, &first, &end);
    r->number += first > program->step;
    const isa *self = engine->self;
    const uint64_t limit = engine->def.cycle_limit;
    const uint64_t stored = engine->config->interleave ? UINT64_MAX : 0; /* in the end */
    const uint64_t in_records = stored & ~members(r)->live;
    uint32_t left = r->steps;
    for (uint32_t pc = first; pc < end;) {
        const fp3_decoded *word = &program->decoded[pc];
        if (pc == program->step)
            begin_step(r);
        if (members(r)->lists.shape.is_any &&
            (pc == program->step || fp3_ends_phase(&program->decoded[pc - 1]))) {
            const fp3_status status = begin_phase(r, pc);
            if (status)
                return status;
        }
        if (!is_legal(engine->config, word))
            return fp3_engine_illegal(r->engine, r->group, pc);
        if (limit && self->executed >= limit)
            return fp3_engine_limit(r->engine);
        r->is_ahead = engine->watched && (pc < program->step || members(r)->is_ahead[pc]);
        if (word->of->path & FP3_UNIT_SEQUENCE) {
            pc = follow(r, program->decoded, pc);
        } else {
            sweep(r, word, pc >= program->last);
            r->loop.loaded += word->in.op == FP3_OP_LDL;
            pc++;
        }
        if (self->executed >= self->told + TELL_INSTRUCTIONS)
            tell(r->engine);
        if (engine->watched && pc == program->last)
            watch_states(r, in_records);
        if (engine->watched && pc == program->count && (left == 1 || pc > program->last))
            watch_states(r, stored);
        if (pc == program->last && --left)
            pc = program->step;
        if (pc < program->last && !is_anybody_awake(r)) {
            r->number += pc <= program->step; /* they fell asleep before the step began */
            if (engine->watched)
                watch_states(r, in_records);
            r->number = r->end;
            pc = program->last;
        }
    }
    return FP3_OK;
}

/* Who is visited in a round; 0: nobody. */
static int begin_round(const round_of *r) {
    const fp3_engine *engine = r->engine;
    const fp3_members *group = members(r);
    isa *self = engine->self;
    const size_t words_each = engine->config->registers,
                 first = fp3_members_begin(group) * words_each;
    for (uint32_t i = fp3_members_begin(group); i < fp3_members_end(group); i++) {
        self->now[i] = !engine->config->interleave || self->listed[i] ? AWAKE : AWAY;
        if (engine->watched)
            engine->watched[i].ahead = 0;
    }
    memcpy(&self->before[first], &self->store[first],
           group->objects * words_each * sizeof *self->before);
    self->constants = &self->shared[r->group * words_each];
    return is_anybody_awake(r);
}

/* What entries remember, before a round. */
static fp3_status keep_remembered(const round_of *r) {
    const fp3_members *group = members(r);
    isa *self = r->engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++) {
        fp3_remembered_free(&self->remembered[i]);
        if (fp3_list_remembers(&group->lists.lists[i]))
            status = fp3_list_save(&group->lists.lists[i], NULL, group->rows, &self->remembered[i],
                                   r->engine->def.error);
    }
    return status;
}

static fp3_status undo_remembered(const round_of *r) {
    fp3_members *group = &r->engine->layout.groups[r->group];
    const isa *self = r->engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < group->lists.shape.list_count; i++)
        if (fp3_list_remembers(&group->lists.lists[i]))
            status = fp3_list_restore(&group->lists.lists[i], NULL, group->rows,
                                      &self->remembered[i], r->engine->def.error);
    return status;
}

/* Of visits that did not come to their end nothing is stored. */
static fp3_status undo_round(const round_of *r) {
    const fp3_members *group = members(r);
    isa *self = r->engine->self;
    const size_t words_each = r->engine->config->registers,
                 first = fp3_members_begin(group) * words_each;
    memcpy(&self->store[first], &self->before[first],
           group->objects * words_each * sizeof *self->store);
    return undo_remembered(r);
}

/* A round of every group that goes on; *is_any: one did. One whose program ends at an illegal word,
 * or that finds the limit, goes on no more; *status and *why tell the first such end. */
static void make_rounds(round_of r, fp3_status *status, fp3_error *why, int *is_any) {
    fp3_engine *engine = r.engine;
    isa *self = engine->self;
    for (r.group = 0; r.group < engine->layout.count; r.group++) {
        round_of of_group = r;
        if (self->is_over[r.group] || !begin_round(&of_group))
            continue;
        fp3_status end = keep_remembered(&of_group);
        if (!end)
            end = make_round(&of_group);
        *is_any |= !end;
        if (!end)
            continue;
        self->is_over[r.group] = 1;
        if (!*status && engine->def.error)
            *why = *engine->def.error;
        const fp3_status undone = undo_round(&of_group);
        if (undone && engine->def.error)
            *why = *engine->def.error;
        end = undone ? undone : end;
        *status = *status ? *status : end;
    }
}

static fp3_status run_rounds(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    const uint32_t visit =
        engine->config->interleave && engine->def.visit ? engine->def.visit : UINT32_MAX;
    fp3_status status = FP3_OK;
    fp3_error why = {.text = ""};
    int is_any = 1;
    memset(((isa *)engine->self)->is_over, 0, engine->layout.count);
    for (uint32_t made = 0; made < steps && is_any;) {
        round_of r = {.engine = engine, .stats = stats, .number = engine->clock + made};
        r.seed = fp3_engine_seed(engine);
        r.steps = steps - made < visit ? steps - made : visit;
        r.end = r.number + r.steps;
        made += r.steps;
        is_any = 0;
        make_rounds(r, &status, &why, &is_any);
    }
    if (status && engine->def.error)
        *engine->def.error = why;
    return status;
}

static fp3_status isa_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    const uint64_t callers = fp3_fpu_begin(engine->config->nearest);
    stats->schedulers = 1;
    ((isa *)engine->self)->executed = ((isa *)engine->self)->told = 0;
    const fp3_status status = run_rounds(engine, steps, stats);
    fp3_fpu_set(callers);
    return status;
}

const fp3_backend fp3_backend_isa = {
    .is = {"isa", .is_hardware = 0},
    .open = isa_open,
    .close = isa_close,
    .load = isa_load,
    .read = isa_read,
    .write = isa_write,
    .list = isa_list,
    .run = isa_run,
};
