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
    fp3_engine_def def;                    /* of the own engine */
    fp3_engine *own;                       /* NULL: the rank has no objects, or nothing is loaded */
    uint32_t *held[FP3_BANK_OBJECT_COUNT]; /* without it, words of the own objects; NULL: zeros */
    uint32_t *whose;                       /* the rank of each object */
    uint32_t *share;                       /* how many each rank has */
    uint32_t *mine;                        /* numbers of the rank's own objects, ascending */
    uint32_t *guests, guest_count;         /* numbers, by their ranks, then ascending */
    uint32_t first;      /* of the own engine's rows, that of the first own object */
    uint32_t room;       /* rows of the own engine, own and guests */
    int sees_all;        /* everybody stands at its number, and guests are all others */
    int *group;          /* of each group, the own engine's, or -1: none of its objects are here */
    uint32_t *constants; /* of each group, as many as registers */
    int is_placed;       /* ... by the lists that there are */
    fp3_rank_use use;    /* but the bus of the engine that is open */
    fp3_traffic out, in;
    fp3_mpi_plan *plan;
    float *made
        [FP3_NEAR_DIMENSIONS]; /* where own objects were when guests were chosen; NULL: they do not depend on it */
} fp3_ranked;

/* The row of a guest in the own engine. */
static inline uint32_t fp3_ranks_row(const fp3_ranked *self, uint32_t guest) {
    return self->sees_all ? self->guests[guest] : self->share[self->ranks->rank] + guest;
}

static inline int fp3_ranks_is_any_set(const uint32_t *words, size_t count) {
    uint32_t any = 0;
    for (size_t i = 0; i < count; i++)
        any |= words[i];
    return any != 0;
}

/* A word of objects first .. first+count-1 of all ranks. */
fp3_status fp3_ranks_read(fp3_engine *engine, fp3_cells cells, void *words);

/* Guests that are among these cells. */
fp3_status fp3_ranks_write_guests(fp3_ranked *self, fp3_cells cells, const uint32_t *words);

/* Without neighbours, and before lists are known: blocks. Without neighbours it opens the own engine. */
fp3_status fp3_ranks_begin(fp3_engine *engine);
/* By the lists of neighbours: divides the objects anew, moves what they hold, chooses guests and opens the own engine. */
fp3_status fp3_ranks_place(fp3_engine *engine);
/* Chooses guests, of objects that move. `to` is what reads go by, or what takes its place. */
fp3_status fp3_ranks_choose_guests(fp3_engine *engine, fp3_ranked *to);
/* Brings guests up to date: an fp3_exchange_fn of the own engine, whose user is the engine. */
fp3_status fp3_ranks_exchange(void *user, fp3_engine *own);
/* Closes the own engine, if there is one; its words are held from then on. FP3_E_SYSTEM: they could not be read. */
fp3_status fp3_ranks_hold(fp3_engine *engine);
void fp3_ranks_forget_held(fp3_ranked *self);
/* Registers of own objects, by the own engine's rows, or where they are held. */
fp3_status fp3_ranks_read_own(fp3_ranked *self, fp3_cells here, uint32_t *words);
fp3_status fp3_ranks_write_own(fp3_ranked *self, fp3_cells here, const uint32_t *words);
/* What the engine used its bus for stays counted. */
void fp3_ranks_close_own(fp3_ranked *self);
void fp3_ranks_add_bus(fp3_bus_use *sum, const fp3_bus_use *more);
/* After a run, by all ranks together: its cycles, and the bus of all. */
void fp3_ranks_count_run(fp3_engine *engine);
/* All that place makes anew. */
void fp3_ranks_forget(fp3_ranked *self);

#endif
