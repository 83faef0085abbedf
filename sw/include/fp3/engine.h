/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/engine.h - runs programs over objects.
 *
 * Every engine gives the same bits for the same program. "rtl" is the hardware under Verilator,
 * cycle by cycle. "isa" is an instruction-set simulator in C. "fast" compiles the program to native
 * code and runs it over vectors of objects on all processors; it holds as many objects as fit in
 * memory, up to 2^25. "board" is hardware behind a serial port, real or simulated (docs/board.md).
 *
 *     float v;
 *     fp3_error error;
 *     fp3_engine_def def = fp3_engine_default();
 *     def.config = "single";
 *     def.error = &error;
 *     fp3_engine *engine = NULL;
 *     fp3_stats stats;
 *     if (fp3_engine_open(&def, &engine) || fp3_engine_load(engine, image) ||
 *         fp3_engine_set(engine, "v", 0.0f) || fp3_engine_run(engine, 10000, &stats) ||
 *         fp3_engine_get(engine, 0, "v", &v))
 *         fprintf(stderr, "%s\n", error.text);
 *     fp3_engine_close(&engine);
 *
 * A configuration that interleaves holds def.objects objects in a store and visits them in turn. A
 * visit loads the registers that the program keeps, advances the object by def.visit steps, and
 * stores them. Registers that the program neither loads nor stores keep what the host wrote.
 *
 * Objects that run different programs form groups (fp3_engine_load_groups). They need a
 * configuration with several schedulers.
 *
 * Threads: only one thread at a time may use an engine; engines in different threads do not affect
 * each other. Callbacks run in the thread that calls the engine. Only `tasks` uses other threads of
 * the caller.
 *
 * After `make install`, build a program that uses it with
 *     cc ship.c $(pkg-config --cflags --libs fp3)
 */
#ifndef FP3_ENGINE_H
#define FP3_ENGINE_H

#include <fp3/image.h>
#include <fp3/isa.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

typedef struct fp3_engine fp3_engine;

/* A result written to a register. Writes to the same register come in program order, writes to
 * different registers in the order of their cycles. The engine may make the call in the rounding
 * mode of its configuration: a callback that computes must set its own mode, and restore the old
 * one. */
typedef struct {
    uint64_t cycle;  /* rtl: clock cycles since open; isa: instructions of this run; if groups see
                        each other, cycles of the group's own core */
    uint32_t object; /* 0 .. fp3_engine_objects() - 1 */
    uint32_t reg;    /* object register */
    uint32_t bits;   /* FP32; for sleep, the number of the step */
    uint32_t flags;  /* NV DZ OF UF NX in bits 4 to 0 */
    uint32_t context, scheduler, lane; /* where it ran; isa: 0 */
} fp3_retirement;
typedef void fp3_retire_fn(void *user, const fp3_retirement *retirement);

/* What happened to an instruction that was issued. */
typedef enum {
    FP3_NO_OBJECT = 1, /* not executed: the context has no object, or a sleeping one */
    FP3_ASLEEP,        /* not executed: the object fell asleep earlier in this visit */
    FP3_EXECUTED
} fp3_outcome;

/* An instruction of "rtl", reported when it ends in a lane. In each lane instructions end in the
 * order of issue; only in a configuration that does not interleave may one overtake another. */
typedef struct {
    uint64_t issued, ended; /* cycles, as in fp3_retirement */
    uint32_t scheduler, lane, context;
    uint32_t pc; /* index in the program, including the loads in front of it */
    uint32_t word;
    fp3_outcome outcome;
    uint32_t object;      /* unless FP3_NO_OBJECT */
    int has_result;       /* it retired in cycle `ended` with bits and flags */
    uint32_t bits, flags; /* as in fp3_retirement */
} fp3_traced;
typedef void fp3_trace_fn(void *user, const fp3_traced *traced);

/* Called now and then during a run. share, from 0 to 1, is the executed part of the run's
 * instructions, counted as if no object slept. Must not call the engine. */
typedef void fp3_progress_fn(void *user, double share);

/* Work for the caller's threads: must call task(of, number) for each number below count, in any
 * thread and any order, and return when all these calls have returned. */
typedef void fp3_task_fn(void *of, uint32_t number);
typedef void fp3_tasks_fn(void *user, fp3_task_fn *task, void *of, uint32_t count);

/* The caller's memory. allocate returns memory that is aligned to 64 bytes, with any contents, or
 * NULL. size is a multiple of 64. */
typedef struct {
    void *(*allocate)(void *user, size_t size);
    void (*release)(void *user, void *memory, size_t size);
    void *user;
} fp3_allocator;

/* What to open. Always start from fp3_engine_default(). The caller owns the strings and whatever
 * error and each `user` point to; all of them must outlive the engine. */
typedef struct {
    /* Set by fp3_engine_default(): detects a missing default, and a program that was compiled with
     * headers of another version. */
    uint32_t cookie;
    fp3_error *error;     /* receives the message when a call of this engine fails; or NULL */
    const char *engine;   /* "rtl" (default), "isa", "fast" or "board" */
    const char *config;   /* a name from docs/configurations.md; the default is "single" */
    uint64_t cycle_limit; /* clock cycles (isa: instructions) per run; 0 (default): no limit; fast
                             and board take none */
    /* Number of objects. 0 (default): one for each context of each lane. A configuration that does
     * not interleave has one object. */
    uint32_t objects;
    /* Steps per visit. 0 (default): all steps of a run. Only for configurations that interleave. */
    uint32_t visit;
    uint32_t seed; /* with `storage`: stores round at random from this seed; 0: to nearest */
    /* isa and rtl: called for every retirement, or NULL. Must not call the engine. */
    fp3_retire_fn *retire;
    void *retire_user;
    fp3_trace_fn *trace; /* rtl: called for every instruction in every lane, or NULL; likewise */
    void *trace_user;
    /* rtl: seed for random pauses of 0 to 3 cycles in each channel of each transfer; 0: none. */
    uint64_t bus_waits;
    fp3_progress_fn *progress; /* or NULL; does not change the run */
    void *progress_user;
    /* fast only: how many threads take part in a run that is long enough; 0 (default): one for each
     * processor; at most 1024. The number does not change the results. */
    uint32_t threads;
    fp3_tasks_fn *tasks; /* fast only: the caller's threads; NULL (default): the engine's own */
    void *tasks_user;
    fp3_allocator allocator; /* fast only: memory for the objects; {0} (default): malloc */
    int is_interpreted;      /* fast only: 1: no native code, which pays off only in long runs */
    /* fast only: 1: never start a compiler; a program that is neither in the cache nor in `native`
     * is interpreted. */
    int is_without_compiler;
    /* fast only: a file made by fp3_engine_write_native, or NULL. The engine reads the file when a
     * program is loaded. The load fails unless the file has the program's code, made by this
     * version for a processor like this one. The code is trusted: anyone who can write the file can
     * execute code here. */
    const char *native;
    /* board only: the name of the serial port, and the baud rate; 0 (default): 115200.
     * fp3_engine_find finds the configuration of the board. */
    const char *port;
    uint32_t baud;
    /* rtl and board: file that receives every transfer on the bus, for sim/replay.v, or NULL. The
     * file appears when the first run has ended, and always holds whole runs. Its lines:
     * w ADDRESS DATA; r ADDRESS DATA; p ADDRESS MASK, read until the masked bits are 0;
     * h HIGH LOW, rtl only, after each run: FNV-1a hash of all retirements so far, over lane
     * (counted over all schedulers), row within the lane, register, bits, flags;
     * e LINES 0, written when the engine is closed: the number of lines before this line. A log
     * without this line was cut off. */
    const char *bus_log;
} fp3_engine_def;

/* What a run cost. For each scheduler, cycles = the sum of issued_* and stall_*. An instruction
 * counts once, however many lanes execute it. "isa" issues in every cycle and never stalls. All
 * counters are 0 on "fast", and on hardware whose configuration has no counters. */
typedef struct {
    uint64_t counter[FP3_COUNTER_COUNT]; /* sums over schedulers; cycles: the maximum */
    uint32_t schedulers;                 /* each has its own counters; isa: 1 */
    /* Steps made by all objects together; an object that fell asleep counts until then. 0 unless
     * the run came to its end. */
    uint64_t object_steps;
    uint32_t flags; /* exceptions raised by any instruction, as in fp3_retirement */
    double seconds; /* wall clock of the run */
} fp3_stats;

/* "cycles", "issued_add" and so on; counter < FP3_COUNTER_COUNT. */
const char *fp3_counter_name(fp3_counter counter);
/* Whether the counter's name begins with "stall_". */
int fp3_counter_is_stall(fp3_counter counter);

/* For fp3_engine_default() only. size is that of fp3_engine_def in the calling program. */
void fp3_engine_set_default(fp3_engine_def *def, size_t size);
/* "rtl", "single", no cycle limit, one object for each context, one visit per run, no callbacks. */
static inline fp3_engine_def fp3_engine_default(void) {
    fp3_engine_def def;
    fp3_engine_set_default(&def, sizeof def);
    return def;
}

/* The caller closes *engine, which is NULL on failure. Registers and constants are 0 at first.
 * FP3_E_ARGUMENT: no such engine or configuration, too many objects, or a definition from another
 * version of the library. FP3_E_SYSTEM: the simulated hardware of "rtl" was not found, or does not
 * match this library; the message says where the library looked. The environment variable
 * FP3_RTL_DIR names another directory. */
fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine);
/* Closes *engine and sets it to NULL. *engine may be NULL already. */
void fp3_engine_close(fp3_engine **engine);

/* Finds the configuration of the board at a serial port; baud as in fp3_engine_def. FP3_E_ARGUMENT:
 * no such rate. FP3_E_SYSTEM: no such port, no answer, or a configuration that this library does
 * not have. */
fp3_status fp3_engine_find(const char *port, uint32_t baud, const char **config, fp3_error *error);

/* The number of objects, at least 1. */
size_t fp3_engine_objects(const fp3_engine *engine);

/* Use of the hardware's bus since the engine was opened: transfers is the number of words written
 * and read. cycles is the time from a transfer's first handshake to its response, summed over all
 * transfers; the counters of runs do not include these cycles (board: 0). With board, requests is
 * the number of requests sent over the line, repeats the number of requests sent again because an
 * answer was lost or late, and bytes the number of bytes on the line in both directions. All
 * members are 0 for engines without a bus. */
typedef struct {
    uint64_t transfers, cycles;
    uint64_t requests, repeats, bytes;
} fp3_bus_use;
fp3_bus_use fp3_engine_bus(const fp3_engine *engine);
/* The largest number of objects that an engine can hold; 0: no such engine or configuration. */
size_t fp3_engine_room(const char *engine, const char *config);
/* How "fast" executes the loaded program: "native x86-64-v4", or "interpreter x86-64-v3" and, in
 * brackets, why there is no native code. "" for other engines. The text belongs to the engine, and
 * is valid until the next load. */
const char *fp3_engine_how(const fp3_engine *engine);

/* Writes the native code of the loaded program to a file, for `native` of an engine on a machine
 * without a compiler. The code is for this kind of processor, or for a lesser kind that FP3_FAST
 * names. FP3_E_ARGUMENT: the engine is not "fast", or does not have exactly one group with a
 * program. FP3_E_SYSTEM: the compiler failed, or the file cannot be written. */
fp3_status fp3_engine_write_native(fp3_engine *engine, const char *path);

/* Loads the code and the constants that have values; everything else keeps its contents. The image
 * is copied. The first step of the next run has the number 1. FP3_E_PROGRAM: the configuration has
 * too few registers, constants or words, lacks an operation, or its store has no room for that many
 * objects of this program; the engine is unchanged. If a word is not an instruction, a later run
 * ends there. Only "fast" refuses such a word here; it also refuses an lds after anything but
 * loads. */
fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image);

/* A word that a program reads of objects of another group (docs/relations.md#kinds). */
typedef struct {
    const char *word; /* a param of this program, which its loops read of such a neighbour */
    size_t group;     /* the other group */
    const char *of;   /* a state, param or shared constant of that group's program */
} fp3_foreign;

/* Objects that share a program. */
typedef struct {
    const fp3_image *image;
    size_t objects; /* at least 1 */
    /* The words that it reads of other groups; NULL: none. If any group has some, all groups make
     * each step together, phase by phase. */
    const fp3_foreign *foreign;
    size_t foreign_count;
} fp3_group;

/* Loads one program per group. Objects are numbered group by group; the groups together must have
 * the engine's number of objects. If a group reads words of others, all groups (at most 8) make
 * each step together, phase by phase, and cycles of hardware are the sum over the groups. Otherwise
 * each group gets at least one scheduler, and the remaining schedulers are distributed so that all
 * groups end as early as possible if no object sleeps. The objects of a group are dealt one by one
 * to the lanes of its schedulers. An object that moves to another place keeps its registers and its
 * status. If its new record is shorter, the registers beyond it are lost; if it is longer, the new
 * registers are 0. Constants belong to a group; those of a new group are 0. FP3_E_ARGUMENT: a group
 * has no objects, or the groups have more or fewer objects than the engine. FP3_E_PROGRAM: as for
 * fp3_engine_load, or there are more groups than schedulers. If groups see each other, also: more
 * than 8 groups, a word that its group does not have, or a def with a trace, a bus log, native
 * code, a cycle limit, a board or ranks. */
fp3_status fp3_engine_load_groups(fp3_engine *engine, const fp3_group *groups, size_t count);
/* The number of groups: 1 before the first load. */
size_t fp3_engine_groups(const fp3_engine *engine);

/* Write or read register reg of objects first .. first+count-1. values has count floats. If words
 * are floats (docs/logarithmic.md), their bits are kept, even those of a NaN. FP3_E_ARGUMENT: no
 * such object or register, no room for the register with this number of objects, or a value that
 * the format cannot represent; nothing is written. */
fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values);
fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values);

/* Read-only pointer to the column of register reg: one word of each object, without a copy. Valid
 * until the engine is closed or another program is loaded; *values changes with each run. If
 * objects see each other, a run may move the words to another column: the pointer is then valid
 * only until the next run or change of a list, and the caller asks for it again. NULL: the engine
 * is not "fast", words are not floats, or objects stand in another order or in several engines
 * (docs/batch.md#values). FP3_E_ARGUMENT: no such register. */
fp3_status fp3_engine_column(fp3_engine *engine, uint32_t reg, const float **values);

/* Shared constants first .. first+count-1. Written in all groups, read from group 0. */
fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values);
fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values);
/* The same for one group. FP3_E_ARGUMENT: also if there is no such group. */
fp3_status fp3_engine_write_shared_of(fp3_engine *engine, size_t group, uint32_t first,
                                      size_t count, const float *values);
fp3_status fp3_engine_read_shared_of(fp3_engine *engine, size_t group, uint32_t first, size_t count,
                                     float *values);

/* Access by a name of the loaded image. set writes a state or param of every object, or a shared
 * constant, in every group that has the name. get reads any register or constant of the object's
 * group.
 * FP3_E_ARGUMENT: no such name, no such object, or nothing is loaded; *value is unchanged. */
fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value);
fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value);

/* Every object that is awake makes this number of steps, from 0 to 2^32 - 1. Each visit executes
 * the first part once, the step part once per step, and the last part once. 0 steps execute
 * nothing. An object that falls asleep still executes the last part of that visit, and then
 * nothing.
 * FP3_E_ARGUMENT: too many steps; or an object's `steps` would exceed FP3_STEPS_LIMIT, or the
 * largest number that its words can count; or there is a cycle limit, and an object is born or gone
 * during the run. Nothing was executed.
 * FP3_E_PROGRAM: an illegal instruction. FP3_E_LIMIT: the cycle limit was reached; the run ends
 * within a step, a few cycles late. After either, registers can be read, stats (may be NULL) is
 * filled, and the next run numbers its steps as if this run had not taken place. If the
 * configuration interleaves, objects hold what their last complete visit stored (if they see each
 * other: docs/neighbours.md); otherwise all instructions before the end were executed.
 * Except for the first run after a load, a run begins by reading back the states, and the registers
 * that its programs load, because fp3_engine_failure may need them. It does not read registers that
 * were written since. */
fp3_status fp3_engine_run(fp3_engine *engine, uint64_t steps, fp3_stats *stats);

/* The counters of one scheduler in the last run. FP3_E_ARGUMENT: the run had no such scheduler,
 * or the hardware has no counters. */
fp3_status fp3_engine_scheduler_counters(fp3_engine *engine, uint32_t scheduler,
                                         uint64_t counter[FP3_COUNTER_COUNT]);

/* The object-steps of one group in the last run; 0 if there is no such group. */
uint64_t fp3_engine_group_steps(const fp3_engine *engine, size_t group);

typedef struct {
    size_t group, objects; /* the group whose program it runs; how many of its objects it has */
} fp3_scheduler_share;
/* The group and objects of a scheduler since the last load; for "isa", as on hardware.
 * If groups see each other, each has all schedulers, and the share is that of group 0.
 * FP3_E_ARGUMENT: no such scheduler. */
fp3_status fp3_engine_scheduler_share(fp3_engine *engine, uint32_t scheduler,
                                      fp3_scheduler_share *share);

#define FP3_REMOVED UINT32_MAX /* removed by the host */

typedef struct {
    uint32_t flags; /* raised since open or the last clear; as in fp3_retirement */
    /* The step in which the first invalid or overflow was raised (its low 27 bits); 0: none. */
    uint32_t failed;
    uint32_t slept; /* the step in which the object fell asleep; 0: awake; or FP3_REMOVED */
} fp3_object_status;

/* The status of objects first .. first+count-1. flags and failed are 0 if the configuration does
 * not keep a status; slept is 0 if the program has no sleep. */
fp3_status fp3_engine_status(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *status);
/* Sets flags and failed to 0. FP3_E_ARGUMENT: also if the configuration does not keep a status. */
fp3_status fp3_engine_clear_status(fp3_engine *engine, size_t first, size_t count);

/* How objects failed in a run. An object fails if an instruction raises invalid or overflow, or if
 * a .state is not finite at the end. Underflow and inexact are not failures. An instruction whose
 * result is not used in its own step counts for the next step, and not at all if the visit ends
 * before that. An instruction of the first part counts for the step that follows. */
typedef struct {
    size_t failed; /* how many objects failed; if 0, all other members are 0 */
    size_t object; /* of the objects that failed in the earliest step, the lowest number */
    uint32_t step; /* counted from the load, as `sleep` does */
    int is_before; /* 1: a state was not finite before the first step of the run */
    /* The flags of the first instruction that raised invalid or overflow, as in fp3_retirement. If
     * flags is 0, no instruction did: then `state` is the register of a state that is not finite
     * after that step, and `value` is that state. Else both are 0. */
    uint32_t flags;
    uint32_t state;
    float value;
    uint32_t partner; /* 1 + the number of a near object at the same place, the cause; or 0 */
} fp3_failure;

/* How objects first .. first+count-1 failed in the last run, whatever earlier runs raised. Reads
 * their states. If an object failed, the engine "isa" repeats the run once, on every configuration.
 * FP3_E_ARGUMENT: the run did not come to its end, or something was written or loaded since, or
 * fp3_engine_live was called. FP3_E_MISMATCH: "isa" does not fail as the run did. A configuration
 * without `flags` detects failures by the states alone. */
fp3_status fp3_engine_failure(fp3_engine *engine, size_t first, size_t count, fp3_failure *failure);

/* "object 3 in step 12: overflow", "object 0 before its first step: state v is NaN". */
#define FP3_FAILURE_TEXT_SIZE 160
void fp3_engine_failure_text(const fp3_engine *engine, const fp3_failure *failure,
                             char text[FP3_FAILURE_TEXT_SIZE]);

/* From the next run on, the objects make steps again (wake), or make none and cost no cycles
 * (remove). FP3_E_PROGRAM: the program of an object has no sleep; nothing is changed. */
fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count);
fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count);

/* Objects first .. first+count-1 live from step `born` to step `gone`, counted from the load: they
 * make the steps born + 1 .. gone, and cost no cycles in other steps. Before, they hold what the
 * host wrote; afterwards, their last values. A load makes all objects live from 0 to FP3_FOREVER.
 * The program needs no sleep. A run is split where an object is born or gone. Each part executes
 * the first and the last part of the program, which must only prepare and complete values, and the
 * host looks at each object. FP3_E_ARGUMENT: gone is not above born, no such object, or nothing is
 * loaded. FP3_E_PROGRAM: the configuration interleaves but has no `sleep`, so it visits all its
 * objects, unless they see each other. After an error nothing is changed. Other objects do not see
 * an object that does not live. A link exists, and keeps its fields, while both of its ends live; a
 * near pair forgets its fields when one of the two does not live. An object whose state
 * FP3_NAME_REMOVED (fp3/image.h) is not 0 never lives; if a program has this state, each step is a
 * part of its own. */
#define FP3_FOREVER UINT64_MAX
fp3_status fp3_engine_live(fp3_engine *engine, size_t first, size_t count, uint64_t born,
                           uint64_t gone);

typedef enum { FP3_UNBORN, FP3_ALIVE, FP3_GONE } fp3_life_stage;
/* The stage of an object after the runs since the load: FP3_ALIVE if it makes the next step,
 * FP3_GONE also if there is no such object. */
fp3_life_stage fp3_engine_life(const fp3_engine *engine, size_t object);

/* ---- neighbours (docs/relations.md) ----
 *
 * A program with neighbours goes through lists of other objects. Its step has phases: in a phase an
 * object reads its neighbours' values as they were when the phase began. All objects of a group end
 * a phase before any object begins the next phase.
 */

/* One list of each object of a group. */
typedef struct {
    /* objects + 1 numbers, ascending from 0: object i, counted in its group, has the entries
     * begin[i] .. begin[i+1]-1. NULL: every object has all other objects, in the order of their
     * numbers. */
    const uint32_t *begin;
    const uint32_t *other; /* of each entry: the neighbour, counted in the group */
    const float *fields;   /* of each entry, entry by entry; NULL: the list has none */
    /* 0: neighbours are of the same group. Else 1 + the number of their group; `other` then counts
     * in that group, and the program reads that group's words (fp3_foreign). */
    size_t kind;
} fp3_neighbours;

/* Sets the list whose register has this name, and copies it. The list stays until the next load; a
 * run needs all lists of its programs. On "rtl" lists are in the object store, behind the records:
 * a run ends with FP3_E_PROGRAM if they do not fit. FP3_E_ARGUMENT: no such group or list; an entry
 * is not another object of the group; fields are missing; or nothing is loaded. After an error the
 * list is unchanged. Fields that the program writes (`stl`) begin with what is given here. */
fp3_status fp3_engine_set_neighbours(fp3_engine *engine, size_t group, const char *name,
                                     const fp3_neighbours *neighbours);

/* Links of a model's relation: each joins two objects of a group, and both get an entry, in the
 * order of the links. fp3_batch_link (fp3/batch.h) and fp3_params_link (fp3/program.h) take
 * them. */
typedef struct {
    size_t count;
    const uint32_t *a, *b; /* of each link: its objects, counted in their group */
    /* Columns of fields, one number for each link, by the fields' names. A program gets them as it
     * gets params: rounded to FP32, or in double-single to a sum of two words. A field without a
     * column has the model's default. An image has no names and no defaults; give the columns in
     * the order in which the program reads the fields. */
    const char *const *names;
    const double *const *fields;
    size_t field_count;
} fp3_links;

/* Near objects: all others whose distance is below the reach of the pair when a phase begins. */
typedef struct {
    const char *position[3]; /* states, the components of the position */
    uint32_t dimensions;     /* the number of components */
    double reach;            /* 2^-50 to 2^63; 0, or 2^-50 to 2^61, if there are radii */
    /* Lists reach farther by this distance, so they stay valid until an object has moved by half of
     * the skin. 0: lists are made in each phase. At most 2^63. The skin changes no bit. */
    double skin;
    size_t kind;           /* as in fp3_neighbours */
    const char *theirs[3]; /* if they are of another group: this program's params that have their
                              position */
    /* Params that are added to the reach of a pair, one of the object and one of the neighbour;
     * within one group, `radius` of both. NULL: nothing is added. A run ends with FP3_E_ARGUMENT if
     * an object has a value that is neither 0 nor from 2^-50 to 2^61. */
    const char *radius, *their_radius;
    /* With radii: if above 0, the skin is this share of the reach of two objects with the median
     * radius, and `skin` is ignored. */
    double share;
    /* The second word of each component of the position, if it is a sum of two words, as in
     * double-single. NULL: it is one word. */
    const char *low[3], *their_low[3];
} fp3_near;

/* Lets the engine make a list, and renew it before a pair could be missed. Lists may contain
 * objects beyond reach; the program must skip them itself. An object whose position is not finite
 * is near no other object. Fields that the program writes (`stl`) are 0 for a pair that enters the
 * list, and stay as long as the pair is in the list, even if the reach is set again. A program must
 * write 0 for a pair beyond reach. FP3_E_ARGUMENT: as above; or the program reads fields that it
 * does not write. */
fp3_status fp3_engine_set_near(fp3_engine *engine, size_t group, const char *name,
                               const fp3_near *near);

/* ---- runs of adaptive steps (fp3/compile.h) ---- */

#define FP3_ADAPTIVE_ATTEMPTS 1000000u /* the default limit */

typedef enum {
    FP3_ADAPTIVE_ENDED,   /* t is until, and all states are finite */
    FP3_ADAPTIVE_STOPPED, /* at an event, likewise; step is -0 */
    FP3_ADAPTIVE_STUCK,   /* the tolerance needs a step too short even for the two words of t */
    FP3_ADAPTIVE_LIMITED, /* no attempts were left before the end */
    FP3_ADAPTIVE_LOST     /* ended or stopped, and a state is not finite */
} fp3_adaptive_end;
/* Whether all is well. */
static inline int fp3_adaptive_is_over(fp3_adaptive_end end) {
    return end == FP3_ADAPTIVE_ENDED || end == FP3_ADAPTIVE_STOPPED;
}

/* Whether a program has adaptive steps, that is, states t and h_next, and an `until`. */
int fp3_adaptive_is(const fp3_image *image);

/* One object after a run. */
typedef struct {
    fp3_adaptive_end end;
    float t, step, until; /* step: the next one to try */
    uint32_t accepted, rejected;
    float smallest, largest;
    char state[FP3_NAME_SIZE]; /* the first state that is not finite, or "" */
    float t_low;               /* the time is t + t_low */
} fp3_adaptive_object;

/* Looks at one object. FP3_E_ARGUMENT: no such object, or its program has no adaptive steps. Counts
 * that the program does not keep are 0. */
fp3_status fp3_adaptive_look(fp3_engine *engine, size_t object, fp3_adaptive_object *found);

/* "object 3 at t = 0.5 of 17.0625, after 12 steps and 3 attempts: ..." */
#define FP3_ADAPTIVE_TEXT_SIZE 240
void fp3_adaptive_text(size_t object, const fp3_adaptive_object *found,
                       char text[FP3_ADAPTIVE_TEXT_SIZE]);

/* Runs the loaded programs, with fixed or adaptive steps. With fixed steps each object makes `most`
 * steps. With adaptive steps each object goes on until it has ended or made `most` attempts; next
 * to groups with fixed steps the limit is at least FP3_ADAPTIVE_ATTEMPTS. stats (may be NULL) gets
 * the sum of all runs: one run, or, in a configuration that does not interleave, several short
 * runs. (Its object cannot sleep, so short runs keep the attempts after the object's end, which
 * change nothing, few.) Errors as for fp3_engine_run. FP3_E_PROGRAM: also if
 * the configuration interleaves, and a program with adaptive steps has no sleep. */
fp3_status fp3_adaptive_run(fp3_engine *engine, uint64_t most, fp3_stats *stats);

typedef struct {
    uint32_t least, median, most;
} fp3_adaptive_counts;

/* A summary of several objects. */
typedef struct {
    fp3_adaptive_counts accepted, rejected;
    /* Of the accepted steps; 0: no steps. A step that the end cut short counts with its length
     * before the cut. */
    float smallest, largest;
    size_t stopped;          /* how many stopped at events, and did not fail */
    size_t failed, first;    /* how many did not end, and the first such object */
    fp3_adaptive_object why; /* details of the first such object */
} fp3_adaptive_report;

/* Summarises objects first .. first+count-1. FP3_E_ARGUMENT as for fp3_adaptive_look. FP3_E_SYSTEM:
 * out of memory. */
fp3_status fp3_adaptive_report_make(fp3_engine *engine, size_t first, size_t count,
                                    fp3_adaptive_report *report);

FP3_API_END

#endif
