/* SPDX-License-Identifier: Apache-2.0 */
/* fast_own.h - what the "fast" engine keeps: fp3_engine.self. */
#ifndef FP3_ENGINE_FAST_OWN_H
#define FP3_ENGINE_FAST_OWN_H

#include "engine/common/backend.h"

#include "around.h"
#include "base/threads.h"
#include "fast.h"
#include "plan.h"

#include <fp3/isa.h>
#include <stdatomic.h>

/* Objects of a group that are worked on together: whole vectors, except for the last. */
typedef struct {
    uint32_t first, count;
} piece;

/* A program and its objects. */
typedef struct {
    fp3_fast *program;
    uint8_t *is_ahead;
    uint32_t *awake; /* by number, if it can sleep */
    uint32_t awake_count;
    fp3_fast_packed lists[FP3_LISTS_MAX]; /* of neighbours, as the executor needs them */
    uint32_t *in_rows[FP3_LISTS_MAX]; /* links of rows, where some objects do not live; or NULL */
    float *records;                   /* of what neighbours read, or NULL */
    int is_packed;
    piece *pieces; /* where links alone show guests: first those that see none; or NULL */
    uint32_t piece_count, inner_count;
} group;

/* What the threads share: block n is of the group whose blocks begin at or before it. */
typedef struct {
    fp3_engine *engine;
    uint32_t steps;
    uint64_t blocks;
    atomic_uint_fast64_t next;
} work;

/* A thread's. */
typedef struct {
    fp3_fast_worker *worker; /* NULL until it is needed */
    uint64_t block;          /* that it has in hand */
    atomic_uint next;        /* in a phase: the next block of its share */
    fp3_status status;
    fp3_error error;
} hand;

typedef struct {
    uint32_t *column[FP3_BANK_OBJECT_COUNT];
    uint32_t *row;      /* of each object in the columns; NULL: its number */
    uint64_t order_due; /* how many lists of those that are near have been made when rows get a new
                           order */
    uint32_t
        *other_half[FP3_BANK_OBJECT_COUNT]; /* of words that neighbours read: what a phase writes */
    uint32_t *status;
    uint32_t
        *slept_in; /* the number of the run in which an object fell asleep, or ASLEEP; 0: awake */
    uint32_t runs; /* since the last list, from ASLEEP on */
    int has_steps; /* the last run */
    uint32_t *shared; /* of all groups */
    group *groups;
    uint32_t count;
    fp3_threads *threads;
    work work; /* of a run */
    hand *hands;
    uint32_t hand_count, used; /* all; those of the last run */
} fast;

/* Whether the objects of some group see each other. */
int fp3_around_is_any(const fp3_engine *engine);
/* About how often an object goes through its loops, and 1. */
double fp3_around_turns(const fp3_engine *engine);
/* Steps of programs with neighbours: all objects make a phase before any makes the next one. All
 * groups have such a program, or this refuses. */
fp3_status fp3_around_run(fp3_engine *engine, uint32_t steps);
/* How many rows make steps. */
uint32_t fp3_order_rows(const fp3_members *members);
/* At the beginning of a phase: where some objects do not live, the others stand in the first rows,
 * by their numbers. Objects that see only those near them stand in rows cell by cell, so
 * that neighbours are in cache. Lists are then of rows; their order stays that of the objects'
 * numbers. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_order_follow(fp3_engine *engine, fp3_members *members);
/* Each object stands at its number. */
fp3_status fp3_order_undo(fp3_engine *engine);
/* The lists have changed. */
void fp3_around_forget(group *g);

#endif
