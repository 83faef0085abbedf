/* SPDX-License-Identifier: Apache-2.0 */
/* layout.h - groups of objects, each with its program, and where each object is.
 *
 * Object i of a group is row i / columns of lane i % columns, counted through the lanes of the
 * group's schedulers. Where objects see each other, each lane has objects that follow each other
 * instead, by their numbers or by an order of its own: most neighbours are then in the same lane.
 * Guests are dealt out to the lanes, into the rows behind.
 */
#ifndef FP3_LAYOUT_H
#define FP3_LAYOUT_H

#include "lists.h"
#include "machine/placement.h"

#include <fp3/engine.h>
#include <machine/visit.h>

typedef struct {
    fp3_image *image; /* NULL before the first load, as is visit */
    fp3_visit *visit; /* NULL if not interleaved */
    fp3_code program;
    uint32_t needs; /* of words in the store, for each object: the binary logarithm */
    uint32_t first, rows;
    uint32_t from,
        objects;   /* of the rows, those that make steps; the others can be read as neighbours */
    uint32_t away; /* of objects that see each other: how many stand behind, as they do not live */
    uint32_t scheduler_count, columns;
    const uint32_t *schedulers; /* ascending */
    uint64_t steps;             /* that its objects made in the last run */
    int counter;                /* register in which the program counts its steps, or -1 */
    int rest;                   /* the register of `at_rest` (kinds_rest.c), or -1 */
    int removed;                /* the register of `is_removed` (removed.h), or -1 */
    uint64_t slept;  /* object-steps that those made who slept so, in this part of a run: none */
    int64_t counted; /* the most steps that an object has there */
    uint32_t log2;   /* interleaved: of the words of a record, as many as fit */
    fp3_lists lists; /* of neighbours */
    uint32_t *slot, *who; /* the order in which lanes take objects, and its inverse; NULL: as they
                             are numbered */
    fp3_foreign *foreign; /* words that it reads of other groups; their names are its own */
    uint32_t foreign_count;
    uint8_t *is_ahead; /* of each word of the program, if it is watched; else NULL */
    uint64_t live;     /* ... and the registers that a step leaves to what follows */
} fp3_members;

/* Objects of the engine that make steps. */
static inline uint32_t fp3_members_begin(const fp3_members *group) {
    return group->first + group->from;
}

static inline uint32_t fp3_members_end(const fp3_members *group) {
    return fp3_members_begin(group) + group->objects;
}

static inline void fp3_members_use(fp3_members *group, uint32_t from, uint32_t objects) {
    group->from = from;
    group->objects = objects;
}

typedef struct {
    uint32_t group;
    uint32_t rank; /* among the schedulers of the group */
} fp3_duty;

#define FP3_JOINED_MAX 8 /* groups that see each other */

typedef struct {
    fp3_members *groups;
    uint32_t count;
    uint32_t *schedulers; /* those of group 0, then those of group 1, ... */
    fp3_duty *duty;       /* of each scheduler */
} fp3_layout;

typedef struct {
    uint32_t scheduler, lane, row;
} fp3_where;

/* Room for so many groups, all 0; the caller fills in image and visit, which the layout
 * then owns, program, needs and objects, and has them placed. The caller frees *layout. */
fp3_status fp3_layout_make(const fp3_config *config, uint32_t count, fp3_layout *layout,
                           fp3_error *error);
/* FP3_E_PROGRAM as of fp3_placement_make. */
fp3_status fp3_layout_place(fp3_layout *layout, const fp3_config *config, uint32_t visit,
                            fp3_error *error);
/* Likewise of groups that see each other. Each has a core of its own, so each has all schedulers.
 */
void fp3_layout_place_apart(fp3_layout *layout, const fp3_config *config);
/* How many groups there may be. */
static inline uint32_t fp3_layout_room(const fp3_config *config) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    return schedulers > FP3_JOINED_MAX ? schedulers : FP3_JOINED_MAX;
}
/* Whether groups see each other. */
int fp3_layout_is_joined(const fp3_layout *layout);
/* Leaves {0}, which may be freed as well. */
void fp3_layout_free(fp3_layout *layout);

/* Takes `slot`, one for each object, for the order of a group whose objects see each other. The
 * last `away` slots are dealt out to the rows behind the others, and make no steps. FP3_E_SYSTEM:
 * out of memory; `slot` is still the caller's. */
fp3_status fp3_layout_arrange(fp3_members *group, uint32_t *slot, uint32_t away, fp3_error *error);

/* Whether every object is where it was, with a record of the same size. */
int fp3_layout_is_same(const fp3_layout *a, const fp3_layout *b);

const fp3_members *fp3_layout_group_of(const fp3_layout *layout, size_t object);
fp3_where fp3_layout_where(const fp3_layout *layout, const fp3_config *config, size_t object);
/* Words of a record that neighbours read and some phase stores: bit r is word r. */
uint64_t fp3_layout_published(const fp3_members *group);
/* The inverse. */
uint32_t fp3_layout_who(const fp3_layout *layout, const fp3_config *config, const fp3_where *where);
/* How many objects that make steps a lane of a scheduler has, and a scheduler. */
uint32_t fp3_layout_rows(const fp3_layout *layout, const fp3_config *config, uint32_t scheduler,
                         uint32_t lane);
uint32_t fp3_layout_objects(const fp3_layout *layout, const fp3_config *config, uint32_t scheduler);
/* With guests, of the only scheduler. */
uint32_t fp3_layout_rows_with_guests(const fp3_layout *layout, const fp3_config *config,
                                     uint32_t lane);

#endif
