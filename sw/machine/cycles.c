/* SPDX-License-Identifier: Apache-2.0 */
/* cycles.c - the issue stage of the solo machine, and the sweeps of the other one, counted. */
#include "cycles.h"

#include "gen/timing.h"
#include "operation.h"
#include "overlap.h"

#include <stdlib.h>
#include <string.h>

uint32_t fp3_cycles_latency(const fp3_config *config, uint32_t op) {
    const unsigned path = fp3_operation_find(op)->path;
    const int adds = (path & FP3_UNIT_ADDER) != 0;
    if (!config->fused || config->interleave)
        return (adds ? config->add_latency : 0) +
               (path & (FP3_UNIT_MULTIPLIER | FP3_UNIT_VALUE) ? config->mul_latency : 0);
    /* A sum alone is a multiply-add, too; a value is as late as a product. */
    return config->mul_latency +
           (adds && !(path & FP3_UNIT_VALUE) ? config->add_latency - FP3_TIMING_SOLO_FUSED : 0);
}

/* From a result that a bypass brings to the one that is read. */
static uint32_t read_of(const fp3_config *config) {
    return config->bypass ? 0 : FP3_TIMING_SOLO_READ;
}

uint32_t fp3_cycles_delay(const fp3_config *config, uint32_t op) {
    return fp3_cycles_latency(config, op) + read_of(config);
}

/* ---- one instruction after the other ---- */

typedef struct {
    uint32_t delay;  /* from a result to its reader, beyond the latency */
    int is_stalled;  /* nothing issues in a cycle in which a result is written */
    uint64_t now;    /* the first cycle in which the next instruction may issue */
    uint64_t writes; /* bit k: a result is written in cycle now + k */
    uint64_t end;    /* the cycle of the last write */
    uint64_t *ready; /* of each slot, when it is no longer busy */
    uint32_t slots;
} pipeline;

static void issue(pipeline *p, const fp3_timed *in) {
    uint64_t at = p->now > p->ready[in->d] ? p->now : p->ready[in->d];
    for (uint32_t i = 0; i < in->source_count; i++)
        if (p->ready[in->source[i]] > at)
            at = p->ready[in->source[i]];
    const uint64_t waits = at - p->now;
    p->writes = waits < 64 ? p->writes >> waits : 0;
    const uint32_t written = FP3_TIMING_SOLO_OPERANDS + in->latency;
    for (; p->writes >> written & 1 || (p->is_stalled && p->writes & 1); at++)
        p->writes >>= 1;
    p->writes = (p->writes | UINT64_C(1) << written) >> 1;
    p->ready[in->d] = at + in->latency + p->delay;
    p->now = at + 1;
    if (at + written > p->end)
        p->end = at + written;
}

static void run(pipeline *p, const fp3_timed *code, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        issue(p, &code[i]);
}

static int open_pipeline(pipeline *p, const fp3_config *config, uint32_t slots) {
    *p = (pipeline){.delay = read_of(config), .is_stalled = config->writeback_stall != 0};
    p->slots = slots;
    p->ready = config->mul_latency + config->add_latency <= FP3_LATENCY_LIMIT
                   ? calloc(slots + 1, sizeof *p->ready)
                   : NULL;
    return p->ready != NULL;
}

/* ---- steps, until they repeat ---- */

/* What the next instructions depend on: relative to now. */
static int is_alike(const pipeline *p, const pipeline *q) {
    if (p->writes != q->writes)
        return 0;
    for (uint32_t i = 0; i < p->slots; i++) {
        const uint64_t a = p->ready[i] > p->now ? p->ready[i] - p->now : 0;
        const uint64_t b = q->ready[i] > q->now ? q->ready[i] - q->now : 0;
        if (a != b)
            return 0;
    }
    return 1;
}

static void keep(pipeline *to, const pipeline *from) {
    uint64_t *ready = to->ready;
    memcpy(ready, from->ready, from->slots * sizeof *ready);
    *to = *from;
    to->ready = ready;
}

static void shift(pipeline *p, uint64_t cycles) {
    p->now += cycles;
    p->end += cycles;
    for (uint32_t i = 0; i < p->slots; i++)
        p->ready[i] += cycles;
}

/* Executes steps until one ends as an earlier one did, which *past then holds, or until all are
 * made. (Brent: the state that is compared with is renewed after 1, 2, 4 .. steps.) Gives the
 * steps in between, or 0. */
static uint64_t find_period(pipeline *p, pipeline *past, const fp3_timed_program *program,
                            uint64_t steps, uint64_t *made) {
    uint64_t since = 0, power = 1;
    keep(past, p);
    for (*made = 0; *made < steps;) {
        run(p, program->step, program->step_count);
        ++*made;
        if (is_alike(p, past))
            return since + 1;
        if (++since == power) {
            keep(past, p);
            power *= 2;
            since = 0;
        }
    }
    return 0;
}

uint64_t fp3_cycles_solo(const fp3_config *config, const fp3_timed_program *program,
                         uint64_t steps) {
    pipeline now, past = {0};
    uint64_t cycles = 0, made = 0;
    if (open_pipeline(&now, config, program->slots) &&
        open_pipeline(&past, config, program->slots) && steps) {
        run(&now, program->first, program->first_count);
        const uint64_t period = find_period(&now, &past, program, steps, &made);
        if (period) {
            shift(&now, (steps - made) / period * (now.now - past.now));
            for (uint64_t left = (steps - made) % period; left; left--)
                run(&now, program->step, program->step_count);
        }
        run(&now, program->last, program->last_count);
        cycles = now.end + FP3_TIMING_SOLO_AROUND;
    }
    free(now.ready);
    free(past.ready);
    return cycles;
}

double fp3_cycles_solo_step(const fp3_config *config, const fp3_timed_program *program) {
    /* A state is a few small numbers: they repeat long before this. */
    const uint64_t enough = 100000;
    pipeline now, past = {0};
    uint64_t made;
    double cycles = 0;
    if (open_pipeline(&now, config, program->slots) &&
        open_pipeline(&past, config, program->slots)) {
        run(&now, program->first, program->first_count);
        const uint64_t period = find_period(&now, &past, program, enough, &made);
        if (period)
            cycles = (double)(now.now - past.now) / (double)period;
    }
    free(now.ready);
    free(past.ready);
    return cycles;
}

/* ---- sweeps ---- */

static int is_shared(const fp3_config *config) { return config->schedulers > 1; }

#define LANES_OF_GROUP 4

/* AHEAD, LATENCY, GAP, SETTLE and GROUPS of rtl/config/derived.vh. */
static uint32_t ahead_of(const fp3_config *config) {
    return config->neighbours ? FP3_TIMING_REACH : 0;
}

static uint32_t latency_of(const fp3_config *config) {
    if (config->dual)
        return (config->mul_latency > config->add_latency ? config->mul_latency
                                                          : config->add_latency) +
               FP3_TIMING_EARLY;
    return config->mul_latency + config->add_latency + (is_shared(config) ? FP3_TIMING_SHARE : 0);
}

uint32_t fp3_cycles_gap(const fp3_config *config) { return latency_of(config) + FP3_TIMING_GAP; }

uint32_t fp3_cycles_settle(const fp3_config *config) {
    return latency_of(config) + ahead_of(config) + config->lanes + FP3_TIMING_SETTLE;
}

uint32_t fp3_cycles_groups(const fp3_config *config) {
    return (config->lanes + LANES_OF_GROUP - 1) / LANES_OF_GROUP;
}

static uint32_t grant_of(const fp3_config *config) {
    return is_shared(config) ? FP3_TIMING_GRANT : 0;
}

uint32_t fp3_cycles_operands(const fp3_config *config) {
    if (!config->interleave)
        return FP3_TIMING_SOLO_OPERANDS;
    return FP3_TIMING_OPERANDS + (is_shared(config) ? FP3_TIMING_SHARE : 0) +
           (config->dual ? FP3_TIMING_EARLY : 0) + ahead_of(config);
}

uint32_t fp3_cycles_write(const fp3_config *config) {
    return config->interleave ? FP3_TIMING_WRITE : 0;
}

uint64_t fp3_cycles_sweep(const fp3_config *config, uint32_t n, fp3_grant grant) {
    const uint32_t gap = fp3_cycles_gap(config);
    const uint32_t width = n + (grant == FP3_GRANTED ? grant_of(config) : 0);
    return n == 0 ? 0 : width > gap ? width : gap;
}

uint32_t fp3_cycles_waiting(const fp3_config *config) {
    return fp3_cycles_gap(config) - grant_of(config);
}

static uint64_t instructions_of(const fp3_swept *visit) {
    const uint64_t in_step = visit->last - visit->step;
    return visit->count - in_step + visit->steps * in_step;
}

/* Of all batches of a round, from the first issue on. */
static uint64_t overlapped(const fp3_config *config, uint32_t rows, const fp3_swept *visit) {
    fp3_overlap now = {0};
    for (uint32_t left = rows, n; left; left -= n) {
        n = left < config->contexts ? left : config->contexts;
        fp3_overlap_visit(&now, visit, n, fp3_cycles_gap(config));
    }
    return fp3_overlap_end(&now);
}

/* Between the copies of one word and those of the next (rtl/sequence/fp3_exchange.v). */
#define WORD_BEGINS 2

uint64_t fp3_cycles_copies(const fp3_config *config, uint32_t copies, uint32_t words) {
    const uint64_t all = copies ? (uint64_t)words * (copies + WORD_BEGINS) : 0;
    return config->exchange ? all + fp3_cycles_groups(config) + FP3_TIMING_COPY : 0;
}

uint32_t fp3_cycles_around_round(const fp3_config *config) {
    return fp3_cycles_settle(config) + FP3_TIMING_ROUND +
           (config->neighbours ? FP3_TIMING_DECODED : 0);
}

uint64_t fp3_cycles_round(const fp3_config *config, uint32_t rows, const fp3_swept *visit) {
    const uint32_t n = config->contexts;
    const uint64_t sweeps = rows / n * fp3_cycles_sweep(config, n, FP3_GRANTED) +
                            fp3_cycles_sweep(config, rows % n, FP3_GRANTED);
    if (!rows)
        return 0;
    const uint64_t issues =
        config->dual ? overlapped(config, rows, visit) : instructions_of(visit) * sweeps;
    return issues + fp3_cycles_around_round(config) + fp3_cycles_copies(config, 0, 0);
}

uint64_t fp3_cycles_interleaved(const fp3_config *config, uint32_t rows, uint64_t rounds,
                                const fp3_swept *visit) {
    /* A pause stands before a sweep, and there is none before the first of a round. */
    const uint32_t first = rows < config->contexts ? rows : config->contexts;
    const uint64_t unpaused =
        config->dual ? 0 : fp3_cycles_sweep(config, first, FP3_UNGRANTED) - first;
    return rounds * (fp3_cycles_round(config, rows, visit) - unpaused) + fp3_cycles_settle(config) +
           FP3_TIMING_RUN;
}

double fp3_cycles_swept_step(const fp3_config *config, const fp3_swept *visit) {
    const uint32_t n = config->contexts;
    const double cycles = config->dual ? fp3_overlap_step(visit, n, fp3_cycles_gap(config))
                                       : (double)(visit->last - visit->step) *
                                             (double)fp3_cycles_sweep(config, n, FP3_UNGRANTED);
    return cycles / n;
}
