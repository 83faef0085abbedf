/* SPDX-License-Identifier: Apache-2.0 */
/* sweep.c - see sweep.h. Compiled with FP3_SWEEP, the name of its table, FP3_NEAREST, FP3_SUBNORMAL
 * and, where it is 1, FP3_FINITE or FP3_OF_WORDS. */
#include "sweep.h"

#ifndef FP3_SWEEP
#define FP3_SWEEP fp3_sweep_plain
#define FP3_NEAREST 1
#define FP3_SUBNORMAL 1
#endif
#ifndef FP3_FINITE
#define FP3_FINITE 0
#endif
#ifndef FP3_OF_WORDS
#define FP3_OF_WORDS 0
#endif
#ifndef FP3_SWEEP_NAME
#define FP3_SWEEP_NAME FP3_SWEEP_LEAST
#endif
#include <base/fpu.h>
#define FP3_FLAGS (!FP3_FPU_IS_SOFT) /* what the processor does not raise, raise() does */
#include "exceptions.h"
#include "halves.h"
#include "short.h"
#include "words.h"

#include <fp3/isa.h>
#include <machine/watch.h>

#define GRAVE ((int)FP3_FLAGS_GRAVE)
#define VECTORS (FP3_BLOCK / FP3_LANES)

typedef struct {
    const fp3_v *row;
    unsigned stride; /* 0: a constant */
} source;

typedef struct {
    const fp3_fast_place *place;
    const fp3_fast_word *now;
    fp3_config config; /* its words' arithmetic, and its records */
    uint32_t number;   /* of the step */
    int is_last;       /* part: those asleep take part */
    int is_tiny;       /* products as in tiny.h */
    fp3_i subnormal, under;
    int is_watched; /* every value is looked at: a NaN is the machine's */
    source from[3];
    fp3_v constant[3]; /* what from points to, if it is a constant */
    fp3_v *to;         /* where the result goes: d, or scratch if something is left to do */
    fp3_v scratch[VECTORS];
    fp3_v product[VECTORS];
} machine;

static fp3_v *row_of(const fp3_fast_place *place, uint32_t reg) {
    return (fp3_v *)(void *)(place->rows + (size_t)reg * FP3_BLOCK);
}

static void find_sources(machine *m) {
    const fp3_instruction *in = &m->now->in;
    const uint32_t operand[3] = {in->a, in->b, in->c};
    for (int i = 0; i < 3; i++) {
        if (operand[i] < FP3_BANK_SHARED_BASE) {
            m->from[i] = (source){row_of(m->place, operand[i]), 1};
            continue;
        }
        if (operand[i] == FP3_FAST_GIVEN) {
            m->from[i] = (source){row_of(m->place, FP3_BANK_OBJECT_COUNT), 1};
            continue;
        }
        m->constant[i] = (fp3_v)fp3_all(m->place->constants[operand[i] - FP3_BANK_SHARED_BASE]);
        m->from[i] = (source){&m->constant[i], 0};
    }
}

#define EACH for (unsigned j = 0; j < m->place->vectors; j++)
#define A (m->from[0].row[j * m->from[0].stride])
#define B (m->from[1].row[j * m->from[1].stride])
#define C (m->from[2].row[j * m->from[2].stride])

/* What products of a row met. */
typedef struct {
    fp3_i subnormal, under;
} met;

FP3_OPERATION fp3_v multiply(met *met, fp3_v a, fp3_v b) {
    const fp3_light_product product = fp3_tiny_value(a, b);
    met->subnormal |= product.is_subnormal;
    met->under |= product.under;
    return product.value;
}

FP3_OPERATION fp3_v fuse(met *met, fp3_v a, fp3_v b, fp3_v c) {
    const fp3_product_of sum = fp3_tiny_fused(a, b, c);
    met->subnormal |= sum.is_subnormal;
    met->under |= sum.under;
    return sum.value;
}

/* Operands, results and what products meet are locals, since a result might be a field of the
 * machine, for all that the compiler knows. */
#define OPERANDS(m)                                                                                \
    const fp3_v *a = (m)->from[0].row, *b = (m)->from[1].row, *c = (m)->from[2].row;               \
    const unsigned next_a = (m)->from[0].stride, next_b = (m)->from[1].stride,                     \
                   next_c = (m)->from[2].stride;                                                   \
    fp3_v *d = (m)->to, *const end = d + (m)->place->vectors
#define CASE(name, value)                                                                          \
    case FP3_OP_##name:                                                                            \
        _Pragma("GCC unroll 2") for (; d != end; d++, a += next_a, b += next_b, c += next_c) *d =  \
            value;                                                                                 \
        break;

/* Of the operations with a product. */
static void calculate_tiny(machine *m) {
    OPERANDS(m);
    met met = {fp3_all(0), fp3_all(0)};
    switch (m->now->in.op) {
        CASE(MUL, multiply(&met, *a, *b))
        CASE(MADD, fp3_add(*c, multiply(&met, *a, *b)))
        CASE(MSUB, fp3_sub(*c, multiply(&met, *a, *b)))
        CASE(FMADD, fuse(&met, *a, *b, *c))
        CASE(FMSUB, fuse(&met, fp3_minus(*a), *b, *c))
        CASE(ADDH, fp3_add(*a, multiply(&met, *b, FP3_HALF)))
        CASE(SUBH, fp3_sub(*a, multiply(&met, *b, FP3_HALF)))
        CASE(ADDT, fp3_add(*a, multiply(&met, *b, FP3_TWO)))
        CASE(SUBT, fp3_sub(*a, multiply(&met, *b, FP3_TWO)))
    default:
        break;
    }
    m->subnormal |= met.subnormal;
    m->under |= met.under;
}

static int has_product(uint32_t op) {
    return (fp3_operation_find(op)->path & FP3_UNIT_MULTIPLIER) != 0 &&
           fp3_operation_is_arithmetic(fp3_operation_find(op));
}

static void calculate(machine *m) {
    OPERANDS(m);
    const int *const table = m->place->table;
    switch (m->now->in.op) {
        CASE(ADD, fp3_add(*a, *b))
        CASE(SUB, fp3_sub(*a, *b))
        CASE(MUL, fp3_mul(*a, *b))
        CASE(MADD, fp3_madd(*a, *b, *c))
        CASE(MSUB, fp3_msub(*a, *b, *c))
        CASE(FMADD, fp3_fmadd(*a, *b, *c))
        CASE(FMSUB, fp3_fmsub(*a, *b, *c))
        CASE(ADDH, fp3_addh(*a, *b))
        CASE(SUBH, fp3_subh(*a, *b))
        CASE(ADDT, fp3_addt(*a, *b))
        CASE(SUBT, fp3_subt(*a, *b))
        CASE(MIN, fp3_min_raw(*a, *b))
        CASE(MAX, fp3_max_raw(*a, *b))
        CASE(ABS, fp3_abs(*a))
        CASE(LT, fp3_lt_raw(*a, *b))
        CASE(LE, fp3_le_raw(*a, *b))
        CASE(SEL, fp3_sel(*a, *b, *c))
        CASE(RCP, fp3_rcp(*a, table))
        CASE(RSQRT, fp3_rsqrt(*a, table))
        CASE(RINT, fp3_rint(*a))
        CASE(EXP2, fp3_exp2(*a))
        CASE(LOGB, fp3_logb(*a))
    default:
        break;
    }
}
#undef CASE
#undef OPERANDS

static int is_of_words(const machine *m) {
    return FP3_OF_WORDS || fp3_execute_is_by_logarithms(&m->config, m->now->in.op);
}

/* By the machine's own words; their flags are raised as the processor raises those of floats, and
 * nothing that it raises itself. */
static void calculate_words(machine *m) {
    const uint64_t before = fp3_fpu_get();
    const uint32_t op = m->now->in.op, sources = fp3_operation_find(op)->sources;
    fp3_short quick = fp3_short_of(&m->config);
    fp3_i all = fp3_all(0), flags;
    EACH {
        if (FP3_OF_WORDS && !FP3_FPU_IS_SOFT && !m->config.logarithmic &&
            fp3_short_apply(&quick, op, sources, A, B, C, m->place->table, &m->to[j]))
            continue;
        m->to[j] = fp3_words(&m->config, op, A, B, C, &flags);
        all |= flags;
    }
    /* Results are there, and so are the flags of sums in double. */
    __asm__ volatile("" ::: "memory");
    const uint64_t inexact = op == FP3_OP_RINT ? 0 : fp3_fpu_get() & FP3_FPU_INEXACT;
    uint32_t raised = 0;
    for (int i = 0; i < FP3_LANES; i++)
        raised |= (uint32_t)all[i];
    raised |= fp3_short_any(quick.lost) ? (uint32_t)FP3_FLAG_INEXACT : 0;
    fp3_fpu_set(before | inexact | fp3_words_sticky(raised));
}

/* Where an object sleeps it keeps what it has. */
static void keep(const machine *m, const fp3_v *from, fp3_v *to) {
    const fp3_i *awake = (const fp3_i *)(const void *)m->place->awake;
    if (m->now->is_masked)
        EACH to[j] = fp3_choose(awake[j], from[j], to[j]);
    else
        EACH to[j] = from[j];
}

/* What is left to do with results. */
static void finish(machine *m) {
    if (m->now->is_behind && !FP3_OF_WORDS)
        EACH m->to[j] = fp3_behind(m->to[j]);
    if (m->now->is_one_nan || m->is_watched)
        EACH m->to[j] = fp3_one_nan(m->to[j]);
    if (m->to == m->scratch)
        keep(m, m->scratch, row_of(m->place, m->now->in.d));
}

static void arithmetic(machine *m) {
    m->to = m->now->is_masked ? m->scratch : row_of(m->place, m->now->in.d);
    find_sources(m);
    if (is_of_words(m))
        calculate_words(m);
    else if (!FP3_FINITE && m->is_tiny && has_product(m->now->in.op))
        calculate_tiny(m);
    else
        calculate(m);
    finish(m);
}

static void fall_asleep(machine *m) {
    fp3_i *awake = (fp3_i *)(void *)m->place->awake;
    fp3_v *d = row_of(m->place, m->now->in.d);
    find_sources(m);
    EACH {
        const fp3_i now =
            awake[j] & (FP3_OF_WORDS ? fp3_words_sleep(&m->config, A, B) : fp3_sleeps(A, B));
        d[j] = fp3_choose(now, (fp3_v)fp3_all((int)m->number), d[j]);
        awake[j] &= ~now;
    }
}

static fp3_loose *record_of(const machine *m) {
    return (fp3_loose *)(void *)m->place->records[m->now->in.d];
}

static void load(machine *m) {
    fp3_v *d = row_of(m->place, m->now->in.d);
    EACH m->scratch[j] = (fp3_v)record_of(m)[j];
    keep(m, m->scratch, d);
}

static fp3_v value_stored(const machine *m, unsigned j) {
    const fp3_v value = row_of(m->place, m->now->in.d)[j];
    return m->now->is_one_nan ? fp3_one_nan(value) : value;
}

static fp3_i draws(const machine *m, unsigned j) {
    const fp3_i *objects = (const fp3_i *)(const void *)m->place->objects;
    return fp3_draws(m->place->seed, objects[j], m->number, m->now->in.d);
}

static void store(machine *m) {
    const fp3_i *awake = (const fp3_i *)(const void *)m->place->awake;
    fp3_loose *to = record_of(m);
    EACH {
        const fp3_v whole = value_stored(m, j);
        const fp3_v value =
            m->now->is_rounded ? fp3_stored(m->config.storage, whole, draws(m, j)) : whole;
        to[j] = m->is_last ? value : fp3_choose(awake[j], value, (fp3_v)to[j]);
    }
}

static int has_flags(const machine *m) {
    return m->now->is_rounded || fp3_operation_is_arithmetic(fp3_operation_find(m->now->in.op));
}

static fp3_i flags_of(machine *m, unsigned j);

/* What a processor with flags would raise now. */
static void raise(machine *m) {
    fp3_i flags = fp3_all(0);
    find_sources(m);
    EACH flags |= flags_of(m, j);
    fp3_fpu_set(fp3_fpu_get() | (unsigned)fp3_any(flags));
}

static void execute(machine *m) {
    if (FP3_FPU_IS_SOFT && !m->is_watched && (FP3_OF_WORDS ? m->now->is_rounded : has_flags(m)))
        raise(m);
    switch (m->now->in.op) {
    case FP3_OP_SLEEP:
        fall_asleep(m);
        break;
    case FP3_OP_LD:
    case FP3_OP_LDS:
        load(m);
        break;
    case FP3_OP_ST:
        store(m);
        break;
    default:
        arithmetic(m);
    }
}

static machine machine_of(const fp3_fast_plan *plan, const fp3_fast_place *place,
                          fp3_fast_part_number part, uint32_t number) {
    return (machine){.place = place,
                     .config = fp3_words_config(plan->config),
                     .number = number,
                     .is_last = part == FP3_PART_LAST};
}

static void make_part(machine *m, const fp3_fast_plan *plan, fp3_fast_part_number part,
                      uint32_t steps) {
    for (uint32_t i = 0; i < steps; i++) {
        m->number += part == FP3_PART_STEP;
        for (uint32_t pc = plan->part[part].first; pc < plan->part[part].end; pc++) {
            m->now = &plan->code[pc];
            execute(m);
        }
    }
}

static void run(const fp3_fast_plan *plan, const fp3_fast_place *place, fp3_fast_part_number part,
                uint32_t steps, uint32_t number) {
    machine m = machine_of(plan, place, part, number);
    make_part(&m, plan, part, steps);
}

static unsigned seen_by(const machine *m) {
    return (fp3_any(m->subnormal) ? FP3_SEEN_SUBNORMAL : 0) |
           (fp3_any(m->under) ? FP3_SEEN_UNDERFLOW : 0);
}

static void run_tiny(const fp3_fast_plan *plan, const fp3_fast_place *place,
                     fp3_fast_part_number part, uint32_t steps, uint32_t number) {
    machine m = machine_of(plan, place, part, number);
    m.is_tiny = 1;
    make_part(&m, plan, part, steps);
    *place->seen |= seen_by(&m);
}

static void run_words(const fp3_fast_plan *plan, const fp3_fast_place *place, uint32_t first,
                      uint32_t end) {
    machine m = machine_of(plan, place, FP3_PART_FIRST, 0);
    m.is_tiny = FP3_FPU_IS_EARLY;
    for (uint32_t pc = first; pc < end; pc++) {
        m.now = &plan->code[pc];
        execute(&m);
    }
    *place->seen |= seen_by(&m);
}

/* ---- with a witness ---- */

static fp3_i chosen(fp3_i mask, fp3_i a, fp3_i b) { return (mask & a) | (~mask & b); }

static fp3_i flags_of_store(const machine *m, unsigned j) {
    fp3_i over;
    fp3_rounded(m->config.storage, value_stored(m, j), draws(m, j), &over);
    return fp3_marked(over, FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT);
}

/* a b is rounded, then added to c. */
static fp3_i flags_of_chain(fp3_v a, fp3_v b, fp3_v c) {
    return fp3_flags_of_product(a, b) | fp3_flags_of_sum(c, fp3_product_value(a, b));
}

/* Of vector j, before the operation is executed. A signalling NaN raises invalid; operands tell
 * what is chosen or estimated. */
static fp3_i flags_of(machine *m, unsigned j) {
    const int *table = m->place->table;
    const fp3_v a = A, b = B, c = C;
    if (m->now->in.op == FP3_OP_ST)
        return flags_of_store(m, j);
    if (is_of_words(m)) {
        fp3_i flags;
        fp3_words(&m->config, m->now->in.op, a, b, c, &flags);
        return flags;
    }
    switch (m->now->in.op) {
    case FP3_OP_ADD:
        return fp3_flags_of_sum(a, b);
    case FP3_OP_SUB:
        return fp3_flags_of_sum(a, fp3_minus(b));
    case FP3_OP_MUL:
        return fp3_flags_of_product(a, b);
    case FP3_OP_MADD:
        return flags_of_chain(a, b, c);
    case FP3_OP_MSUB:
        return flags_of_chain(fp3_minus(a), b, c);
    case FP3_OP_FMADD:
        return fp3_flags_of_fused(a, b, c);
    case FP3_OP_FMSUB:
        return fp3_flags_of_fused(fp3_minus(a), b, c);
    case FP3_OP_ADDH:
        return flags_of_chain(b, FP3_HALF, a);
    case FP3_OP_SUBH:
        return flags_of_chain(fp3_minus(b), FP3_HALF, a);
    case FP3_OP_ADDT:
        return flags_of_chain(b, FP3_TWO, a);
    case FP3_OP_SUBT:
        return flags_of_chain(fp3_minus(b), FP3_TWO, a);
    case FP3_OP_MIN:
        return fp3_marked(fp3_is_signalling(fp3_min_raw(a, b)), FP3_FLAG_INVALID);
    case FP3_OP_MAX:
        return fp3_marked(fp3_is_signalling(fp3_max_raw(a, b)), FP3_FLAG_INVALID);
    case FP3_OP_SEL:
        return fp3_marked(fp3_is_signalling(fp3_sel(a, b, c)), FP3_FLAG_INVALID);
    case FP3_OP_RSQRT:
        return fp3_marked(fp3_is_signalling(fp3_rsqrt(a, table)), FP3_FLAG_INVALID);
    case FP3_OP_ABS:
    case FP3_OP_RCP:
    case FP3_OP_RINT:
    case FP3_OP_EXP2:
    case FP3_OP_LOGB:
        return fp3_marked(fp3_is_signalling(a), FP3_FLAG_INVALID);
    default:
        return fp3_all(0);
    }
}

#define ROW(name) ((fp3_i *)(void *)witness->name)

/* A grave exception counts as a failure in this step, unless one did before. */
static void fail(fp3_witness *witness, unsigned j, fp3_i flags, uint32_t number) {
    const fp3_i new = (flags != 0) & ~ROW(is_raised)[j];
    ROW(raised)[j] = chosen(new, fp3_all((int)number), ROW(raised)[j]);
    ROW(raised_flags)[j] = chosen(new, flags, ROW(raised_flags)[j]);
    ROW(is_raised)[j] |= new;
}

static void note_flags(machine *m, int is_ahead, fp3_witness *witness) {
    const fp3_i *awake = (const fp3_i *)(const void *)m->place->awake;
    find_sources(m);
    EACH {
        const fp3_i flags = flags_of(m, j) & (m->is_last ? fp3_all(-1) : awake[j]);
        const fp3_i grave = flags & GRAVE, first = (grave != 0) & (ROW(failed)[j] == 0);
        ROW(failed)[j] = chosen(first, fp3_all((int)m->number), ROW(failed)[j]);
        ROW(grave)[j] |= grave;
        ROW(flags)[j] |= flags;
        if (is_ahead)
            ROW(ahead)[j] |= (ROW(ahead)[j] == 0) & grave;
        else
            fail(witness, j, grave, m->number);
    }
}

/* What was computed ahead counts for those who make the step. */
static void begin_step(machine *m, fp3_witness *witness) {
    const fp3_i *awake = (const fp3_i *)(const void *)m->place->awake;
    EACH {
        fail(witness, j, ROW(ahead)[j] & awake[j], m->number);
        ROW(ahead)[j] &= ~awake[j];
    }
}

static void look_at_state(machine *m, const float *values, uint32_t reg, fp3_witness *witness) {
    const fp3_loose *row = (const fp3_loose *)(const void *)values;
    EACH {
        const fp3_i new = ~fp3_is_finite((fp3_v)row[j]) & ~ROW(is_strayed)[j];
        ROW(strayed)[j] = chosen(new, fp3_all((int)m->number), ROW(strayed)[j]);
        ROW(reg)[j] = chosen(new, fp3_all((int)reg), ROW(reg)[j]);
        ROW(bits)[j] = chosen(new, (fp3_i)row[j], ROW(bits)[j]);
        ROW(is_strayed)[j] |= new;
    }
}

/* After a part. Records may not be there where only flags are asked for. */
static void look_at_states(machine *m, const fp3_watch_plan *w, fp3_witness *witness) {
    const uint64_t stored = w->plan->config->interleave ? UINT64_MAX : 0;
    FP3_EACH_REGISTER (w->states, reg) {
        const int is_in_record = (m->is_last ? stored : stored & ~w->live) >> reg & 1;
        const float *record = is_in_record ? m->place->records[reg] : NULL;
        look_at_state(m, record ? record : m->place->rows + (size_t)reg * FP3_BLOCK, reg, witness);
    }
}

static void watch(const fp3_watch_plan *w, const fp3_fast_place *place, fp3_fast_part_number part,
                  uint32_t steps, uint32_t number, fp3_witness *witness) {
    const fp3_fast_part *of = &w->plan->part[part];
    machine m = machine_of(w->plan, place, part, number);
    m.is_tiny = m.is_watched = 1;
    for (uint32_t i = 0; i < steps; i++) {
        m.number += part == FP3_PART_STEP;
        if (part == FP3_PART_STEP)
            begin_step(&m, witness);
        for (uint32_t pc = of->first; pc < of->end; pc++) {
            m.now = &w->plan->code[pc];
            if (has_flags(&m))
                note_flags(&m, part == FP3_PART_FIRST || w->is_ahead[pc], witness);
            execute(&m);
        }
        if (part != FP3_PART_FIRST)
            look_at_states(&m, w, witness);
    }
}

static int are_estimates_exact(const int *table) { return fp3_are_estimates_exact(table); }

const fp3_sweep FP3_SWEEP = {FP3_LANES,         FP3_SWEEP_NAME,     run, run_tiny, watch, run_words,
                             fp3_is_any_astray, are_estimates_exact};
