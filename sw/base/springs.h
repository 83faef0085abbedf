/* SPDX-License-Identifier: Apache-2.0 */
/* springs.h - impulses between bodies, all at once.
 *
 * Each impulse is that of a stiff spring, c - k times a speed, within limits; those of friction
 * follow other impulses. In space both tangents of a contact have one limit together, a disc. What
 * bodies do then is the least of an energy that is convex while limits stay. Newton's method finds
 * it, with a step along its way that is no longer than the energy falls; limits of friction are
 * found by turns with it. In double precision.
 */
#ifndef FP3_BASE_SPRINGS_H
#define FP3_BASE_SPRINGS_H

#include "sparse.h"

#include <stddef.h>

#define FP3_NO_SPRING UINT32_MAX

typedef struct {
    uint32_t a, b; /* bodies; FP3_NO_SPRING: what does not move */
    double of_a[FP3_SPARSE_MOST], of_b[FP3_SPARSE_MOST]; /* its speed, by those of both */
    double c, k, least, most;
    uint32_t normal, normals; /* of friction: the first row, and how many, whose impulses together
                               * times `share` are its limit; FP3_NO_SPRING */
    double share;
    int is_disc; /* this row and the next one stay together within `most` of 0, a disc */
    double want; /* speed that it should have; beside what is given, by who is not moved */
    double given;
    int is_driven; /* a motor, a spring, a belt: it may give energy */
    double before; /* the impulse that both have of it already */
    float *word;   /* where its impulse stands */
    int8_t *was;   /* at which limit it was at last: -1, 1; 0: none. Of a disc: hundredths of
                    * `along` */
    /* While they are found. */
    int side; /* likewise; of both rows of a disc 1 at its edge */
    double now, last, last_now;
    double along; /* at the edge of a disc: of the impulse's direction */
    double bent;  /* ... and k across it is this share of k */
} fp3_spring;

typedef struct {
    uint32_t count, size; /* bodies; numbers of each: 3 or 6 */
    uint32_t rows;
    double hardest; /* k of what does not yield */
    fp3_spring *row;
    double *mass;      /* of each body, size * size numbers */
    double *v, *start; /* of each body: its speed, and what it was before */
    double *slope, *way, *next;
    fp3_sparse sparse;
    uint32_t row_room, mass_room, v_room, start_room, slope_room, way_room, next_room;
} fp3_springs;

/* `count` bodies of `size` numbers: who meets is said next (sparse.h). */
void fp3_springs_begin(fp3_springs *s, uint32_t count, uint32_t size, double hardest);
/* Then room for `rows` rows and for speeds. */
fp3_status fp3_springs_make_room(fp3_springs *s, size_t rows, fp3_error *error);
/* A new one that does not yield, without limits, and with all else 0. */
fp3_spring *fp3_springs_add(fp3_springs *s, uint32_t a, uint32_t b, float *word, int8_t *was);
/* Speeds and impulses; 0: none were found, because masses are too far apart for double or rows come
 * to limits and leave them without end. */
int fp3_springs_solve(fp3_springs *s);
/* Impulses go where they stand. */
void fp3_springs_keep(const fp3_springs *s);
/* How fast a row is, by speeds of bodies. */
double fp3_springs_speed(const fp3_springs *s, const fp3_spring *row, const double *v);
void fp3_springs_free(fp3_springs *s);

#endif
