/* SPDX-License-Identifier: Apache-2.0 */
/* inside.h - what an engine of many ranks keeps: fp3_engine.self. */
#ifndef FP3_CLUSTER_INSIDE_H
#define FP3_CLUSTER_INSIDE_H

#include "engine/common/backend.h"
#include "processes.h"

/* What is held: registers, and the status. */
#define FP3_HELD (FP3_BANK_OBJECT_COUNT + 1)

/* Of objects that move, steps until somebody looks whether they are to be divided anew. */
#define FP3_RANKS_AT_ONCE 64

/* Objects of this rank that another rank needs, or guests that it brings: words side by side,
 * register by register. */
typedef struct {
    uint32_t *rows;  /* of the rank's own engine, rank by rank */
    uint32_t *count; /* of each rank */
    uint32_t *words; /* what is sent, or comes */
} fp3_traffic;

typedef struct {
    fp3_backend backend; /* with the name of the ranks' own engines */
    const fp3_ranks *ranks;
    fp3_engine_def def;            /* of the own engine */
    fp3_engine *own;               /* NULL: the rank has no objects, or nothing is loaded */
    uint32_t *held[FP3_HELD];      /* without it, words of the own objects; NULL: zeros */
    uint32_t *whose;               /* the rank of each object */
    uint32_t *share;               /* how many each rank has */
    uint32_t *mine;                /* numbers of the rank's own objects, ascending */
    uint32_t *guests, guest_count; /* numbers, by their ranks, then ascending */
    uint32_t placed;               /* how many guests there were when the objects were divided */
    uint32_t first;                /* of the own engine's rows, that of the first own object */
    uint32_t room;                 /* rows of the own engine, own and guests */
    int sees_all;                  /* everybody stands at its number, and guests are all others */
    int *group;          /* of each group, the own engine's, or -1: none of its objects are here */
    uint32_t *constants; /* of each group, as many as registers */
    int is_placed;       /* whether objects are divided by the present lists */
    uint64_t given;      /* a hash of all that was loaded, connected and written */
    int is_open;         /* an exchange has begun, and not ended: MPI may write to in.words */
    int is_stale;        /* a run made again has chosen guests for its own steps */
    fp3_rank_use use;    /* without the bus of the open engine, which use.c adds */
    fp3_traffic out, in;
    fp3_mpi_plan *plan;
    /* Where pairs remember: the numbers of all rows, as lists of the own engine have them; ... as
     * they had them when the run began; and as those have them of `standing`, the engine that makes
     * the run again. */
    uint32_t *names, *began, *again;
    const fp3_engine *standing;
    int is_new;                          /* it has made no exchange yet */
    uint32_t *made[FP3_NEAR_DIMENSIONS]; /* where own objects were when guests were chosen; NULL:
                                         they do not depend on it */
} fp3_ranked;

static inline unsigned fp3_ranks_here(const fp3_ranked *self) { return self->ranks->rank; }

/* The row of a guest in the own engine. */
static inline uint32_t fp3_ranks_row(const fp3_ranked *self, uint32_t guest) {
    return self->sees_all ? self->guests[guest] : self->share[fp3_ranks_here(self)] + guest;
}

/* Whether the objects of a group see all others. */
static inline int fp3_ranks_is_all(const fp3_members *group) {
    int is = 0;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        is |= group->lists.lists[i].is_all;
    return is;
}

static inline int fp3_ranks_is_any_set(const uint32_t *words, size_t count) {
    uint32_t any = 0;
    for (size_t i = 0; i < count; i++)
        any |= words[i];
    return any != 0;
}

/* ---- words.c: backend.read, all ranks together, and backend.write ---- */

fp3_status fp3_ranks_read(fp3_engine *engine, fp3_cells cells, void *words);
fp3_status fp3_ranks_write(fp3_engine *engine, fp3_cells cells, const void *words);
/* Guests that are among these cells. */
fp3_status fp3_ranks_write_guests(fp3_ranked *self, fp3_cells cells, const uint32_t *words);

/* ---- held.c: words of own objects while there is no engine, and those of the engine ---- */

fp3_status fp3_ranks_no_memory(fp3_engine *engine);
/* Adds words to self->given: every rank was given the same, or they run scenes that differ. */
void fp3_ranks_note(fp3_ranked *self, const void *words, size_t count);
/* Closes the own engine, if there is one; its words are held from then on. FP3_E_SYSTEM: they could
 * not be read. */
fp3_status fp3_ranks_hold(fp3_engine *engine);
void fp3_ranks_forget_held(fp3_ranked *self);
/* By the own engine's rows, or where they are held. */
fp3_status fp3_ranks_read_own(fp3_ranked *self, fp3_cells here, uint32_t *words);
fp3_status fp3_ranks_write_own(fp3_ranked *self, fp3_cells here, const uint32_t *words);
/* What the engine used its bus for stays counted. */
void fp3_ranks_close_own(fp3_ranked *self);

/* ---- divide.c: self->whose ---- */

/* Blocks. Of objects that see all others, whole vectors where there are any: FP3_USE_STEP. */
void fp3_ranks_divide_group(const fp3_ranked *self, const fp3_members *group);
/* By Scotch: few links are divided. */
fp3_status fp3_ranks_divide_by_links(fp3_engine *engine, fp3_ranked *to);
/* By recursive bisection of where the objects are. */
fp3_status fp3_ranks_divide_by_place(fp3_engine *engine, fp3_ranked *to);

/* ---- guests.c ---- */

/* `to` is what reads go by, or what takes its place. */
fp3_status fp3_ranks_choose_guests(fp3_engine *engine, fp3_ranked *to);
/* The numbers of all rows, those without an object behind all. */
void fp3_ranks_number_rows(const fp3_ranked *to, uint32_t *numbers);
void fp3_ranks_forget_traffic(fp3_ranked *self);

/* ---- exchange.c ---- */

/* An fp3_exchange of the own engine, whose user is the engine. */
fp3_status fp3_ranks_send(void *user, fp3_engine *own);
fp3_status fp3_ranks_receive(void *user, fp3_engine *own);
uint64_t fp3_ranks_worst(void *user, uint64_t key);

/* ---- memory.c: what pairs remember ---- */

/* To list k of to->own, of near objects; rows: of each number, UINT32_MAX: it has none. */
fp3_status fp3_ranks_give_near(fp3_engine *engine, const fp3_ranked *to, uint32_t k,
                               const uint32_t *rows);
/* Around a choice of guests: what the own engine's pairs of near objects remember, by rows; and to
 * their new rows. rows: how many there were. The caller frees all of `saved`, {0} at first. */
fp3_status fp3_ranks_keep(const fp3_ranked *self, fp3_remembered saved[FP3_LISTS_MAX]);
fp3_status fp3_ranks_rename(const fp3_ranked *self, uint32_t rows, const uint32_t *before,
                            const uint32_t *now, const fp3_remembered saved[FP3_LISTS_MAX]);
/* Who is linked is always a guest. row: room for a word of each object. */
void fp3_ranks_rename_links(const fp3_ranked *self, const uint32_t *before, const uint32_t *now,
                            uint32_t *row);
/* Before a run: self->began. */
fp3_status fp3_ranks_note_names(fp3_engine *engine);
/* After a run, to the lists of all objects, on all ranks. */
fp3_status fp3_ranks_take_memory(fp3_engine *engine);

/* ---- place.c ---- */

/* Without neighbours, and before lists are known: blocks. Without neighbours it opens the own
 * engine. */
fp3_status fp3_ranks_begin(fp3_engine *engine);
/* By the lists of neighbours: divides the objects anew, moves what they hold, chooses guests and
 * opens the own engine. */
fp3_status fp3_ranks_place(fp3_engine *engine);
/* Whether objects have moved so far that they are to be divided anew: then nothing is placed. */
fp3_status fp3_ranks_wander(fp3_engine *engine);
/* Tells the own engine who lives when. */
fp3_status fp3_ranks_tell_lives(fp3_engine *engine);
/* All that place makes anew. */
void fp3_ranks_forget(fp3_ranked *self);

#endif
