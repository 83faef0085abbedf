/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare.c - see fp3_bare.h. */
#include "fp3_bare.h"

#include <fp3/image.h>
#include <fp3/isa.h>

#define BIT(field) (1u << FP3_##field##_LO)
#define FIELD(word, field)                                                                         \
    (((word) >> FP3_##field##_LO) & ((2u << (FP3_##field##_HI - FP3_##field##_LO)) - 1))
#define LEAST_RECORD 3u
#define LARGEST_RECORD 6u
#define NO_WORD 64u /* of register `whole` */

_Static_assert(sizeof(float) == sizeof(uint32_t), "float is FP32");

/* ---- the bus ---- */

static int read_memory(void *user, uint32_t address, uint32_t *word) {
    *word = ((volatile uint32_t *)user)[address / 4];
    return 0;
}

static int write_memory(void *user, uint32_t address, uint32_t word) {
    ((volatile uint32_t *)user)[address / 4] = word;
    return 0;
}

fp3_bare_bus fp3_bare_memory(volatile uint32_t *base) {
    const fp3_bare_bus bus = {read_memory, write_memory, (void *)(uintptr_t)base};
    return bus;
}

/* One scheduler has no bits of the address, so its number is 0 however it is called. Several have
 * as many as hold how many they are, and all ones are all of them: FP3_ALL itself would be far
 * beyond the window. */
static uint32_t of(const fp3_bare *fp3, uint32_t scheduler, uint32_t address) {
    uint32_t all = 1;
    if (fp3->schedulers == 1)
        return address;
    while (all < fp3->schedulers)
        all = 2 * all + 1;
    return FP3_ADDRESS_OF(fp3->space_bit, scheduler == FP3_ALL ? all : scheduler, address);
}

static fp3_status answer(fp3_bare *fp3, int is_refused, uint32_t address) {
    if (!is_refused)
        return FP3_OK;
    fp3->failed_at = address;
    return FP3_E_SYSTEM;
}

static fp3_status get(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint32_t *word) {
    const uint32_t at = of(fp3, scheduler, address);
    return answer(fp3, fp3->bus.read(fp3->bus.user, at, word), at);
}

static fp3_status put(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint32_t word) {
    const uint32_t at = of(fp3, scheduler, address);
    return answer(fp3, fp3->bus.write(fp3->bus.user, at, word), at);
}

/* ---- whom a call is about ---- */

static uint32_t first_of(uint32_t scheduler) { return scheduler == FP3_ALL ? 0 : scheduler; }

static uint32_t end_of(const fp3_bare *fp3, uint32_t scheduler) {
    return scheduler == FP3_ALL ? fp3->schedulers : scheduler + 1;
}

static int is_there(const fp3_bare *fp3, uint32_t scheduler) {
    return scheduler == FP3_ALL || scheduler < fp3->schedulers;
}

/* Whether they are there and none of them runs: their memories and settings can be reached. */
static int is_idle(const fp3_bare *fp3, uint32_t scheduler) {
    if (!is_there(fp3, scheduler))
        return 0;
    for (uint32_t i = first_of(scheduler); i < end_of(fp3, scheduler); i++)
        if (fp3->running[i])
            return 0;
    return 1;
}

static uint32_t columns_of(const fp3_bare *fp3, uint32_t scheduler) {
    return (end_of(fp3, scheduler) - first_of(scheduler)) * fp3->lanes;
}

static uint32_t rows_of(const fp3_bare *fp3, uint32_t scheduler) {
    return !fp3->record[scheduler] ? 0 : fp3->store ? fp3->room >> fp3->record[scheduler] : 1;
}

typedef struct {
    uint32_t scheduler, lane, row;
} place;

/* Where an object is. 0: the scheduler runs or has no program, or there is no such object. */
static int find(const fp3_bare *fp3, uint32_t scheduler, uint32_t object, place *at) {
    if (!is_idle(fp3, scheduler))
        return 0;
    const uint32_t columns = columns_of(fp3, scheduler), column = object % columns;
    at->scheduler = first_of(scheduler) + column / fp3->lanes;
    at->lane = column % fp3->lanes;
    at->row = object / columns;
    return at->row < rows_of(fp3, at->scheduler);
}

/* ---- what stands there ---- */

static fp3_status ask_shape(fp3_bare *fp3) {
    uint32_t shape = 0, array = 0;
    fp3_status status = get(fp3, 0, FP3_ADDR_SHAPE, &shape);
    if (!status)
        status = get(fp3, 0, FP3_ADDR_MEMORY, &fp3->program_words);
    if (!status)
        status = get(fp3, 0, FP3_ADDR_FEATURES, &fp3->features);
    fp3->features_more = 0;
    if (!status && FIELD(fp3->features, FEATURES_MORE))
        status = get(fp3, 0, FP3_ADDR_FEATURES_MORE, &fp3->features_more);
    if (!status)
        status = get(fp3, 0, FP3_ADDR_STORE, &fp3->store);
    if (!status)
        status = get(fp3, 0, FP3_ADDR_ARRAY, &array);
    fp3->registers = FIELD(shape, SHAPE_REGISTERS);
    fp3->contexts = FIELD(shape, SHAPE_CONTEXTS);
    fp3->schedulers = FIELD(array, ARRAY_TILES) * FIELD(array, ARRAY_SCHEDULERS);
    fp3->lanes = FIELD(array, ARRAY_LANES);
    fp3->space_bit = FIELD(array, ARRAY_SPACE_BIT);
    return status;
}

fp3_status fp3_bare_open(fp3_bare *fp3, const fp3_bare_bus *bus) {
    uint32_t id = 0, word = 0;
    fp3->bus = *bus;
    fp3->failed_at = 0;
    fp3->schedulers = FP3_BARE_SCHEDULERS; /* not known yet: what is asked is scheduler 0 */
    fp3->space_bit = 0;
    fp3->around = NULL;
    fp3->half = fp3->missing = 0;
    fp3_status status = get(fp3, 0, FP3_ADDR_ID, &id);
    if (!status && FIELD(id, ID_LETTERS) != FP3_ID_LETTERS)
        return FP3_E_MISMATCH;
    if (!status)
        status = ask_shape(fp3);
    if (!status &&
        (fp3->schedulers == 0 || fp3->schedulers > FP3_BARE_SCHEDULERS || fp3->lanes == 0 ||
         fp3->space_bit == 0 || fp3->space_bit > FP3_ADDRESS_WORD_BITS + 2))
        return FP3_E_MISMATCH;
    fp3->revision = (uint8_t)id;
    fp3->room = fp3->store;
    for (uint32_t i = 0; !status && i < fp3->schedulers; i++) {
        status = get(fp3, i, FP3_ADDR_STATUS, &word);
        fp3->running[i] = (uint8_t)FIELD(word, STATUS_RUNNING);
        fp3->record[i] = 0;
    }
    return status;
}

/* ---- programs ---- */

/* Whether the hardware's words are binary32, and computed with as the program counts on. */
static int has_arithmetic(const fp3_bare *fp3, const fp3_bare_program *program) {
    const int is_nearest = FIELD(fp3->features, FEATURES_NEAREST) != 0;
    const int is_flushed = FIELD(fp3->features, FEATURES_SUBNORMAL) == 0;
    const uint32_t has = FIELD(fp3->features_more, FEATURES_MORE_FINITE) ? FP3_WORDS_CELL
                         : !is_nearest
                             ? (is_flushed ? FP3_WORDS_TRUNCATED_FLUSHED : FP3_WORDS_TRUNCATED)
                         : is_flushed                                     ? FP3_WORDS_FLUSHED
                         : FIELD(fp3->features_more, FEATURES_MORE_MIXED) ? FP3_WORDS_MIXED
                                                                          : FP3_WORDS_FLOATS;
    return !FIELD(fp3->features_more, FEATURES_MORE_LOGARITHMIC) &&
           !FIELD(fp3->features_more, FEATURES_MORE_FRACTION) &&
           (program->arithmetic == FP3_WORDS_ANY || program->arithmetic == has);
}

static int has_room(const fp3_bare *fp3, const fp3_bare_program *program, uint32_t words) {
    return words <= fp3->program_words && program->registers <= fp3->registers &&
           program->shared <= fp3->registers && program->record >= LEAST_RECORD &&
           program->record <= LARGEST_RECORD &&
           (fp3->store == 0 || fp3->store >> program->record > 0);
}

/* Objects that see each other need loads and stores of their own, in a lane that has them all. */
static int has_neighbours(const fp3_bare *fp3, const fp3_bare_program *program) {
    return !program->list_count ||
           (FIELD(fp3->features_more, FEATURES_MORE_NEIGHBOURS) && program->list_count < 32 &&
            fp3->schedulers == 1 && fp3->lanes == 1 && !program->loads && !program->stores &&
            fp3->store / 2 >> program->record > 0);
}

/* The register that `sleep` writes, which keeps all its bits in a record of 16 bits; NO_WORD: there
 * is none. */
static uint32_t whole_of(const fp3_bare_program *program) {
    for (uint32_t i = 0; i < program->word_count; i++) {
        const uint32_t word = program->words[i], op = word >> FP3_FIELD_OP_LO;
        if (op == FP3_OP_SLEEP || op == FP3_OP_LDS)
            return FIELD(word, FIELD_D);
    }
    return NO_WORD;
}

static fp3_status put_shape(fp3_bare *fp3, uint32_t scheduler, const fp3_bare_program *program,
                            uint32_t skipped, uint32_t words) {
    fp3_status status = put(fp3, scheduler, FP3_ADDR_STEP, program->step - skipped);
    if (!status)
        status = put(fp3, scheduler, FP3_ADDR_LAST, program->last - skipped);
    if (!status)
        status = put(fp3, scheduler, FP3_ADDR_SIZE, words);
    if (!status && fp3->store)
        status = put(fp3, scheduler, FP3_ADDR_RECORD, program->record);
    if (!status && FIELD(fp3->features_more, FEATURES_MORE_NEIGHBOURS))
        status = put(fp3, scheduler, FP3_ADDR_PUBLISHED, program->published[0]);
    if (!status && FIELD(fp3->features_more, FEATURES_MORE_NEIGHBOURS))
        status = put(fp3, scheduler, FP3_ADDR_PUBLISHED_MORE, program->published[1]);
    if (!status && FIELD(fp3->features, FEATURES_SLEEP) &&
        FIELD(fp3->features_more, FEATURES_MORE_STORAGE))
        status = put(fp3, scheduler, FP3_ADDR_WHOLE, whole_of(program));
    return status;
}

fp3_status fp3_bare_load(fp3_bare *fp3, uint32_t scheduler, const fp3_bare_program *program) {
    const uint32_t skipped = fp3->store ? 0 : program->loads;
    const uint32_t words = program->word_count - skipped - (fp3->store ? 0 : program->stores);
    if (!is_idle(fp3, scheduler))
        return FP3_E_ARGUMENT;
    if (program->revision != fp3->revision || !has_arithmetic(fp3, program))
        return FP3_E_MISMATCH;
    if (!has_room(fp3, program, words) || !has_neighbours(fp3, program))
        return FP3_E_PROGRAM;
    fp3->around = program->list_count ? program : NULL;
    fp3->room = program->list_count ? fp3->store / 2 : fp3->store;
    fp3->half = 0;
    fp3->missing = (1u << program->list_count) - 1;
    for (uint32_t i = first_of(scheduler); i < end_of(fp3, scheduler); i++)
        fp3->record[i] = 0; /* until all of it is there */
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < words; i++)
        status = put(fp3, scheduler, FP3_ADDR_WINDOW_PROGRAM + 4 * i, program->words[skipped + i]);
    if (!status)
        status = put_shape(fp3, scheduler, program, skipped, words);
    for (uint32_t i = 0; !status && i < program->constant_count; i++)
        status = put(fp3, scheduler, FP3_ADDR_WINDOW_CONSTANTS + 4 * program->constants[i].index,
                     program->constants[i].bits);
    for (uint32_t i = first_of(scheduler); !status && i < end_of(fp3, scheduler); i++)
        fp3->record[i] = (uint8_t)program->record;
    return status;
}

fp3_status fp3_bare_write_shared(fp3_bare *fp3, uint32_t scheduler, uint32_t index, uint32_t bits) {
    if (!is_idle(fp3, scheduler) || index >= fp3->registers)
        return FP3_E_ARGUMENT;
    return put(fp3, scheduler, FP3_ADDR_WINDOW_CONSTANTS + 4 * index, bits);
}

/* ---- objects ---- */

/* The address of a register of an object. 0: there is none, or not now. */
static int find_register(const fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t reg,
                         place *at, uint32_t *address) {
    if (!find(fp3, scheduler, object, at))
        return 0;
    const uint32_t record = fp3->record[at->scheduler];
    if (reg >= fp3->registers || (fp3->store && reg >> record))
        return 0;
    const int is_published = fp3->around && fp3->around->published[reg / 32] >> reg % 32 & 1;
    const uint32_t word = at->lane * fp3->store + (at->row << record) + reg;
    *address = FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_OBJECTS,
                              !fp3->store    ? reg
                              : is_published ? word + fp3->half
                                             : word);
    return 1;
}

fp3_status fp3_bare_write(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t reg,
                          uint32_t bits) {
    place at;
    uint32_t address;
    if (!find_register(fp3, scheduler, object, reg, &at, &address))
        return FP3_E_ARGUMENT;
    return put(fp3, at.scheduler, address, bits);
}

fp3_status fp3_bare_read(fp3_bare *fp3, uint32_t scheduler, uint32_t object, uint32_t reg,
                         uint32_t *bits) {
    place at;
    uint32_t address;
    if (!find_register(fp3, scheduler, object, reg, &at, &address))
        return FP3_E_ARGUMENT;
    return get(fp3, at.scheduler, address, bits);
}

static int find_status(const fp3_bare *fp3, uint32_t scheduler, uint32_t object, place *at,
                       uint32_t *address) {
    if (!FIELD(fp3->features, FEATURES_STATUS) || !find(fp3, scheduler, object, at))
        return 0;
    *address = FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_STATUS, at->lane * fp3->store + at->row);
    return 1;
}

fp3_status fp3_bare_write_status(fp3_bare *fp3, uint32_t scheduler, uint32_t object,
                                 uint32_t word) {
    place at;
    uint32_t address;
    if (!find_status(fp3, scheduler, object, &at, &address))
        return FP3_E_ARGUMENT;
    return put(fp3, at.scheduler, address, word);
}

fp3_status fp3_bare_read_status(fp3_bare *fp3, uint32_t scheduler, uint32_t object,
                                uint32_t *word) {
    place at;
    uint32_t address;
    if (!find_status(fp3, scheduler, object, &at, &address))
        return FP3_E_ARGUMENT;
    return get(fp3, at.scheduler, address, word);
}

/* ---- lists ---- */

/* With sleep the numbers of a lane's objects; without, how many. */
static fp3_status list_lane(fp3_bare *fp3, uint32_t scheduler, uint32_t lane, uint32_t rows) {
    const int sleeps = FIELD(fp3->features, FEATURES_SLEEP) != 0;
    fp3_status status = put(fp3, scheduler, FP3_ADDR_WINDOW_AWAKE + 4 * lane, sleeps ? 0 : rows);
    for (uint32_t row = 0; !status && sleeps && row < rows; row++)
        status = put(fp3, scheduler, FP3_ADDR_WINDOW_WAKE + 4 * lane, row);
    return status;
}

fp3_status fp3_bare_list(fp3_bare *fp3, uint32_t scheduler, uint32_t count) {
    place at;
    if (!is_idle(fp3, scheduler) || (fp3->around && count != rows_of(fp3, 0)))
        return FP3_E_ARGUMENT;
    const uint32_t columns = columns_of(fp3, scheduler), first = first_of(scheduler);
    /* The fullest row is the last; in it every scheduler must have room. */
    for (uint32_t i = 0; i < columns && i < count; i++)
        if (!find(fp3, scheduler, count - 1 - i, &at))
            return FP3_E_ARGUMENT;
    if (fp3->store == 0)
        return count == 1 ? FP3_OK : FP3_E_ARGUMENT;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < columns; i++)
        status = list_lane(fp3, first + i / fp3->lanes, i % fp3->lanes,
                           count / columns + (i < count % columns));
    return status;
}

fp3_status fp3_bare_wake(fp3_bare *fp3, uint32_t scheduler, uint32_t object) {
    place at;
    uint32_t listed = 0;
    if (!FIELD(fp3->features, FEATURES_SLEEP) || !find(fp3, scheduler, object, &at))
        return FP3_E_ARGUMENT;
    const fp3_status status = get(fp3, at.scheduler, FP3_ADDR_WINDOW_AWAKE + 4 * at.lane, &listed);
    if (status)
        return status;
    return listed >= fp3->store >> LEAST_RECORD
               ? FP3_E_ARGUMENT
               : put(fp3, at.scheduler, FP3_ADDR_WINDOW_WAKE + 4 * at.lane, at.row);
}

/* ---- a run ---- */

fp3_status fp3_bare_start(fp3_bare *fp3, uint32_t scheduler, uint32_t steps, uint32_t visit,
                          uint32_t clock) {
    if (!is_idle(fp3, scheduler) || clock > UINT32_MAX - steps || fp3->missing ||
        (fp3->around && visit != 1))
        return FP3_E_ARGUMENT;
    for (uint32_t i = first_of(scheduler); i < end_of(fp3, scheduler); i++)
        if (!fp3->record[i])
            return FP3_E_ARGUMENT;
    fp3_status status = FP3_OK;
    if (fp3->around) /* published words are where the run before has left them */
        status = put(fp3, scheduler, FP3_ADDR_HALF, fp3->half != 0);
    if (!status && fp3->store)
        status = put(fp3, scheduler, FP3_ADDR_VISIT, visit);
    if (!status && fp3->store)
        status = put(fp3, scheduler, FP3_ADDR_CLOCK, clock);
    if (!status)
        status = put(fp3, scheduler, FP3_ADDR_STEPS, steps);
    if (!status)
        status = put(fp3, scheduler, FP3_ADDR_CONTROL, BIT(CONTROL_START));
    /* A run of no steps ends at once, and leaves register `half` as the run before did. */
    for (uint32_t i = first_of(scheduler); !status && i < end_of(fp3, scheduler); i++)
        fp3->running[i] = !fp3->around || steps > 0;
    return status;
}

static fp3_bare_outcome outcome_of(uint32_t word) {
    return FIELD(word, STATUS_RUNNING)   ? FP3_BARE_RUNNING
           : FIELD(word, STATUS_ILLEGAL) ? FP3_BARE_ILLEGAL
           : FIELD(word, STATUS_STOPPED) ? FP3_BARE_STOPPED
           : FIELD(word, STATUS_DONE)    ? FP3_BARE_DONE
                                         : FP3_BARE_NONE;
}

fp3_status fp3_bare_poll(fp3_bare *fp3, uint32_t scheduler, fp3_bare_outcome *outcome) {
    uint32_t word = 0, half = 0;
    if (!is_there(fp3, scheduler))
        return FP3_E_ARGUMENT;
    fp3_status status = get(fp3, scheduler, FP3_ADDR_STATUS, &word);
    const int has_moved = fp3->around && fp3->running[0] && outcome_of(word) != FP3_BARE_RUNNING;
    if (!status && has_moved)
        status = get(fp3, scheduler, FP3_ADDR_HALF, &half);
    if (status)
        return status;
    *outcome = outcome_of(word);
    if (has_moved)
        fp3->half = half ? fp3->store / 2 : 0;
    for (uint32_t i = first_of(scheduler);
         *outcome != FP3_BARE_RUNNING && i < end_of(fp3, scheduler); i++)
        fp3->running[i] = 0;
    return FP3_OK;
}

fp3_status fp3_bare_wait(fp3_bare *fp3, uint32_t scheduler, uint32_t polls,
                         fp3_bare_outcome *outcome) {
    for (; polls > 0; polls--) {
        const fp3_status status = fp3_bare_poll(fp3, scheduler, outcome);
        if (status || *outcome != FP3_BARE_RUNNING)
            return status;
    }
    return FP3_E_LIMIT;
}

fp3_status fp3_bare_stop(fp3_bare *fp3, uint32_t scheduler) {
    return is_there(fp3, scheduler) ? put(fp3, scheduler, FP3_ADDR_CONTROL, BIT(CONTROL_STOP))
                                    : FP3_E_ARGUMENT;
}

fp3_status fp3_bare_interrupt(fp3_bare *fp3, uint32_t scheduler, unsigned events) {
    return is_there(fp3, scheduler)
               ? put(fp3, scheduler, FP3_ADDR_INTERRUPT,
                     BIT(INTERRUPT_ENDED) | BIT(INTERRUPT_FAILED) |
                         (events & FP3_BARE_ON_END ? BIT(INTERRUPT_ENABLE) : 0) |
                         (events & FP3_BARE_ON_FAILURE ? BIT(INTERRUPT_ENABLE_FAILED) : 0))
               : FP3_E_ARGUMENT;
}

/* Taken back before the status is read: who ends after that raises it again. */
fp3_status fp3_bare_handle(fp3_bare *fp3, uint32_t scheduler, fp3_bare_outcome *outcome) {
    fp3_status status = fp3_bare_interrupt(fp3, scheduler, FP3_BARE_ON_END);
    if (!status)
        status = fp3_bare_poll(fp3, scheduler, outcome);
    if (!status && *outcome != FP3_BARE_RUNNING)
        status = fp3_bare_interrupt(fp3, scheduler, 0);
    return status;
}

/* ---- how it went ---- */

fp3_status fp3_bare_register(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint32_t *word) {
    return is_there(fp3, scheduler) ? get(fp3, scheduler, address, word) : FP3_E_ARGUMENT;
}

/* The high word may count on between the two: it is read again. */
fp3_status fp3_bare_counter(fp3_bare *fp3, uint32_t scheduler, uint32_t address, uint64_t *count) {
    uint32_t low = 0, high = 0, before;
    /* The field says how many of one there is less. */
    if (!is_there(fp3, scheduler) || (scheduler == FP3_ALL && fp3->schedulers > 1) ||
        FIELD(fp3->features_more, FEATURES_MORE_COUNTERS))
        return FP3_E_ARGUMENT;
    fp3_status status = get(fp3, scheduler, address + 4, &high);
    do {
        before = high;
        if (!status)
            status = get(fp3, scheduler, address, &low);
        if (!status)
            status = get(fp3, scheduler, address + 4, &high);
    } while (!status && high != before);
    if (!status)
        *count = (uint64_t)high << 32 | low;
    return status;
}

typedef union {
    float number;
    uint32_t bits;
} word;

uint32_t fp3_bare_bits(float number) { return (word){.number = number}.bits; }
float fp3_bare_number(uint32_t bits) { return (word){.bits = bits}.number; }
