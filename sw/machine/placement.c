/* SPDX-License-Identifier: Apache-2.0 */
/* placement.c - which schedulers run which group of objects.
 *
 * How many each group gets is solved exactly; which schedulers share an arithmetic unit, where
 * some do, by a rule of thumb.
 */
#include "placement.h"

#include "cycles.h"

#include "gen/registers.h"
#include <fp3/image.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>

#define ROWS_MAX 65536u
#define ALL_STEPS                                                                                  \
    1000u /* of a visit that makes all: enough that first and last part hardly count */

uint32_t fp3_placement_rows(const fp3_config *config, uint32_t log2) {
    const uint32_t records =
        config->store_words >> (log2 < FP3_RECORD_LOG2 ? FP3_RECORD_LOG2 : log2);
    if (config->store_words == FP3_STORE_HOST)
        return FP3_HOST_OBJECTS;
    return records < ROWS_MAX ? records : ROWS_MAX;
}

uint32_t fp3_placement_room(const fp3_config *config) {
    if (!config->interleave)
        return 1;
    return fp3_placement_rows(config, 0) * fp3_config_schedulers(config) * config->lanes;
}

static uint32_t divide_up(uint64_t a, uint64_t b) { return (uint32_t)((a + b - 1) / b); }

uint32_t fp3_placement_fullest(const fp3_config *config, uint32_t objects, uint32_t schedulers) {
    return divide_up(objects, (uint64_t)schedulers * config->lanes);
}

/* ---- what it costs ---- */

/* In a visit of one object: instructions, and how often it needs each unit. */
typedef struct {
    uint64_t issues, adds, muls;
    fp3_swept visit;
} uses;

static uses uses_of(const fp3_code *program, uint32_t visit) {
    uses sum = {.visit = {program->decoded, program->count, program->step, program->last,
                          visit ? visit : ALL_STEPS}};
    for (uint32_t pc = 0; pc < program->count; pc++) {
        const uint64_t times = pc < program->step || pc >= program->last ? 1
                               : visit                                   ? visit
                                                                         : ALL_STEPS;
        const fp3_operation *operation = program->decoded[pc].of;
        const unsigned of = operation ? operation->path : 0;
        sum.issues += times;
        sum.adds += of & FP3_UNIT_ADDER ? times : 0;
        sum.muls += of & FP3_UNIT_MULTIPLIER ? times : 0;
    }
    return sum;
}

static uint64_t cycles_of(const fp3_config *config, const uses *of, uint32_t rows) {
    if (!config->interleave)
        return of->issues;
    return fp3_cycles_round(config, rows, &of->visit);
}

uint64_t fp3_placement_cycles(const fp3_config *config, const fp3_code *program, uint32_t visit,
                              uint32_t rows) {
    const uses of = uses_of(program, visit);
    return cycles_of(config, &of, rows);
}

/* ---- how many schedulers each group gets ---- */

typedef struct {
    uses of;
    uint32_t objects;
    uint32_t schedulers, least, most; /* those it has; its objects need; beyond which none helps */
    uint32_t homeless;                /* of its schedulers: which ones they are is not decided */
    uint64_t cycles;
} share;

static void give(const fp3_config *config, share *s, uint32_t schedulers) {
    s->schedulers = schedulers;
    s->cycles = cycles_of(config, &s->of, fp3_placement_fullest(config, s->objects, schedulers));
}

static share share_of(const fp3_config *config, uint32_t visit, const fp3_to_place *group) {
    share s = {.of = uses_of(group->program, visit), .objects = group->objects, .least = 1};
    if (config->interleave)
        s.least = divide_up(group->objects,
                            (uint64_t)fp3_placement_rows(config, group->log2) * config->lanes);
    /* A batch so short that its instructions wait for each other is as fast as it gets. */
    const uint32_t waits = fp3_cycles_waiting(config);
    const uint32_t rows = config->contexts < waits ? config->contexts : waits;
    s.most = divide_up(group->objects, (uint64_t)rows * config->lanes);
    give(config, &s, s.least);
    return s;
}

/* The group that ends last, of those that one more scheduler may help; count if there is none. */
static size_t slowest(const share *shares, size_t count) {
    size_t found = count;
    for (size_t i = 0; i < count; i++)
        if (shares[i].schedulers < shares[i].most &&
            (found == count || shares[i].cycles > shares[found].cycles))
            found = i;
    return found;
}

/* Each further scheduler goes to the group that ends last. No other division ends earlier. For let
 * T be the end of the best one. Cycles never rise with schedulers, so a group that ends after T has
 * fewer than in the best division, and one that no scheduler helps ends by T. While some group ends
 * after T, each scheduler so goes to one that has fewer than in the best division: none gets more
 * than there, and before the schedulers are used up all end by T. */
static void divide(const fp3_config *config, share *shares, size_t count, uint32_t left) {
    for (; left > 0; left--) {
        const size_t i = slowest(shares, count);
        if (i == count)
            break;
        give(config, &shares[i], shares[i].schedulers + 1);
    }
    /* Schedulers that help no group are dealt out. */
    for (size_t i = 0; left > 0; i = (i + 1) % count, left--)
        give(config, &shares[i], shares[i].schedulers + 1);
}

static fp3_status check_room(const fp3_config *config, const share *shares, size_t count,
                             fp3_error *error) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    uint64_t needed = 0;
    for (size_t i = 0; i < count; i++)
        needed += shares[i].least;
    if (needed > schedulers)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "the objects of all groups need the stores of %" PRIu64
                        " schedulers: configuration '%s' has %" PRIu32,
                        needed, config->name, schedulers);
    return FP3_OK;
}

/* ---- which schedulers these are ---- */

static uint64_t most_of(uint64_t a, uint64_t b) { return a > b ? a : b; }

/* What the schedulers of a tile need together. */
typedef struct {
    uint64_t cycles, adds, muls; /* of the longest; of all */
    uint32_t schedulers;
} tile;

static tile with(const tile *t, const share *s) {
    const uint64_t objects = divide_up(s->objects, s->schedulers);
    return (tile){most_of(t->cycles, s->cycles), t->adds + s->of.adds * objects,
                  t->muls + s->of.muls * objects, t->schedulers + 1};
}

static uint64_t end_of(const tile *t) { return most_of(t->cycles, most_of(t->adds, t->muls)); }

/* The tile that then ends earliest, of those that have a scheduler left. */
static uint32_t best_tile(const fp3_config *config, const tile *tiles, const share *s) {
    uint32_t best = config->tiles;
    uint64_t end = UINT64_MAX;
    for (uint32_t i = 0; i < config->tiles; i++) {
        const tile then = with(&tiles[i], s);
        if (tiles[i].schedulers < config->schedulers && end_of(&then) < end) {
            best = i;
            end = end_of(&then);
        }
    }
    return best;
}

/* Who needs most comes first, and each goes where it hurts least: so a program that multiplies
 * meets one that adds, and a long one a short one. A rule of thumb (longest first), not the best.
 */
static void pair(const fp3_config *config, share *shares, size_t count, tile *tiles,
                 uint32_t *group_of) {
    for (uint32_t left = fp3_config_schedulers(config); left > 0; left--) {
        size_t next = count;
        for (size_t i = 0; i < count; i++)
            if (shares[i].homeless && (next == count || shares[i].cycles > shares[next].cycles))
                next = i;
        const uint32_t t = best_tile(config, tiles, &shares[next]);
        group_of[t * config->schedulers + tiles[t].schedulers] = (uint32_t)next;
        tiles[t] = with(&tiles[t], &shares[next]);
        shares[next].homeless--;
    }
}

static void in_order(const share *shares, size_t count, uint32_t *group_of) {
    uint32_t scheduler = 0;
    for (size_t i = 0; i < count; i++)
        for (uint32_t n = 0; n < shares[i].schedulers; n++)
            group_of[scheduler++] = (uint32_t)i;
}

fp3_status fp3_placement_make(const fp3_config *config, uint32_t visit, const fp3_to_place *groups,
                              size_t count, uint32_t *group_of, fp3_error *error) {
    share *shares = calloc(count, sizeof *shares);
    tile *tiles = calloc(config->tiles, sizeof *tiles);
    fp3_status status = shares && tiles ? FP3_OK : fp3_no_memory(error);
    uint32_t left = fp3_config_schedulers(config);
    for (size_t i = 0; !status && i < count; i++)
        shares[i] = share_of(config, visit, &groups[i]);
    if (!status)
        status = check_room(config, shares, count, error);
    for (size_t i = 0; !status && i < count; i++)
        left -= shares[i].schedulers;
    if (!status) {
        divide(config, shares, count, left);
        for (size_t i = 0; i < count; i++)
            shares[i].homeless = shares[i].schedulers;
        if (config->schedulers == 1)
            in_order(shares, count, group_of);
        else
            pair(config, shares, count, tiles, group_of);
    }
    free(shares);
    free(tiles);
    return status;
}
