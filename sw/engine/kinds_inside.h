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
    uint32_t *last; /* what it was when objects were last asked whether they move, or NULL */
} fp3_foreign_word;

/* A group: an engine for its objects that live, and guests behind them. */
typedef struct {
    fp3_engine *own; /* NULL: none of its objects lives */
    uint32_t living; /* how many do */
    uint32_t awake;  /* ... and make steps: the first rows */
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

/* What became of an object. */
enum { FP3_STAGE_NONE, FP3_STAGE_AWAKE, FP3_STAGE_ASLEEP };

/* Objects that fall asleep and wake (kinds_rest.c). All arrays but `near` are of all objects. */
typedef struct {
    int is_any;              /* the program of some group lets them */
    uint8_t *told, *touched; /* what the caller wrote since the last run: `at_rest`; another word */
    uint64_t clock; /* of the engine when that run ended. Another one: the words that were written
                       are a start, where nobody is touched or gone */
    uint8_t *flags;
    uint8_t *moved; /* those of groups that never rest whose words have changed in this step */
    uint32_t *root; /* a tree for each island: of each object, the next towards its root */
    struct fp3_rest_near {
        fp3_near_rule rule;
        uint32_t *begin, *other;
        uint32_t *words; /* where all are: columns of the own objects, and then of the kind's */
    } near[FP3_JOINED_MAX][FP3_LISTS_MAX];
} fp3_rest;

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
    uint8_t *stage;      /* of each object */
    uint32_t fresh; /* in so many steps, guests still get words that no step changes: each half of a
                       store has its own */
    fp3_rest rest;
} fp3_kinds;

static inline fp3_kinds *fp3_kinds_of(const fp3_engine *engine) { return engine->self; }

/* The living of a group, by their numbers in all groups. */
static inline const uint32_t *fp3_kinds_who(const fp3_engine *engine, uint32_t group) {
    return fp3_kinds_of(engine)->who + engine->layout.groups[group].first;
}

/* ---- kinds_form.c ---- */

/* Which row each object has in the engine of its group, and each guest, by `stage`. */
void fp3_kinds_place(fp3_kinds *self, const fp3_layout *layout);
/* The engine of a group of that layout, with its program; none if nobody of it lives. */
fp3_status fp3_kinds_open_one(fp3_engine *engine, fp3_kinds *self, const fp3_layout *layout,
                              uint32_t number);
/* Each group gets another engine, for objects at these stages. After a failure it has the old ones.
 */
fp3_status fp3_kinds_form(fp3_engine *engine, const uint8_t *stage);

/* ---- kinds_rest.c ---- */

fp3_status fp3_rest_open(const fp3_engine *engine, const fp3_layout *layout, fp3_kinds *self);
void fp3_rest_close(fp3_rest *rest);
/* The caller has written these words, or given a list (NULL: cells are) of a group. */
void fp3_rest_note(fp3_engine *engine, fp3_cells cells);
void fp3_rest_note_list(fp3_engine *engine, uint32_t group, const fp3_list *list);
/* Before a run, or a part of one: who sleeps of those that live now. stage: FP3_STAGE_NONE or
 * _AWAKE of each object; those that sleep become FP3_STAGE_ASLEEP. */
fp3_status fp3_rest_settle(fp3_engine *engine, uint8_t *stage);
/* Whether words of objects that never rest have changed since this was called before. */
fp3_status fp3_rest_compare(fp3_engine *engine);
/* After the step of this number: stage is a copy of that of the engine, changed where others sleep
 * from now on; *is_new: there are such. */
fp3_status fp3_rest_look(fp3_engine *engine, uint32_t number, uint8_t *stage, int *is_new);

/* ---- kinds_lists.c ---- */

/* See fp3_backend.connect. */
fp3_status fp3_kinds_connect(fp3_engine *engine, fp3_members *group, const fp3_list *list);
/* What pairs remember, from the engines of the kinds to the lists that the caller's has. */
fp3_status fp3_kinds_take_memories(fp3_engine *engine);

/* ---- kinds_cells.c ---- */

fp3_status fp3_kinds_read(fp3_engine *engine, fp3_cells cells, void *words);
/* Not for what the caller writes. */
fp3_status fp3_kinds_put(fp3_engine *engine, fp3_cells cells, const void *words);
void fp3_kinds_count_bus(fp3_engine *engine);

/* ---- kinds_worst.c ---- */

/* When a round begins: what phases of the one before have stored, of the same name. */
fp3_status fp3_kinds_compare(fp3_engine *engine, uint32_t phase);
/* Whether all groups that compare something store the same names in the same phases; *group: the
 * one that a failure is about. */
fp3_status fp3_kinds_check_worst(const fp3_engine *engine, const fp3_layout *layout,
                                 uint32_t *group);

/* ---- kinds_run.c ---- */

fp3_status fp3_kinds_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats);

#endif
