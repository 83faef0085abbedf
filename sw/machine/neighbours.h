/* SPDX-License-Identifier: Apache-2.0 */
/* neighbours.h - what a program reads of other objects: its lists, its phases, what it publishes.
 *
 * A program with neighbours has loops (`each` .. `next`) and phases (`phase`). In a phase all loads
 * come before all stores, so what a neighbour's record held when the phase began is what a machine
 * without a second copy of it reads, too, if no object stores before the last has loaded.
 */
#ifndef FP3_IMAGE_NEIGHBOURS_H
#define FP3_IMAGE_NEIGHBOURS_H

#include "placement.h"

#include <fp3/image.h>

#define FP3_LISTS_MAX 8
#define FP3_FIELDS_MAX 64 /* of an entry, and of a model's relations */

/* A list of neighbours that each object has. */
typedef struct {
    uint32_t reg;    /* that `each` names */
    uint32_t fields; /* of an entry: as many as its loops read and write */
    uint64_t kept;   /* those that a loop writes: bit f for field f */
} fp3_list_shape;

typedef struct {
    fp3_list_shape lists[FP3_LISTS_MAX];
    uint32_t list_count;
    uint64_t published; /* words that neighbours read: bit r for register r */
    uint64_t worst;     /* words that are compared over all objects: each `.worst` */
    uint32_t phases;    /* that a step makes */
    uint32_t distinct;  /* ... each counted once, however often it is made */
    int is_any;         /* there is an instruction with neighbours */
} fp3_neighbourhood;

/* Where `repeat` and `again` have brought a step to. */
typedef struct {
    uint32_t begin, left; /* the first word that is repeated; how often it is still made */
} fp3_repetition;

/* The word behind one that ends a phase. */
uint32_t fp3_neighbourhood_behind(const struct fp3_decoded *decoded, uint32_t at,
                                  fp3_repetition *repetition);

/* FP3_E_PROGRAM: a loop within a loop, or without its end; a repetition likewise; something that
 * reads a neighbour outside of a loop; a phase within a loop; a first or a last part; a store in a
 * loop; a load behind a store of the same phase; a field read behind an `stl` of the same phase; a
 * phase that does not store a word which neighbours read and another phase stores; loops over one
 * list with different numbers of fields; more than FP3_LISTS_MAX lists, or FP3_FIELDS_MAX fields of
 * an entry; `sleep` beside all this; a word that makes lists, which is the driver's; a `.worst`
 * that no phase, or the last one, stores. */
fp3_status fp3_neighbourhood_find(const fp3_image *image, fp3_neighbourhood *found,
                                  fp3_error *error);

/* The words of a phase that a step makes, from 0, without the one that ends it; 0: there is no such
 * phase. */
int fp3_neighbourhood_phase(const fp3_code *program, uint32_t phase, uint32_t *first,
                            uint32_t *end);

/* Those of `worst` that the phase has stored which comes before the one that begins at this word:
 * before that one begins, every object gets the largest of them all, and a NaN is larger than any
 * number. */
uint64_t fp3_neighbourhood_compared(const fp3_neighbourhood *shape, const fp3_code *program,
                                    uint32_t begin);

/* Index of the `next` of the loop that begins at `each`. */
uint32_t fp3_neighbourhood_end(const struct fp3_decoded *decoded, uint32_t each);

#endif
