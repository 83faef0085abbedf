/* fp3/engine.h - run a program over objects, on whichever machine.
 *
 * Every engine gives the same bits for the same program: "rtl" is the hardware
 * description under Verilator, cycle by cycle; "isa" executes the instruction set in C.
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
 * A configuration that interleaves keeps its objects in a store, as many as def.objects says, and
 * visits them in turn: what a program keeps of an object is loaded, the object advanced by so many
 * steps as def.visit says, and stored. Registers that the program neither loads nor stores hold
 * what the host wrote.
 *
 * Objects that run different programs are groups, each with a program of its own (fp3_engine_load_groups), in a
 * configuration of several schedulers.
 *
 * After make all: compile with -Isw/include -Isw/gen, and link with
 *     g++ ... -Wl,--start-group build/libfp3*.a $(find build/verilated -name model.a) \
 *         -Wl,--end-group -lgsl -lgslcblas -lz -lpthread -lm
 */
#ifndef FP3_ENGINE_H
#define FP3_ENGINE_H

#include <fp3/image.h>
#include <fp3/status.h>
#include <registers.h>
#include <stddef.h>
#include <stdint.h>

typedef struct fp3_engine fp3_engine;

/* A result written to a register. The writes of one register come in program order, those of
 * different registers in the order of their cycles. */
typedef struct {
    uint64_t cycle;  /* rtl: clock cycles since open; isa: instructions of this run */
    uint32_t object; /* 0 .. fp3_engine_objects() - 1 */
    uint32_t reg;    /* object register */
    uint32_t bits;   /* FP32; of a sleep the number of the step */
    uint32_t flags;  /* NV DZ OF UF NX in bits 4 to 0 */
    uint32_t context, scheduler, lane; /* where; isa: 0 */
} fp3_retirement;
typedef void fp3_retire_fn(void *user, const fp3_retirement *retirement);

/* What became of an instruction that issued. */
typedef enum {
    FP3_NO_OBJECT = 1, /* not executed: the context has no object, or its object slept before */
    FP3_ASLEEP,        /* not executed: the object fell asleep in this visit */
    FP3_EXECUTED
} fp3_outcome;

/* An instruction of "rtl", told when it ends in a lane. Each lane ends what its scheduler issues in
 * the order of issue; a configuration that does not interleave may overtake. */
typedef struct {
    uint64_t issued, ended; /* cycles, as in fp3_retirement */
    uint32_t scheduler, lane, context;
    uint32_t pc; /* of the program with the loads in front */
    uint32_t word;
    fp3_outcome outcome;
    uint32_t object;      /* unless FP3_NO_OBJECT */
    int has_result;       /* it retired in cycle `ended`, with ... */
    uint32_t bits, flags; /* ... these, as in fp3_retirement */
} fp3_traced;
typedef void fp3_trace_fn(void *user, const fp3_traced *traced);

/* What to open. Always start from fp3_engine_default(). The strings and what error, retire_user and
 * trace_user point to stay the caller's and must outlive the engine. */
typedef struct {
    const char *engine;   /* "rtl" (default) or "isa" */
    const char *config;   /* a name from docs/configurations.md; the default is "single" */
    uint64_t cycle_limit; /* clock cycles (isa: instructions) per run; 0 (default): none */
    /* How many objects; 0 (default): as many as the configuration has contexts in all lanes. One
     * that does not interleave has one object. */
    uint32_t objects;
    /* Steps per visit; 0 (default): all steps of a run. Of no effect where nothing interleaves. */
    uint32_t visit;
    fp3_retire_fn *retire; /* called for every retirement, or NULL; must not call the engine */
    void *retire_user;
    fp3_trace_fn *trace; /* called for every instruction in every lane, or NULL; likewise */
    void *trace_user;
    /* rtl: file for every transfer on the host port, as sim/replay.v reads it, or NULL:
     * w ADDRESS DATA; r ADDRESS DATA; p ADDRESS MASK, read until the masked bits are 0;
     * h HIGH LOW, after a run the FNV-1a hash of all retirements so far: of lane (of all schedulers),
     * row within the lane, register, bits, flags. */
    const char *bus_log;
    fp3_error *error; /* where this engine's calls say why they failed; NULL: nowhere */
    uint32_t cookie;  /* set by fp3_engine_default(); catches a forgotten default */
} fp3_engine_def;

/* The hardware's counters, FP3_COUNTER_CYCLES and so on: docs/registers.md. */
typedef enum {
#define X(NAME, name, address) FP3_COUNTER_##NAME,
    FP3_COUNTERS(X)
#undef X
        FP3_COUNTER_COUNT
} fp3_counter;

/* What a run cost. Of each scheduler cycles = issued_* + stall_*; "isa" issues in every cycle and never
 * stalls. With several lanes an instruction counts once. */
typedef struct {
    uint64_t counter[FP3_COUNTER_COUNT]; /* of all schedulers; cycles are those of the longest */
    uint32_t schedulers;                 /* each with counters of its own; isa: 1 */
    /* Steps that objects made: those of an object that fell asleep count up to then. 0 unless the
     * run came to its end. */
    uint64_t object_steps;
    uint32_t flags; /* exceptions raised by any instruction, as in fp3_retirement */
    double seconds; /* wall clock of the run */
} fp3_stats;

/* "cycles", "issued_add" and so on; counter < FP3_COUNTER_COUNT. */
const char *fp3_counter_name(fp3_counter counter);
/* Whether its name begins with "stall_". */
int fp3_counter_is_stall(fp3_counter counter);

/* "rtl", "single", no limit, all contexts full, one visit, nothing observed. */
fp3_engine_def fp3_engine_default(void);

/* The caller closes *engine, which is NULL on failure. Registers and constants are 0 at first.
 * FP3_E_ARGUMENT: no such engine or configuration, or not so many objects. */
fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine);
/* Sets *engine to NULL; that it was NULL before does no harm. */
void fp3_engine_close(fp3_engine **engine);

/* How many objects it holds, at least 1. */
size_t fp3_engine_objects(const fp3_engine *engine);

/* Loads the code and the constants that have values; all else keeps its contents. The image is
 * copied. The next run's first step has the number 1. FP3_E_PROGRAM, with the engine unchanged: the
 * configuration has too few registers, constants or words, lacks an operation, or has no room in
 * its store for that many objects of this program. A word that is no instruction is let through:
 * the run ends there. */
fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image);

/* Objects that share a program. */
typedef struct {
    const fp3_image *image;
    size_t objects; /* at least 1 */
} fp3_group;

/* Likewise with several programs: objects are numbered group by group, and there are as many as the
 * engine has. A scheduler runs one program. Each group has at least one, and is given more so that
 * all end as early as possible if nobody sleeps; its objects go round the lanes of its schedulers.
 * An object keeps its registers and its status, wherever it is placed: those beyond its new record
 * are lost, those beyond its old one are 0. Constants are kept by group, a new group's begin with 0.
 * FP3_E_ARGUMENT: the objects are not those of the engine, or a group has none. FP3_E_PROGRAM: also
 * more groups than schedulers, or no room for them in the schedulers' stores. */
fp3_status fp3_engine_load_groups(fp3_engine *engine, const fp3_group *groups, size_t count);
/* How many groups there are: 1 before the first load. */
size_t fp3_engine_groups(const fp3_engine *engine);

/* Register reg of objects first .. first+count-1; values has count floats, whose bits are kept,
 * those of a NaN too. FP3_E_ARGUMENT: no such object or register, or it is beyond what the store
 * has room for with so many objects; nothing is read or written. */
fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values);
fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values);

/* Shared constants first .. first+count-1, likewise: written in all groups, read from group 0. */
fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values);
fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values);
/* Of one group. FP3_E_ARGUMENT: also no such group. */
fp3_status fp3_engine_write_shared_of(fp3_engine *engine, size_t group, uint32_t first,
                                      size_t count, const float *values);
fp3_status fp3_engine_read_shared_of(fp3_engine *engine, size_t group, uint32_t first, size_t count,
                                     float *values);

/* By a name of the loaded image. set: a state or param of every object, or a .shared, in every group
 * that has the name. get: any register or constant of the object's group; where there is one group,
 * object does not matter for a constant. FP3_E_ARGUMENT: no such name, no
 * such object, or nothing is loaded; *value is unchanged. */
fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value);
fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value);

/* Every object that is awake makes so many steps (2^32 - 1 at most): in each visit the first part
 * once, the step part for each step, the last part once; with 0 steps nothing at all. An object
 * that falls asleep executes the last part of that visit and nothing after it.
 * FP3_E_PROGRAM at an illegal instruction, FP3_E_LIMIT at the cycle limit (somewhere within a step,
 * a few cycles late): after both, registers can be read and stats (may be NULL) is filled, and steps
 * are counted on from where this run began. Where nothing interleaves, what is before that place was
 * executed; else objects hold what the last visit that they completed has stored. */
fp3_status fp3_engine_run(fp3_engine *engine, uint64_t steps, fp3_stats *stats);

/* The counters of one scheduler in the last run. FP3_E_ARGUMENT: it had no such scheduler. */
fp3_status fp3_engine_scheduler_counters(fp3_engine *engine, uint32_t scheduler,
                                         uint64_t counter[FP3_COUNTER_COUNT]);

/* Of the object-steps of the last run those of one group; 0: there is no such group. */
uint64_t fp3_engine_group_steps(const fp3_engine *engine, size_t group);

typedef struct {
    size_t group, objects; /* whose program it runs; how many of the group's objects it has */
} fp3_scheduler_share;
/* What a scheduler of the configuration is for, since the last load. Of "isa", what it would be for. */
fp3_status fp3_engine_scheduler_share(fp3_engine *engine, uint32_t scheduler,
                                      fp3_scheduler_share *place);

#define FP3_REMOVED UINT32_MAX /* asleep because the host said so */

typedef struct {
    uint32_t flags;  /* raised since open or the last clear, as in fp3_retirement */
    uint32_t failed; /* the step of the first invalid or overflow, its low 27 bits; 0: none */
    uint32_t slept;  /* the step in which it fell asleep; 0: awake; FP3_REMOVED */
} fp3_object_status;

/* Of objects first .. first+count-1. Without `status` in the configuration flags and failed are 0,
 * without a sleep in the program slept is. */
fp3_status fp3_engine_status(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *status);
/* Sets flags and failed to 0. FP3_E_ARGUMENT: also without `status` in the configuration. */
fp3_status fp3_engine_clear_status(fp3_engine *engine, size_t first, size_t count);

/* From the next run on the objects make steps again, or none and cost no cycles. FP3_E_PROGRAM: no
 * sleep in the program of one of them, and nothing is done. */
fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count);
fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count);

#endif
