/* backend.h - what an engine provides behind fp3/engine.h.
 *
 * The calls check every argument, so a backend sees valid ones only: objects, registers and constants
 * in range, a program that fits. To add one, write this table and list it in engine.c.
 */
#ifndef FP3_BACKEND_H
#define FP3_BACKEND_H

#include "layout.h"
#include "machine/config.h"
#include "machine/watch.h"

#include <fp3/engine.h>

typedef struct {
    const char *name;
    fp3_status (*open)(fp3_engine *engine);
    void (*close)(fp3_engine *engine); /* also after an open that failed */
    /* Before a load, of a group that has been placed: a program that the backend cannot execute is refused, and nothing is changed. NULL:
     * there is none. */
    fp3_status (*check)(fp3_engine *engine, const fp3_members *group);
    fp3_status (*load)(fp3_engine *engine);
    /* The registers that an object keeps from run to run, and constants. */
    fp3_status (*write)(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits);
    fp3_status (*read)(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits);
    /* One register of objects first .. first+count-1; NULL: one after the other by read. */
    fp3_status (*read_column)(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                              float *values);
    fp3_status (*write_shared)(fp3_engine *engine, uint32_t group, uint32_t index, uint32_t bits);
    fp3_status (*read_shared)(fp3_engine *engine, uint32_t group, uint32_t index, uint32_t *bits);
    /* The word that space `status` has for an object; only if the configuration has it. */
    fp3_status (*write_status)(fp3_engine *engine, size_t object, uint32_t word);
    fp3_status (*read_status)(fp3_engine *engine, size_t object, uint32_t *word);
    /* Interleaved: the next run begins with all objects that fp3_engine_is_awake. */
    fp3_status (*list)(fp3_engine *engine);
    /* Fills the counters of the schedulers, which are 0, and schedulers of stats; adds to its flags. */
    fp3_status (*run)(fp3_engine *engine, uint32_t steps, fp3_stats *stats);
    /* A copy of those that failed in the last run, by object; the caller frees *failed. NULL: the engine does
     * not know, and the run is made again. */
    fp3_status (*failures)(fp3_engine *engine, fp3_failed **failed, size_t *count);
    /* See fp3_engine_write_native; NULL: there is no native code. */
    fp3_status (*write_native)(fp3_engine *engine, const char *path);
    const char *(*how)(const fp3_engine *engine); /* see fp3_engine_how; NULL: there is one way */
    int is_in_host; /* the store is the host's memory: it has room for FP3_HOST_OBJECTS */
} fp3_backend;

typedef struct fp3_origin fp3_origin;

/* Steps since the load: an object makes those above born, up to gone. */
typedef struct {
    uint64_t born, gone;
} fp3_life;

extern const fp3_backend fp3_backend_rtl, fp3_backend_isa, fp3_backend_fast, fp3_backend_board;

/* By the name of its engine, which may be NULL; NULL with an error if there is none. */
const fp3_backend *fp3_backend_find(const char *name, fp3_error *error);

struct fp3_engine {
    const fp3_backend *backend;
    const fp3_config *config; /* that of def, or own */
    fp3_config own;
    fp3_engine_def def;
    uint32_t objects;
    fp3_layout layout; /* one group without a program until a load */
    int is_touched;    /* some register, constant or status may be other than 0 */
    fp3_bus_use bus;   /* since it was opened */
    uint32_t clock;    /* steps of earlier runs */
    uint64_t made;     /* ... since the load, as lifetimes count them */
    uint32_t began;    /* the clock when this run began */
    fp3_life *lives;   /* of each object; NULL: all live, always */
    uint64_t change;   /* the next step after which others live; not above made: unknown */
    int is_any_alive;  /* until then */
    uint64_t (
        *sums)[FP3_COUNTER_COUNT]; /* of each scheduler, over the parts of a run; NULL with lives */
    double expected;               /* instructions of this part of the run, if nobody sleeps */
    double told, part;             /* shares of the run: the parts before this one, and this one */
    /* Of each object, what its sleep register held when it was last looked at. */
    uint32_t *slept;
    int is_slept_known; /* slept is up to date */
    int is_counted;     /* so is what groups have counted */
    int is_listed;      /* the next run begins with the right objects */
    uint32_t *awake; /* ... of groups in which some may be left out; NULL: there is no such group */
    uint32_t awake_count;
    uint64_t (*counters)[FP3_COUNTER_COUNT]; /* of each scheduler */
    fp3_origin *origin;                      /* of the last run */
    fp3_failed *failures; /* of the last run, by object; NULL: nobody has asked */
    size_t failure_count;
    fp3_watched *watched; /* isa: of each object, filled by a run; NULL: nobody watches */
    void *self;           /* the backend's own */
};

/* fp3_engine_open with a configuration that need not be a named one, instead of def->config; it is copied.
 * Of "isa" and "fast": "rtl" is hardware that has been built. */
fp3_status fp3_engine_open_as(const fp3_engine_def *def, const fp3_config *config,
                              fp3_engine **engine);

/* Whether a run visits the object, now. */
int fp3_engine_is_awake(const fp3_engine *engine, size_t object);

/* The states of a group for which its records have room, as a set of registers; the sleep register is
 * none. */
uint64_t fp3_engine_states_of(const fp3_members *group);

/* fp3_engine_load without its checks: for tests of what the hardware does with words that are none
 * of its own. */
fp3_status fp3_engine_load_unchecked(fp3_engine *engine, const fp3_image *image);
/* fp3_engine_load_groups without its checks: of what another engine has loaded. */
fp3_status fp3_engine_load_again(fp3_engine *engine, const fp3_group *groups, size_t count);

/* Tells the caller how far the run is, by the instructions that objects have executed so far. */
void fp3_engine_tell(const fp3_engine *engine, uint64_t executed);

/* The two ends of a run that are not its own, in the same words from every engine; index counts in
 * the program of the group. */
fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t group, uint32_t index);
fp3_status fp3_engine_limit(fp3_engine *engine);

#endif
