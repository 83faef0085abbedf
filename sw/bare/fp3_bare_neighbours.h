/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare_neighbours.h - objects that see each other, from a processor of your own: links, all,
 * near.
 *
 *     static uint32_t next[BALLS], order[BALLS], first[CELLS + 2];
 *     static int32_t made[BALLS][3];
 *     fp3_bare_near touch = {.list = ball_list_touch, .position = {ball_state_x_x, ...},
 *                            .dimensions = 3, .reach = fp3_bare_bits(0.1f),
 *                            .skin = fp3_bare_bits(0.02f), .made = made, .order = order,
 *                            .first = first, .cells = CELLS};
 *     fp3_bare_neighbours n;
 *     if (fp3_bare_load(&fp3, 0, &ball_program) || fp3_bare_neighbours_open(&n, &fp3, BALLS, next)
 *         || ... fp3_bare_write of each ball ... || fp3_bare_near_add(&n, &touch) ||
 *         fp3_bare_near_run(&n, 1000, 0, POLLS, &outcome))
 *         ... n.failed is the object that could not be served ...
 *
 * Freestanding, beside fp3_bare.h; all numbers are bits, and computed with as integers, so a
 * processor without an FPU needs no library. Hardware with neighbours and one lane (configuration
 * `world`). Every list is in the order of the host's: links as they are given, the others by the
 * numbers of objects; so the words of a run are those of `fp3 run`.
 *
 * Not here: near objects that remember fields, a second list of near ones, objects of two programs.
 */
#ifndef FP3_BARE_NEIGHBOURS_H
#define FP3_BARE_NEIGHBOURS_H

#include "fp3_bare.h"

FP3_API_BEGIN

typedef struct {
    uint32_t list;        /* NAME_list_touch */
    uint32_t position[3]; /* the registers of the position */
    uint32_t dimensions;  /* 1 to 3 of them */
    /* FP32 bits. The list has all that are nearer than reach + skin, and is made again when an
     * object has moved by half the skin. reach: from 2^-50 on, below 2^63; if it differs from
     * pair to pair, the longest. skin: 0 to 2^16 times the reach, usually a tenth to a third. */
    uint32_t reach, skin;
    /* Memory of the caller's: `objects` elements of the first two; cells + 2 of the last, where
     * cells is 1 or more: as many as objects is good. */
    int32_t (*made)[3];
    uint32_t *order, *first, cells;
    uint32_t lists; /* how many were made: read it */
    /* The driver's own. */
    int32_t least[3];
    uint32_t far, side, count[3];
} fp3_bare_near;

/* Two objects that see each other, by their numbers. */
typedef struct {
    uint32_t a, b;
} fp3_bare_link;

/* Read it, never change it. */
typedef struct {
    fp3_bare *fp3;
    const fp3_bare_program *program;
    uint32_t objects;
    uint32_t *next;      /* memory of the caller's: `objects` words */
    uint32_t failed;     /* the object that the last refusal is about, or the link */
    uint32_t free[2];    /* the first word of either half of the store that no list has */
    fp3_bare_near *near; /* NULL: there is none */
} fp3_bare_neighbours;

/* Objects 0 to objects - 1 of the program that is loaded, all of which runs visit; no others can be
 * written from now on, because lists follow behind them. Then give each list of the program once,
 * the near one last. FP3_E_ARGUMENT: the objects of the program see nobody, or are more than half
 * of the store has room for, or a program runs. */
fp3_status fp3_bare_neighbours_open(fp3_bare_neighbours *n, fp3_bare *fp3, uint32_t objects,
                                    uint32_t *next);

/* Each of the two ends has the other in its list, with the same fields: those of link i are
 * fields[i * the fields of the list], and may be NULL if there are none. FP3_E_ARGUMENT: there is
 * no such list, or it is there, or an end of link `failed` is no object or both are the same.
 * FP3_E_PROGRAM: the list of object `failed` has more than 4,095 entries, or there is no room for
 * it in the store. */
fp3_status fp3_bare_links(fp3_bare_neighbours *n, uint32_t list, const fp3_bare_link *links,
                          uint32_t count, const uint32_t *fields);
/* All other objects. Likewise; FP3_E_ARGUMENT also if the list has fields. */
fp3_status fp3_bare_all(fp3_bare_neighbours *n, uint32_t list);
/* Objects that are near, from the next run on. Likewise; FP3_E_ARGUMENT also if something in *near
 * is out of range. n keeps the pointer. */
fp3_status fp3_bare_near_add(fp3_bare_neighbours *n, fp3_bare_near *near);

/* So many steps with near objects: before each phase it reads their positions, and makes the list
 * again if it has to. fp3_bare_start is refused for such programs. polls: as in fp3_bare_wait, for
 * each phase. Ends early if a phase ends in another way than FP3_BARE_DONE. After a failure, and
 * such an end, load the program anew. FP3_E_FAILED: the position of object `failed` is not finite.
 * FP3_E_LIMIT: it is more than 2^17 times the reach away from 0; or, with *outcome
 * FP3_BARE_RUNNING, a phase still runs. FP3_E_PROGRAM: as for links. */
fp3_status fp3_bare_near_run(fp3_bare_neighbours *n, uint32_t steps, uint32_t clock, uint32_t polls,
                             fp3_bare_outcome *outcome);

FP3_API_END

#endif
