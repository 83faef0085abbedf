/* SPDX-License-Identifier: Apache-2.0 */
/* in_flight.c - see in_flight.h. */
#include "in_flight.h"

#include <assert.h>
#include <stdlib.h>

/* More than any scheduler has in flight: one instruction a cycle for the length of a lane's
 * pipeline and then of the chain of 64 lanes. */
#define ROOM 1024u

typedef struct {
    fp3_rtl_issue issue;
    int is_over; /* where instructions overtake: it has ended */
} entry;

typedef struct {
    entry ring[ROOM]; /* by the number of the issue, modulo ROOM */
    uint64_t count;   /* issues so far */
} queue;

struct fp3_in_flight {
    uint32_t lanes;
    int overtakes, is_lost;
    queue *queues;  /* by scheduler */
    uint64_t *next; /* by scheduler and lane: the oldest issue that has not ended there */
};

fp3_in_flight *fp3_in_flight_make(const fp3_config *config) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    fp3_in_flight *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->lanes = config->lanes;
    f->overtakes = !config->interleave;
    f->queues = calloc(schedulers, sizeof *f->queues);
    f->next = calloc((size_t)schedulers * config->lanes, sizeof *f->next);
    if (f->queues && f->next)
        return f;
    fp3_in_flight_free(f);
    return NULL;
}

void fp3_in_flight_free(fp3_in_flight *in_flight) {
    if (!in_flight)
        return;
    free(in_flight->queues);
    free(in_flight->next);
    free(in_flight);
}

void fp3_in_flight_issue(fp3_in_flight *in_flight, const fp3_rtl_issue *issue) {
    queue *q = &in_flight->queues[issue->scheduler];
    q->ring[q->count++ % ROOM] = (entry){.issue = *issue};
}

/* Whether the instruction can end like this. */
static int fits(const fp3_in_flight *f, const fp3_rtl_issue *issue, const fp3_rtl_end *end) {
    fp3_instruction in;
    if (issue->context != end->result.context || issue->cycle >= end->result.cycle ||
        fp3_word_decode(issue->word, &in, NULL))
        return 0;
    return f->overtakes ? in.d == end->result.reg : !end->has_result || in.d == end->result.reg;
}

/* The issue that ends, or NULL; *next goes past all that have ended. */
static const fp3_rtl_issue *find(const fp3_in_flight *f, queue *q, uint64_t *next,
                                 const fp3_rtl_end *end) {
    assert(q->count - *next <= ROOM);
    const uint64_t last = f->overtakes || *next == q->count ? q->count : *next + 1;
    for (uint64_t i = *next; i < last; i++) {
        entry *e = &q->ring[i % ROOM];
        if (e->is_over || !fits(f, &e->issue, end))
            continue;
        if (!f->overtakes)
            ++*next;
        for (e->is_over = f->overtakes; *next < q->count && q->ring[*next % ROOM].is_over;)
            ++*next;
        return &e->issue;
    }
    return NULL;
}

int fp3_in_flight_end(fp3_in_flight *in_flight, const fp3_rtl_end *end, fp3_traced *traced) {
    if (in_flight->is_lost) /* nothing that follows can be paired */
        return 0;
    const fp3_retirement *r = &end->result;
    uint64_t *next = &in_flight->next[r->scheduler * in_flight->lanes + r->lane];
    const fp3_rtl_issue *issue = find(in_flight, &in_flight->queues[r->scheduler], next, end);
    if (!issue) {
        in_flight->is_lost = 1;
        return 0;
    }
    *traced = (fp3_traced){.issued = issue->cycle,
                           .ended = r->cycle,
                           .scheduler = r->scheduler,
                           .lane = r->lane,
                           .context = r->context,
                           .pc = issue->pc,
                           .word = issue->word,
                           .outcome = end->outcome,
                           .object = r->object,
                           .has_result = end->has_result};
    if (end->has_result) {
        traced->bits = r->bits;
        traced->flags = r->flags;
    }
    return 1;
}

int fp3_in_flight_is_lost(const fp3_in_flight *in_flight) { return in_flight->is_lost; }
