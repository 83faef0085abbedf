/* model.c - the "model" engine: the instruction set, one instruction after the other.
 *
 * The host's FPU computes values and flags: it is IEEE 754 binary32 to nearest-even with tininess
 * detected after rounding (x86, and the reason why other hosts have to be checked first). What is
 * left to do is the one quiet NaN 7FC00000.
 */
#include "kind.h"

#include <fenv.h>
#include <float.h>
#include <isa.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if FLT_EVAL_METHOD != 0 || !(defined __x86_64__ || defined __i386__)
#error "needs binary32 arithmetic that is rounded once, with tininess detected after rounding"
#endif

typedef struct {
    float *registers; /* contexts * registers of the configuration, object by object */
    float *shared;
} model;

static fp3_status model_open(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    if (!config->subnormal || !config->nearest)
        return fp3_fail(
            engine->def.error, FP3_E_ARGUMENT,
            "configuration '%s' flushes subnormals or truncates: the model does neither",
            config->name);
    model *self = engine->self = calloc(1, sizeof *self);
    if (self) {
        self->registers =
            calloc((size_t)config->contexts * config->registers, sizeof *self->registers);
        self->shared = calloc(config->registers, sizeof *self->shared);
    }
    if (!self || !self->registers || !self->shared)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    return FP3_OK;
}

static void model_close(fp3_engine *engine) {
    model *self = engine->self;
    if (self) {
        free(self->registers);
        free(self->shared);
    }
    free(self);
}

static fp3_status model_load(fp3_engine *engine, const fp3_image *image) {
    (void)engine, (void)image; /* the engine's copy is what runs */
    return FP3_OK;
}

static float *cell(fp3_engine *engine, size_t object, uint32_t reg) {
    return &((model *)engine->self)->registers[object * engine->config->registers + reg];
}

static fp3_status model_write(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    memcpy(cell(engine, object, reg), &bits, sizeof bits);
    return FP3_OK;
}

static fp3_status model_read(fp3_engine *engine, size_t object, uint32_t reg, uint32_t *bits) {
    memcpy(bits, cell(engine, object, reg), sizeof *bits);
    return FP3_OK;
}

static fp3_status model_write_shared(fp3_engine *engine, uint32_t index, uint32_t bits) {
    memcpy(&((model *)engine->self)->shared[index], &bits, sizeof bits);
    return FP3_OK;
}

static fp3_status model_read_shared(fp3_engine *engine, uint32_t index, uint32_t *bits) {
    memcpy(bits, &((model *)engine->self)->shared[index], sizeof *bits);
    return FP3_OK;
}

/* What the hardware's decoder refuses, too. */
static int is_legal(const fp3_config *config, uint32_t word, fp3_instruction *in) {
    const uint32_t in_bank = FP3_BANK_SHARED_BASE - 1;
    return !fp3_word_decode(word, in, NULL) &&
           (config->chain || (in->op != FP3_OP_MADD && in->op != FP3_OP_MSUB)) &&
           in->d < config->registers && (in->a & in_bank) < config->registers &&
           (in->b & in_bank) < config->registers && (in->c & in_bank) < config->registers;
}

static float operand(const model *self, const float *object, uint32_t number) {
    return number >= FP3_BANK_SHARED_BASE ? self->shared[number - FP3_BANK_SHARED_BASE]
                                          : object[number];
}

/* volatile: the compiler may move no operation across the reading of its flags. */
static float execute(const fp3_instruction *in, volatile float a, volatile float b,
                     volatile float c) {
    volatile float d;
    switch (in->op) {
    case FP3_OP_ADD:
        d = a + b;
        break;
    case FP3_OP_SUB:
        d = a - b;
        break;
    case FP3_OP_MUL:
        d = a * b;
        break;
    case FP3_OP_MADD:
        d = a * b;
        d = c + d;
        break;
    default: /* FP3_OP_MSUB; there are no others, see is_legal */
        d = a * b;
        d = c - d;
        break;
    }
    return d;
}

static uint32_t raised(void) {
    const int raised = fetestexcept(FE_ALL_EXCEPT);
    return (raised & FE_INVALID ? 1u << FP3_FLAGS_INVALID_LO : 0) |
           (raised & FE_DIVBYZERO ? 1u << FP3_FLAGS_DIVIDE_BY_ZERO_LO : 0) |
           (raised & FE_OVERFLOW ? 1u << FP3_FLAGS_OVERFLOW_LO : 0) |
           (raised & FE_UNDERFLOW ? 1u << FP3_FLAGS_UNDERFLOW_LO : 0) |
           (raised & FE_INEXACT ? 1u << FP3_FLAGS_INEXACT_LO : 0);
}

/* One instruction for all objects. */
static void sweep(fp3_engine *engine, const fp3_instruction *in, fp3_stats *stats) {
    static const fp3_counter issued[] = {
        [FP3_OP_ADD] = FP3_COUNTER_ISSUED_ADD,    [FP3_OP_SUB] = FP3_COUNTER_ISSUED_ADD,
        [FP3_OP_MUL] = FP3_COUNTER_ISSUED_MUL,    [FP3_OP_MADD] = FP3_COUNTER_ISSUED_CHAIN,
        [FP3_OP_MSUB] = FP3_COUNTER_ISSUED_CHAIN,
    };
    const model *self = engine->self;
    for (uint32_t i = 0; i < engine->config->contexts; i++) {
        float *object = cell(engine, i, 0);
        feclearexcept(FE_ALL_EXCEPT);
        const float value = execute(in, operand(self, object, in->a), operand(self, object, in->b),
                                    operand(self, object, in->c));
        fp3_retirement done = {stats->counter[FP3_COUNTER_CYCLES]++, i, in->d, 0x7fc00000u,
                               raised()};
        if (!isnan(value))
            memcpy(&done.bits, &value, sizeof value);
        memcpy(&object[in->d], &done.bits, sizeof done.bits);
        stats->flags |= done.flags;
        stats->counter[issued[in->op]]++;
        stats->counter[FP3_COUNTER_RETIRED]++;
        if (engine->def.retire)
            engine->def.retire(engine->def.retire_user, &done);
    }
}

static fp3_status model_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    const fp3_image *image = engine->image;
    const uint64_t limit = engine->def.cycle_limit;
    fp3_status status = FP3_OK;
    fenv_t callers;
    fegetenv(&callers);
    fesetenv(FE_DFL_ENV); /* whatever rounding and flushing the caller has chosen */
    for (uint32_t pc = steps ? 0 : image->code_count; pc < image->code_count && !status;) {
        fp3_instruction in;
        if (!is_legal(engine->config, image->code[pc], &in)) {
            status = fp3_engine_illegal(engine, pc, image->code[pc]);
        } else if (limit && stats->counter[FP3_COUNTER_CYCLES] >= limit) {
            status = fp3_engine_limit(engine);
        } else {
            sweep(engine, &in, stats);
            pc++;
            if (pc == image->last && --steps)
                pc = image->step;
        }
    }
    fesetenv(&callers);
    return status;
}

const fp3_engine_kind fp3_kind_model = {
    .name = "model",
    .open = model_open,
    .close = model_close,
    .load = model_load,
    .write = model_write,
    .read = model_read,
    .write_shared = model_write_shared,
    .read_shared = model_read_shared,
    .run = model_run,
};
