/* SPDX-License-Identifier: Apache-2.0 */
/* sparse.h - linear equations of bodies of which few meet each other.
 *
 * The matrix is symmetric and positive, of square blocks: one for each body, one for each two that
 * meet. It is L L' after the bodies are put in an order in which few more blocks arise: who
 * meets one other goes first, so a tree has none; then who meets fewest, the lowest number first.
 * The order and its blocks are found once; values may change then as often as they like.
 */
#ifndef FP3_BASE_SPARSE_H
#define FP3_BASE_SPARSE_H

#include <fp3/status.h>
#include <stdint.h>

#define FP3_SPARSE_MOST 6 /* rows of a block, at most */

typedef struct {
    uint32_t to, next, block; /* next, of the same body: UINT32_MAX, none */
} fp3_meeting;

typedef struct {
    uint32_t to, block; /* to: who is eliminated later */
} fp3_later;

typedef struct {
    uint32_t count, size; /* bodies; rows of a block: 3 or 6 */
    /* Those for whom the order was found. */
    uint32_t (*pair)[2], pairs, laid, laid_pairs;
    uint32_t *first, *degree, *rank, *order, *few; /* rank: UINT32_MAX until it has one */
    fp3_meeting *meeting;
    uint32_t meetings;
    /* Of the body that is eliminated k-th: from start[k] on those that it still meets, ascending by
     * rank; from target[k] on the blocks of each two of them. */
    uint32_t *start, *target, *onto;
    fp3_later *later;
    double *block; /* of bodies; then of those that meet: the row is of who is eliminated first */
    uint32_t pair_room, first_room, degree_room, rank_room, order_room, few_room, meeting_room,
        start_room, target_room, onto_room, later_room, block_room;
} fp3_sparse;

/* Begins to say who meets: `count` bodies, blocks of `size` rows. */
void fp3_sparse_begin(fp3_sparse *s, uint32_t count, uint32_t size);
/* a and b meet. They may do so twice. */
fp3_status fp3_sparse_meet(fp3_sparse *s, uint32_t a, uint32_t b, fp3_error *error);
/* All is said. */
fp3_status fp3_sparse_order(fp3_sparse *s, fp3_error *error);
/* All blocks are 0. */
void fp3_sparse_clear(fp3_sparse *s);
/* The block of body a, or of two that meet; *is_swapped: its rows are b's. */
double *fp3_sparse_block(const fp3_sparse *s, uint32_t a, uint32_t b, int *is_swapped);
/* Whether the matrix is positive. */
int fp3_sparse_factor(fp3_sparse *s);
/* `size` numbers for each body: the right side becomes the solution. */
void fp3_sparse_solve(const fp3_sparse *s, double *x);
void fp3_sparse_free(fp3_sparse *s);

#endif
