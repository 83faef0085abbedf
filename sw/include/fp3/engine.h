/* fp3/engine.h - run a program over objects, on whichever machine.
 *
 * Every kind of engine gives the same bits for the same program: "rtl" is the hardware
 * description under Verilator, cycle by cycle; "model" executes the instruction set in C.
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
    uint64_t cycle;  /* rtl: clock cycles since open; model: instructions of this run */
    uint32_t object; /* 0 .. fp3_engine_objects() - 1 */
    uint32_t reg;    /* object register */
    uint32_t bits;   /* FP32 */
    uint32_t flags;  /* NV DZ OF UF NX in bits 4 to 0 */
} fp3_retirement;
typedef void fp3_retire_fn(void *user, const fp3_retirement *retirement);

/* What to open. Always start from fp3_engine_default(). The strings and what error and retire_user
 * point to stay the caller's and must outlive the engine. */
typedef struct {
    const char *kind;      /* "rtl" (default) or "model" */
    const char *config;    /* a name from docs/configurations.md; the default is "single" */
    uint64_t cycle_limit;  /* clock cycles (model: instructions) per run; 0 (default): none */
    fp3_retire_fn *retire; /* called for every retirement, or NULL; must not call the engine */
    void *retire_user;
    /* rtl: file for every transfer on the host port, as sim/replay.v reads it, or NULL:
     * w ADDRESS DATA; r ADDRESS DATA; p ADDRESS MASK, read until the masked bits are 0;
     * h HIGH LOW, after a run the FNV-1a hash of all retirements so far. */
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

/* What a run cost. cycles = issued_* + stall_*; "model" issues in every cycle and never stalls. */
typedef struct {
    uint64_t counter[FP3_COUNTER_COUNT];
    uint64_t object_steps; /* 0 unless the run came to its end */
    uint32_t flags;        /* exceptions raised by any instruction, as in fp3_retirement */
    double seconds;        /* wall clock of the run */
} fp3_stats;

/* "cycles", "issued_add" and so on; counter < FP3_COUNTER_COUNT. */
const char *fp3_counter_name(fp3_counter counter);
/* Whether its name begins with "stall_". */
int fp3_counter_is_stall(fp3_counter counter);

/* "rtl", "single", no limit, nothing observed. */
fp3_engine_def fp3_engine_default(void);

/* The caller closes *engine, which is NULL on failure. Registers and constants are 0 at first. */
fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine);
/* Sets *engine to NULL; that it was NULL before does no harm. */
void fp3_engine_close(fp3_engine **engine);

/* How many objects it holds, at least 1. */
size_t fp3_engine_objects(const fp3_engine *engine);

/* Loads the code and the constants that have values; all else keeps its contents. The image is
 * copied. FP3_E_PROGRAM, with the engine unchanged: the configuration has too few registers,
 * constants or words, or lacks an operation. A word that is no instruction is let through: the run
 * ends there. */
fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image);

/* Register reg of objects first .. first+count-1; values has count floats, whose bits are kept,
 * those of a NaN too. FP3_E_ARGUMENT: no such object or register; nothing is read or written. */
fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values);
fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values);

/* Shared constants first .. first+count-1, likewise. */
fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values);
fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values);

/* By a name of the loaded image. set: a state or param of every object, or a .shared. get: any
 * register or constant; object does not matter for a shared one. FP3_E_ARGUMENT: no such name, no
 * such object, or nothing is loaded; *value is unchanged. */
fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value);
fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value);

/* The first part once, the step part steps times (2^32 - 1 at most), the last part once; with 0
 * steps nothing at all. FP3_E_PROGRAM at an illegal instruction (what is before it was executed),
 * FP3_E_LIMIT at the cycle limit (somewhere within a step, a few cycles late): after both,
 * registers can be read and stats (may be NULL) is filled. */
fp3_status fp3_engine_run(fp3_engine *engine, uint64_t steps, fp3_stats *stats);

#endif
