/* SPDX-License-Identifier: Apache-2.0 */
/* kinds_inside.h - what the files of kinds.h share. */
#ifndef FP3_KINDS_INSIDE_H
#define FP3_KINDS_INSIDE_H

#include "engine/common/backend.h"

#define FP3_NO_OBJECT_ROW UINT32_MAX

/* A word of guests. */
typedef struct {
    uint32_t reg;   /* of the engine that has the guests */
    uint32_t from;  /* the group that they are of */
    uint32_t of;    /* its register, or shared constant */
    int is_shared;  /* ... a constant */
    int is_stored;  /* a step of that group may change it */
    int is_brought; /* guests have it, and it has not changed since */
} fp3_foreign_word;

/* A group: an engine for its objects that live, and guests behind them. */
typedef struct {
    fp3_engine *own; /* NULL: none of its objects lives */
    uint32_t living; /* how many do */
    uint32_t
        base[FP3_JOINED_MAX]; /* of each group: the row of its first guest, or FP3_NO_OBJECT_ROW
                               */
    fp3_foreign_word *words;
    uint32_t word_count;
    uint32_t rows, phases;
    struct fp3_kinds_teller {
        const fp3_engine *engine;
        const uint32_t *who; /* of each row, the object in all groups */
    } teller;
} fp3_kind_engine;

typedef struct fp3_kinds {
    fp3_backend backend;
    const fp3_backend *usual;
    fp3_status (*load)(fp3_engine *own, const fp3_image *image);
    fp3_kind_engine kinds[FP3_JOINED_MAX];
    uint32_t count;
    fp3_bus_use bus_before; /* use by engines that are gone */
    uint32_t *place; /* of each object: its row in the engine of its group; FP3_NO_OBJECT_ROW: it
                        does not live */
    uint32_t *who;   /* group by group: the objects that live, by their numbers in all groups */
    uint32_t *constants; /* of each group, as many as registers */
    uint32_t *held;      /* columns of all objects, a register each and then the status: what those
                            hold that do not live; NULL: all live */
    uint32_t *words;     /* of one register of any group */
} fp3_kinds;

static inline fp3_kinds *fp3_kinds_of(const fp3_engine *engine) { return engine->self; }

/* The living of a group, by their numbers in all groups. */
static inline const uint32_t *fp3_kinds_who(const fp3_engine *engine, uint32_t group) {
    return fp3_kinds_of(engine)->who + engine->layout.groups[group].first;
}

/* ---- kinds_lists.c ---- */

/* See fp3_backend.connect. */
fp3_status fp3_kinds_connect(fp3_engine *engine, fp3_members *group, const fp3_list *list);
/* What pairs remember, from the engines of the kinds to the lists that the caller's has. */
fp3_status fp3_kinds_take_memories(fp3_engine *engine);

/* ---- kinds_run.c ---- */

fp3_status fp3_kinds_read(fp3_engine *engine, fp3_cells cells, void *words);
fp3_status fp3_kinds_write(fp3_engine *engine, fp3_cells cells, const void *words);
fp3_status fp3_kinds_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats);

#endif
