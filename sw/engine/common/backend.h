/* SPDX-License-Identifier: Apache-2.0 */
/* backend.h - what an engine provides behind fp3/engine.h.
 *
 * The calls check every argument, so a backend sees valid ones only: objects, registers and
 * constants in range, a program that fits. To add one, write this table and list it in engine.c.
 * Nobody outside this folder sees an engine's struct: others ask by inside.h.
 */
#ifndef FP3_BACKEND_H
#define FP3_BACKEND_H

#include "inside.h"

/* Words of one kind, side by side. */
typedef struct {
    enum {
        FP3_CELLS_REGISTER, /* `number`, of objects first .. first+count-1: what they keep from run
                               to run */
        FP3_CELLS_STATUS,   /* what space `status` has for those objects; only if the configuration
                               has it */
        FP3_CELLS_CONSTANT, /* first .. first+count-1 of group `number` */
    } kind;
    uint32_t number;
    size_t first, count;
} fp3_cells;

typedef struct {
    fp3_engine_traits is;
    fp3_status (*open)(fp3_engine *engine);
    void (*close)(fp3_engine *engine); /* also after an open that failed */
    /* Before a load, of a group that has been placed: a program that the backend cannot execute is
     * refused, and nothing is changed. NULL: there is none. */
    fp3_status (*check)(fp3_engine *engine, const fp3_members *group);
    fp3_status (*load)(fp3_engine *engine);
    /* As many words as cells.count. */
    fp3_status (*read)(fp3_engine *engine, fp3_cells cells, void *words);
    fp3_status (*write)(fp3_engine *engine, fp3_cells cells, const void *words);
    /* See fp3_engine_column; *words is NULL. NULL: there is no such place. */
    fp3_status (*column)(fp3_engine *engine, uint32_t reg, const uint32_t **words);
    /* A word of each of these objects; NULL: by `read`. */
    void (*gather)(const fp3_engine *engine, uint32_t reg, const uint32_t *objects, size_t count,
                   uint32_t *words);
    /* A list of neighbours has been given, or (list is NULL) all are made anew; NULL: the backend
     * reads those of the layout. */
    fp3_status (*connect)(fp3_engine *engine, fp3_members *group, const fp3_list *list);
    /* Interleaved: the next run begins with all objects that fp3_engine_is_awake. */
    fp3_status (*list)(fp3_engine *engine);
    /* Fills the counters of the schedulers, which are 0, and schedulers of stats; adds to its
     * flags. */
    fp3_status (*run)(fp3_engine *engine, uint32_t steps, fp3_stats *stats);
    /* A copy of those that failed in the last run, by object; the caller frees *failed. NULL: the
     * engine does not know, and the run is made again. */
    fp3_status (*failures)(fp3_engine *engine, fp3_failed **failed, size_t *count);
    /* See fp3_engine_write_native; NULL: there is no native code. */
    fp3_status (*write_native)(fp3_engine *engine, const char *path);
    const char *(*how)(const fp3_engine *engine); /* see fp3_engine_how; NULL: there is one way */
    /* See fp3_engine_agree; NULL: there is one process. */
    fp3_status (*agree)(fp3_engine *engine, const void *words, size_t size);
    uint32_t at_once; /* a longer run is made in parts of as many steps; 0: in one */
    int begins_at_0;  /* a run makes steps of the first objects: fp3_engine_use has no other `first`
                       */
    /* The row of each object, by which lists of near objects go; NULL, or the function is: its
     * number. */
    const uint32_t *(*rows)(const fp3_engine *engine);
    int is_divided;   /* other engines have the objects, and know who failed */
    int is_uncounted; /* no scheduler counts: all counters stay 0 */
    int is_in_host;   /* the store is the host's memory: it has room for FP3_HOST_OBJECTS */
} fp3_backend;

typedef struct fp3_origin fp3_origin;

/* Steps since the load: an object makes those above born, up to gone. */
typedef struct {
    uint64_t born, gone;
} fp3_life;

typedef struct {
    fp3_life *list;   /* of each object; NULL: all live, always */
    uint8_t *removed; /* of each object, a set of FP3_REMOVED_*; NULL: no program can */
    int is_looked;    /* ... which is what objects hold */
    uint64_t change;  /* the next step after which others live; not above `made`: unknown */
    int is_any;       /* an object is alive until then */
} fp3_lives;

#define FP3_REMOVED_NOW 1    /* an event has removed it */
#define FP3_REMOVED_BEFORE 2 /* ... before the last run */

typedef struct {
    uint32_t *slept; /* of each object, what its sleep register held when it was last looked at */
    int is_known;    /* ... which is what it holds */
    int is_listed;   /* the next run begins with the right objects: */
    uint32_t *awake; /* of groups in which some may be left out; NULL: there is no such group */
    uint32_t awake_count;
} fp3_sleepers;

typedef struct {
    fp3_failed *list; /* by object; NULL: not asked for yet */
    size_t count;
} fp3_failures;

extern const fp3_backend fp3_backend_rtl, fp3_backend_isa, fp3_backend_fast, fp3_backend_board;

struct fp3_engine {
    const fp3_backend *backend;
    const fp3_config *config; /* own */
    fp3_config own;
    fp3_engine_def def;
    uint32_t objects;
    fp3_layout layout; /* one group without a program until a load */
    int is_touched;    /* some register, constant or status may be other than 0 */
    uint32_t only;     /* 1 + the phase of a step that a run makes; 0: all of them */
    fp3_bus_use bus;   /* since it was opened */
    uint32_t clock;    /* steps of earlier runs */
    uint64_t made;     /* ... since the load, as lifetimes count them */
    uint32_t began;    /* the clock when this run began */
    fp3_lives lives;
    fp3_sleepers sleepers;
    fp3_failures failures;
    int is_counted;    /* what groups have counted is up to date */
    double expected;   /* instructions of this part of the run, if no object sleeps */
    double told, part; /* shares of the run: the parts before this one, and this one */
    uint64_t (*counters)[FP3_COUNTER_COUNT]; /* of each scheduler */
    uint64_t (*sums)[FP3_COUNTER_COUNT];     /* ... over the parts of a run */
    fp3_origin *origin;                      /* of the last run */
    fp3_exchange exchange;                   /* .end == NULL: no guests */
    fp3_watched *watched; /* isa: of each object, filled by a run; NULL: not watched */
    void *self;           /* the backend's own */
};

/* Whether some objects may not live always. */
static inline int fp3_lives_vary(const fp3_engine *engine) {
    return engine->lives.list || engine->lives.removed;
}

/* Whether a run visits the object, now. */
int fp3_engine_is_awake(const fp3_engine *engine, size_t object);

/* What the next run's draws begin with (machine/storage.h). */
uint32_t fp3_engine_seed(const fp3_engine *engine);

/* What fp3_engine_open checks; the backend and the configuration that it finds. */
fp3_status fp3_engine_check(const fp3_engine_def *def, const fp3_backend **backend,
                            const fp3_config **config);
/* The rest of it. The engine has `self` then, also after a failure; *engine is NULL. */
fp3_status fp3_engine_open_on(const fp3_engine_def *def, const fp3_config *config,
                              const fp3_backend *backend, void *self, fp3_engine **engine);

/* Whether an object may have failed in the last run: then the run is made again. */
fp3_status fp3_engine_suspect(fp3_engine *engine, int *is_suspect);
/* Who failed in the last run: engine->failures. is_suspect: it is made again in any case, because
 * others need what it publishes. */
fp3_status fp3_engine_find_failures(fp3_engine *engine, int is_suspect);

/* fp3_engine_load_groups without its checks: of what another engine has loaded. */
fp3_status fp3_engine_load_again(fp3_engine *engine, const fp3_group *groups, size_t count);

/* Objects that see each other, or nobody, make one phase of a step of which `clock` have been made;
 * a program without phases has one. Fills stats as `run` does. */
fp3_status fp3_engine_make_phase(fp3_engine *engine, uint32_t phase, fp3_stats *stats);

/* When a phase begins: both parts; or one, and then the other. */
fp3_status fp3_engine_exchange(fp3_engine *engine);
fp3_status fp3_engine_exchange_begin(fp3_engine *engine);
fp3_status fp3_engine_exchange_end(fp3_engine *engine);

/* Behind a phase, before the one that begins at this word of the group's program: words that all
 * objects compare (machine/neighbours.h). Where a run makes one phase of a kind, kinds do that. */
fp3_status fp3_engine_compare(fp3_engine *engine, const fp3_members *group, uint32_t begin);

/* Of a word: a number whose low half it is, larger for a worse word. Floats and logarithms go by
 * their bits. */
uint64_t fp3_worst_key(uint32_t word);

/* Tells the caller how far the run is, by the instructions that objects have executed so far. */
void fp3_engine_tell(const fp3_engine *engine, uint64_t executed);

/* The two ends of a run that are not its own, in the same words from every engine; index counts in
 * the program of the group. */
fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t group, uint32_t index);
fp3_status fp3_engine_limit(fp3_engine *engine);

#endif
