/* SPDX-License-Identifier: Apache-2.0 */
/* session.c - see session.h. */
#include "session.h"

#include "driver.h"
#include "memory.h"
#include "store_lists.h"

#include "gen/registers.h"
#include <inttypes.h>
#include <string.h>

#define STOP_CYCLES 10000 /* from control.stop to the end of a run ... */
#define STOP_ASKS 200     /* ... and how often to ask for it */

#define BIT(field) (1u << FP3_##field##_LO)
#define FIELD(word, field)                                                                         \
    (((word) >> FP3_##field##_LO) & ((2u << (FP3_##field##_HI - FP3_##field##_LO)) - 1))

/* What the hardware does between a start and an end. */
typedef struct {
    uint32_t steps, visit, clock;
    uint64_t limit;           /* of its cycles; 0: there is none */
    int has_half;             /* the register `half` is there, and says where to begin */
    const fp3_own_list *kept; /* the hardware makes a list; NULL: none */
} part;

static fp3_status start(fp3_engine *engine, const part *p) {
    const fp3_driver *self = engine->self;
    const struct {
        uint32_t address, data;
    } list[] = {{FP3_ADDR_SEED, fp3_engine_seed(engine)},
                {FP3_ADDR_HALF, (uint32_t)self->is_upper},
                {FP3_ADDR_VISIT, p->visit},
                {FP3_ADDR_CLOCK, p->clock},
                {FP3_ADDR_STEPS, p->steps},
                {FP3_ADDR_CONTROL, BIT(CONTROL_START)}};
    fp3_status status = FP3_OK;
    size_t i = engine->config->storage ? 0 : p->has_half ? 1 : engine->config->interleave ? 2 : 4;
    for (; !status && i < sizeof list / sizeof *list; i++) {
        if (list[i].address == FP3_ADDR_CONTROL)
            status =
                fp3_driver_flush(engine); /* it does not start if a word before it is refused */
        const int is_there = list[i].address != FP3_ADDR_HALF || p->has_half;
        if (!status && is_there)
            status =
                fp3_driver_put(engine, fp3_driver_of_all(engine, list[i].address), list[i].data);
    }
    return status ? status : fp3_driver_flush(engine);
}

/* Until no scheduler runs, for so many cycles and questions at most; *outcome is the OR of all
 * status words. */
static fp3_status wait_until_idle(fp3_engine *engine, uint64_t cycles, uint32_t asks,
                                  uint32_t *outcome) {
    const fp3_bus *bus = ((const fp3_driver *)engine->self)->bus;
    const uint64_t begin = bus->now(engine);
    fp3_status status = FP3_OK;
    uint64_t clocked = 0;
    for (uint32_t asked = 0;; asked++) {
        if (clocked < cycles)
            status = bus->rest(engine, cycles - clocked, asked);
        if (!status)
            status = fp3_driver_peek(engine, fp3_driver_of_all(engine, FP3_ADDR_STATUS), outcome);
        if (status || !FIELD(*outcome, STATUS_RUNNING) || clocked >= cycles || asked >= asks)
            return status;
        clocked = bus->now(engine) - begin;
    }
}

static fp3_status stop(fp3_engine *engine, uint32_t *outcome) {
    fp3_status status =
        fp3_driver_put(engine, fp3_driver_of_all(engine, FP3_ADDR_CONTROL), BIT(CONTROL_STOP));
    if (!status)
        status = fp3_driver_flush(engine);
    if (!status)
        status = wait_until_idle(engine, STOP_CYCLES, STOP_ASKS, outcome);
    if (!status && FIELD(*outcome, STATUS_RUNNING))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM, "the hardware does not stop");
    return status;
}

static fp3_status wait_or_stop(fp3_engine *engine, uint64_t most) {
    const uint64_t limit = most ? most : UINT64_MAX;
    uint32_t outcome = 0;
    fp3_status status = wait_until_idle(engine, limit, UINT32_MAX, &outcome);
    if (!status && FIELD(outcome, STATUS_RUNNING))
        status = stop(engine, &outcome);
    return status ? status
                  : fp3_driver_note(engine, 'p', fp3_driver_of_all(engine, FP3_ADDR_STATUS),
                                    BIT(STATUS_RUNNING));
}

static const uint32_t counter_addresses[] = {
#define X(NAME, name, address) address,
    FP3_COUNTERS(X)
#undef X
};

static fp3_status read_counters(fp3_engine *engine, uint32_t scheduler, uint64_t *counter) {
    uint32_t addresses[2 * FP3_COUNTER_COUNT], words[2 * FP3_COUNTER_COUNT];
    for (uint32_t i = 0; i < 2 * FP3_COUNTER_COUNT; i++)
        addresses[i] = fp3_driver_of(engine, scheduler, counter_addresses[i / 2] + 4 * (i % 2));
    fp3_status status = fp3_driver_get_all(engine, addresses, words, 2 * FP3_COUNTER_COUNT);
    for (int i = 0; !status && i < FP3_COUNTER_COUNT; i++)
        counter[i] = (uint64_t)words[2 * i + 1] << 32 | words[2 * i];
    return status;
}

/* docs/registers.md: every running cycle is an issue, of one or two, or a stall; all that was
 * issued retires. */
static fp3_status check_counters(fp3_engine *engine, uint32_t scheduler, const uint64_t *n,
                                 int is_done) {
    uint64_t issued = 0, stalled = 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        stalled += fp3_counter_is_stall((fp3_counter)i) ? n[i] : 0;
        issued += strncmp(fp3_counter_name((fp3_counter)i), "issued_", 7) == 0 ? n[i] : 0;
    }
    const uint64_t retired = n[FP3_COUNTER_RETIRED], paired = n[FP3_COUNTER_PAIRED];
    if (n[FP3_COUNTER_CYCLES] + paired == issued + stalled &&
        (is_done ? retired + paired == issued : retired <= issued))
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_SYSTEM,
                    "the hardware's counters do not add up: scheduler %" PRIu32 ", %" PRIu64
                    " cycles, %" PRIu64 " issued, %" PRIu64 " stalled, %" PRIu64 " retired",
                    scheduler, n[FP3_COUNTER_CYCLES], issued, stalled, retired);
}

/* How a scheduler's run ended: its status word, and where if at an illegal word. */
static fp3_status ask_scheduler(fp3_engine *engine, uint32_t scheduler, uint32_t *outcome,
                                uint32_t *fault) {
    uint64_t *counter = engine->counters[scheduler];
    fp3_status status =
        fp3_driver_get(engine, fp3_driver_of(engine, scheduler, FP3_ADDR_STATUS), outcome);
    *outcome &= ~BIT(STATUS_RAISED); /* no outcome: objects of lists that are made raise */
    if (!status)
        status = fp3_driver_get(engine, fp3_driver_of(engine, scheduler, FP3_ADDR_FAULT), fault);
    if (!status && engine->config->counters) {
        status = read_counters(engine, scheduler, counter);
        if (!status)
            status = check_counters(engine, scheduler, counter, *outcome == BIT(STATUS_DONE));
    }
    if (!status && *outcome != BIT(STATUS_DONE) && *outcome != BIT(STATUS_ILLEGAL) &&
        *outcome != BIT(STATUS_STOPPED) && *outcome != BIT(STATUS_NO_ROOM))
        status = fp3_fail(engine->def.error, FP3_E_SYSTEM,
                          "scheduler %" PRIu32 " ended a run with status 0x%08" PRIx32, scheduler,
                          *outcome);
    return status;
}

static fp3_status end_run(fp3_engine *engine) {
    const fp3_driver *self = engine->self;
    fp3_status status = self->bus->ended ? self->bus->ended(engine) : FP3_OK;
    return !status && self->output ? fp3_output_publish(self->output, engine->def.error) : status;
}

/* Asks every scheduler; *illegal: the first that met an illegal word, and which. */
static fp3_status ask_schedulers(fp3_engine *engine, fp3_stats *stats, uint32_t *all,
                                 uint32_t *illegal, uint32_t *word) {
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    fp3_status status = FP3_OK;
    *illegal = schedulers;
    for (uint32_t scheduler = 0; !status && scheduler < schedulers; scheduler++) {
        uint32_t outcome = 0, fault = 0;
        status = ask_scheduler(engine, scheduler, &outcome, &fault);
        *all |= outcome;
        stats->schedulers = scheduler + 1;
        if (*illegal == schedulers && FIELD(outcome, STATUS_ILLEGAL)) {
            *illegal = scheduler;
            *word = fault;
        }
    }
    return status;
}

static fp3_status run_part(fp3_engine *engine, const part *p, fp3_stats *stats) {
    uint32_t all = 0, illegal = 0, word = 0, flags = 0;
    fp3_status status = start(engine, p);
    if (!status)
        status = fp3_driver_save_log(engine);
    if (!status)
        status = wait_or_stop(engine, p->limit);
    if (!status)
        status = ask_schedulers(engine, stats, &all, &illegal, &word);
    if (!status)
        status = fp3_driver_get(engine, fp3_driver_of_all(engine, FP3_ADDR_FLAGS), &flags);
    stats->flags |= flags;
    if (!status)
        status = end_run(engine);
    if (status)
        return status;
    if (FIELD(all, STATUS_NO_ROOM))
        return p->kept ? fp3_kept_no_room(engine, p->kept)
                       : fp3_fail(engine->def.error, FP3_E_SYSTEM,
                                  "the hardware has made a list that nobody has asked for");
    if (illegal == fp3_config_schedulers(engine->config))
        return FIELD(all, STATUS_STOPPED) ? fp3_engine_limit(engine) : FP3_OK;
    const uint32_t group = engine->layout.duty[illegal].group;
    word += ((const fp3_driver *)engine->self)->first;
    if (word < engine->layout.groups[group].program.count)
        return fp3_engine_illegal(engine, group, word);
    return fp3_fail(
        engine->def.error, FP3_E_SYSTEM,
        "the hardware says that word %" PRIu32 " is illegal: the program has no such word", word);
}

/* Adds those of the part before to these. */
static void add_counters(fp3_engine *engine, uint64_t *sums) {
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        engine->counters[0][i] = sums[i] += engine->counters[0][i];
}

/* Of objects that see each other: steps at once, or a phase of one. */
static fp3_status run_phases(fp3_engine *engine, fp3_store_lists *lists, uint32_t steps,
                             uint32_t clock, uint64_t *sums, fp3_stats *stats) {
    const uint64_t limit = engine->def.cycle_limit, cycles = sums[FP3_COUNTER_CYCLES];
    fp3_status status = fp3_engine_exchange(engine);
    if (!status)
        status = fp3_store_lists_follow(engine, lists);
    if (!status && limit && cycles >= limit)
        status = fp3_engine_limit(engine);
    if (status)
        return status;
    status = run_part(engine, &(part){steps, 1, clock, limit ? limit - cycles : 0, 1, lists->kept},
                      stats);
    add_counters(engine, sums);
    fp3_status looked = fp3_store_lists_look(engine);
    if (!looked)
        looked = fp3_store_lists_remember(engine, lists);
    return status ? status : looked;
}

/* A phase at a time. The hardware runs its program from the first word on, so each phase of several
 * is a program of its own. */
static fp3_status run_step(fp3_engine *engine, fp3_store_lists *lists, uint32_t clock,
                           uint64_t *sums, fp3_stats *stats) {
    const int is_one = engine->layout.groups[0].lists.shape.phases == 1;
    fp3_status status = FP3_OK;
    const fp3_code *program = &engine->layout.groups[0].program;
    const uint32_t only = engine->only;
    for (uint32_t phase = only ? only - 1 : 0, first, end;
         !status && (!only || phase < only) &&
         fp3_neighbourhood_phase(program, phase, &first, &end);
         phase++) {
        status = fp3_engine_compare(engine, &engine->layout.groups[0], first);
        if (!status && !is_one)
            status = fp3_memory_load_phase(engine, first, end);
        if (!status)
            status = run_phases(engine, lists, 1, clock, sums, stats);
    }
    return status;
}

/* Objects that see each other: a visit is a step. */
static fp3_status run_around(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    uint64_t sums[FP3_COUNTER_COUNT] = {0};
    fp3_store_lists lists;
    fp3_own_list kept = {0};
    fp3_status status =
        engine->def.cycle_limit ? fp3_engine_need_counters(engine, engine->def.error) : FP3_OK;
    if (status)
        return status;
    status = fp3_store_lists_begin(engine, &lists);
    if (!status)
        status = fp3_kept_begin(engine, &kept);
    lists.kept = kept.list ? &kept : NULL;
    const int is_by_phase = !kept.list && fp3_store_lists_is_by_phase(engine);
    for (uint32_t made = 0; !status && is_by_phase && made < steps; made++)
        status = run_step(engine, &lists, engine->clock + made, sums, stats);
    if (!status && !is_by_phase)
        status = run_phases(engine, &lists, steps, engine->clock, sums, stats);
    const int is_divided =
        is_by_phase && !engine->only && engine->layout.groups[0].lists.shape.phases > 1;
    const fp3_error why = engine->def.error ? *engine->def.error : (fp3_error){.text = ""};
    fp3_status ended = fp3_store_lists_end(engine, &lists);
    const fp3_status left = fp3_kept_end(engine, &kept);
    ended = ended ? ended : left;
    if (!ended && is_divided)
        ended = fp3_memory_load(engine);
    if (status && engine->def.error)
        *engine->def.error = why;
    return status ? status : ended;
}

fp3_status fp3_session_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    if (steps && engine->layout.groups[0].lists.shape.is_any)
        return run_around(engine, steps, stats);
    const uint32_t visit = engine->layout.groups[0].lists.shape.is_any ? 1 : engine->def.visit;
    return run_part(engine, &(part){steps, visit, engine->clock, engine->def.cycle_limit, 0, NULL},
                    stats);
}

fp3_status fp3_session_stop(fp3_engine *engine) {
    uint32_t outcome = 0;
    return stop(engine, &outcome);
}
