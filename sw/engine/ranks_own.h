/* ranks_own.h - what an engine of many ranks keeps: fp3_engine.self. */
#ifndef FP3_ENGINE_RANKS_OWN_H
#define FP3_ENGINE_RANKS_OWN_H

#include "backend.h"
#include "ranks.h"

/* Objects of this rank that another rank needs, or guests that it brings: words side by side, register by register. */
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
    uint32_t *whose;               /* the rank of each object */
    uint32_t *share;               /* how many each rank has */
    uint32_t *mine;                /* numbers of the rank's own objects, ascending */
    uint32_t *guests, guest_count; /* numbers, by their ranks, then ascending */
    uint32_t first;                /* of the own engine's rows, that of the first own object */
    uint32_t room;                 /* rows of the own engine, own and guests */
    int sees_all;                  /* everybody stands at its number, and guests are all others */
    int *group;          /* of each group, the own engine's, or -1: none of its objects are here */
    uint32_t *constants; /* of each group, as many as registers */
    int is_placed;       /* ... by the lists that there are */
    fp3_traffic out, in;
    fp3_mpi_plan *plan;
    float *made
        [FP3_NEAR_DIMENSIONS]; /* where own objects were when guests were chosen; NULL: they do not depend on it */
} fp3_ranked;

/* The row of a guest in the own engine. */
static inline uint32_t fp3_ranks_row(const fp3_ranked *self, uint32_t guest) {
    return self->sees_all ? self->guests[guest] : self->share[self->ranks->rank] + guest;
}

/* A word of objects first .. first+count-1 of all ranks. */
fp3_status fp3_ranks_read(fp3_engine *engine, fp3_cells cells, void *words);

/* Guests that are among these cells. */
fp3_status fp3_ranks_write_guests(fp3_ranked *self, fp3_cells cells, const uint32_t *words);

/* Without neighbours, and before lists are known: blocks. Opens the own engine. */
fp3_status fp3_ranks_begin(fp3_engine *engine);
/* By the lists of neighbours: divides the objects anew, moves what they hold, and chooses guests. */
fp3_status fp3_ranks_place(fp3_engine *engine);
/* Chooses guests, of objects that move. `to` is what reads go by, or what takes its place. */
fp3_status fp3_ranks_choose_guests(fp3_engine *engine, fp3_ranked *to);
/* Brings guests up to date: an fp3_exchange_fn of the own engine, whose user is the engine. */
fp3_status fp3_ranks_exchange(void *user, fp3_engine *own);
/* All that place makes anew. */
void fp3_ranks_forget(fp3_ranked *self);

#endif
