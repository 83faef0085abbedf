/* chosen_values.c - comparisons, selections, estimates, rounding and exponents: the hardware, the
 * isa engine, and what isless and the table say, bit for bit; and the values of the fast engine.
 *
 *     chosen_values [N]      every Nth of all operands (1)
 *
 * Every configuration that has one of them. Operands are all pairs of special values with each kind
 * of condition, and every entry of the table with the exponents at which something changes. Each
 * object of a run gets three operands; retirements show value and flags. Where there is one object,
 * every 41st is tried.
 * The fast engine has no retirements: its values are read, of all operands, however it executes.
 */
#include "gen/registers.h"
#include <base/bits.h>
#include <engine/common/inside.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/config.h>
#include <machine/estimate.h>
#include <machine/lns.h>
#include <machine/operation.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    REGISTERS = 8,
    INPUTS_MAX = 80000,
    OBJECTS_MAX = 2048,
    WORDS_MAX = 3,
    REPORTS = 10,
    APART = 41
};

#define INVALID FP3_FLAG_INVALID
#define COUNT(array) (sizeof(array) / sizeof *(array))

typedef struct {
    uint32_t operand[3]; /* in r0, r1, r2 */
} input;

/* Up to three of them at a time: six registers, so that an object's record has eight words. */
static const uint32_t programs[][WORDS_MAX] = {{FP3_OP_MIN, FP3_OP_MAX, FP3_OP_ABS},
                                               {FP3_OP_LT, FP3_OP_LE, FP3_OP_SEL},
                                               {FP3_OP_RCP, FP3_OP_RSQRT, FP3_OP_ABS},
                                               {FP3_OP_RINT, FP3_OP_EXP2, FP3_OP_LOGB}};

typedef struct {
    const fp3_config *config;
    const char *engine;
    const uint32_t *ops;
    const input *inputs; /* of the objects of this run */
    uint64_t checked;
    unsigned failed;
} bench;

/* By bits alone: the isa engine calls back in the rounding mode of its configuration. */
static uint32_t power_of_two(float integral) {
    if (integral > 127)
        return 0x7f800000u;
    if (integral < -149)
        return 0;
    const int n = (int)integral;
    return n < -126 ? 1u << (n + 149) : (uint32_t)(n + 127) << 23;
}

/* ---- without infinities: numbers as doubles ---- */

static double finite_value(uint32_t bits) {
    const int e = (int)(bits >> 23 & 255);
    const double size = e ? ldexp((bits & 0x7fffff) | 0x800000, e - 150) : 0;
    return bits >> 31 ? -size : size;
}

static uint32_t finite_integer(double x) {
    int e;
    const double fraction = frexp(fabs(x), &e);
    const uint32_t size =
        x != 0 ? (uint32_t)(e + 126) << 23 | ((uint32_t)ldexp(fraction, 24) & 0x7fffff) : 0;
    return size | (x < 0 ? 0x80000000u : 0);
}

static uint32_t choose_finite(uint32_t op, const uint32_t *in) {
    const double a = finite_value(in[0]), b = finite_value(in[1]), c = finite_value(in[2]);
    const uint32_t sign = in[0] & 0x80000000u, most_estimate = 0x7fffe000u;
    switch (op) {
    case FP3_OP_MIN:
        return a < b ? in[0] : in[1];
    case FP3_OP_MAX:
        return b < a ? in[0] : in[1];
    case FP3_OP_ABS:
        return in[0] & 0x7fffffffu;
    case FP3_OP_LT:
        return a < b ? 0x3f800000u : 0;
    case FP3_OP_LE:
        return a <= b ? 0x3f800000u : 0;
    case FP3_OP_SEL:
        return c != 0 ? in[0] : in[1];
    case FP3_OP_RCP:
        return a == 0 ? sign | most_estimate : fabs(a) >= 0x1p126 ? 0 : fp3_estimate_rcp(in[0]);
    case FP3_OP_RINT:
        return finite_integer(trunc(a));
    case FP3_OP_EXP2:
        return trunc(a) > 128    ? 0x7fffffffu
               : trunc(a) < -126 ? 0
                                 : (uint32_t)((int)trunc(a) + 127) << 23;
    case FP3_OP_LOGB:
        return a == 0 ? 0xffffffffu : finite_integer(logb(a));
    default: /* half of that of a quarter, where the table has no exponent */
        return a <= 0         ? most_estimate
               : a >= 0x1p128 ? fp3_estimate_rsqrt(in[0] - 0x01000000u) - 0x00800000u
                              : fp3_estimate_rsqrt(in[0]);
    }
}

static uint32_t choose_read(const fp3_config *config, uint32_t op, const uint32_t *in) {
    if (config->finite)
        return choose_finite(op, in);
    const float a = fp3_value_of(in[0]), b = fp3_value_of(in[1]), c = fp3_value_of(in[2]);
    switch (op) {
    case FP3_OP_MIN:
        return isless(a, b) ? in[0] : in[1];
    case FP3_OP_MAX:
        return isless(b, a) ? in[0] : in[1];
    case FP3_OP_ABS:
        return in[0] & 0x7fffffffu;
    case FP3_OP_LT:
        return isless(a, b) ? 0x3f800000u : 0;
    case FP3_OP_LE:
        return islessequal(a, b) ? 0x3f800000u : 0;
    case FP3_OP_SEL:
        return fpclassify(c) != FP_ZERO ? in[0] : in[1];
    case FP3_OP_RCP:
        return fp3_estimate_rcp(in[0]);
    case FP3_OP_RINT:
        return isnan(a) ? in[0] : fp3_bits_of(config->nearest ? rintf(a) : truncf(a));
    case FP3_OP_EXP2:
        return isnan(a) ? in[0] : power_of_two(truncf(a));
    case FP3_OP_LOGB:
        return isnan(a) ? in[0] : fp3_bits_of(fpclassify(a) == FP_SUBNORMAL ? -INFINITY : logbf(a));
    default:
        return fp3_estimate_rsqrt(in[0]);
    }
}

/* Bits below the fraction are read as 0, by the adder behind, too. */
static uint32_t choose(const fp3_config *config, uint32_t op, const uint32_t *in) {
    const uint32_t kept = UINT32_MAX << (23 - config->fraction);
    const uint32_t read[] = {in[0] & kept, in[1] & kept, in[2] & kept};
    return choose_read(config, op, read) & kept;
}

/* The sum with -0. */
static uint32_t finished(const fp3_config *config, uint32_t bits, uint32_t *flags) {
    const uint32_t magnitude = bits & 0x7fffffffu;
    *flags = 0;
    if (config->finite)
        return magnitude < 0x00800000u ? 0 : bits;
    const int is_nan = magnitude > 0x7f800000u, is_signalling = is_nan && !(bits & 0x00400000u);
    *flags = config->flags && is_signalling ? INVALID : 0;
    if (is_nan)
        return 0x7fc00000u;
    return !config->subnormal && magnitude < 0x00800000u ? bits & 0x80000000u : bits;
}

/* What is no estimate tests/lns checks. */
static uint32_t expected(const fp3_config *config, uint32_t op, const uint32_t *in,
                         uint32_t *flags) {
    if (!config->mixed || (op != FP3_OP_RCP && op != FP3_OP_RSQRT))
        return finished(config, choose(config, op, in), flags);
    return (op == FP3_OP_RCP ? fp3_lns_float_rcp : fp3_lns_float_rsqrt)(in[0], flags);
}

/* Where the word of operation i goes: to a register of odd number if sums and products are apart.
 */
static uint32_t apart(const fp3_config *config) { return config->dual ? 2 : 1; }
static uint32_t result_of(const fp3_config *config, uint32_t i) { return 3 + i * apart(config); }

static void compare(void *user, const fp3_retirement *r) {
    bench *b = user;
    if (r->reg < 3) /* a load */
        return;
    const uint32_t *in = b->inputs[r->object].operand;
    const uint32_t op = b->ops[(r->reg - 3) / apart(b->config)];
    uint32_t flags;
    const uint32_t bits = expected(b->config, op, in, &flags);
    b->checked++;
    if ((r->bits != bits || r->flags != flags) && b->failed++ < REPORTS)
        printf("FAIL %s %s: operation %" PRIu32 " of 0x%08" PRIx32 " 0x%08" PRIx32 " 0x%08" PRIx32
               ": got 0x%08" PRIx32 " flags 0x%02" PRIx32 ", expected 0x%08" PRIx32
               " flags 0x%02" PRIx32 "\n",
               b->config->name, b->engine, op, in[0], in[1], in[2], r->bits, r->flags, bits, flags);
}

/* ---- operands ---- */

static size_t special_values(uint32_t *to) {
    static const uint32_t values[] = {0x00000000, 0x00000001, 0x00000002, 0x007fffff, 0x00800000,
                                      0x00800001, 0x01000000, 0x34ffffff, 0x3effffff, 0x3f000000,
                                      0x3f7fffff, 0x3f800000, 0x3f800001, 0x40000000, 0x7effffff,
                                      0x7f000000, 0x7f7fffff, 0x7f800000, 0x7f800001, 0x7fbfffff,
                                      0x7fc00000, 0x7fc12345};
    for (size_t i = 0; i < COUNT(values); i++) {
        to[2 * i] = values[i];
        to[2 * i + 1] = values[i] | 0x80000000u;
    }
    return 2 * COUNT(values);
}

static size_t pairs(input *to) {
    static const uint32_t conditions[] = {
        0, 0x80000000, 1, 0x80000001, 0x00400000, 0x40000000, 0x3f800000, 0x7f800001, 0xffc00000};
    uint32_t values[64];
    const size_t n = special_values(values);
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < COUNT(conditions); k++)
                to[count++] = (input){{values[i], values[j], conditions[k]}};
    return count;
}

/* Both ends of what one entry of the table is for: of rsqrt the upper 9, of rcp the upper 10 bits.
 */
static size_t entries(input *to) {
    static const uint32_t exponents[] = {0, 1, 2, 126, 127, 128, 129, 251, 252, 253, 254, 255};
    size_t count = 0;
    for (size_t e = 0; e < COUNT(exponents); e++)
        for (uint32_t index = 0; index < 1024; index++)
            for (uint32_t end = 0; end < 4; end++)
                to[count++] = (input){
                    {(end & 1) << 31 | exponents[e] << 23 | index << 13 | (end & 2 ? 0x1fffu : 0),
                     0x3f800000u, 0}};
    return count;
}

/* Around every integral number to which exp2 has a power, and some beyond. */
static size_t integers(input *to) {
    size_t count = 0;
    for (int n = -160; n <= 160; n++)
        for (int step = -2; step <= 2; step++) {
            const float a = step == 2 ? (float)n + 0.5f : step == -2 ? (float)n - 0.25f : (float)n;
            const uint32_t next = step == 1 ? 1u : step == -1 ? UINT32_MAX : 0;
            to[count++] = (input){{fp3_bits_of(a) + (n ? next : 0), 0x3f800000u, 0}};
        }
    return count;
}

/* At every exponent the fractions next to one with a single bit, below and above which something
 * is added or not, and some by chance; all bits where the point is among them. */
static size_t halves(input *to) {
    size_t count = 0;
    uint32_t chance = 1;
    for (uint32_t exponent = 0; exponent < 256; exponent++) {
        const uint32_t every = exponent > 120 && exponent < 152 ? 1 : 11;
        for (uint32_t bit = 0; bit < 23; bit += every)
            for (uint32_t k = 0; k < 8; k++) {
                chance = chance * 1664525u + 1013904223u;
                const uint32_t upper = k & 4 ? chance >> 9 << bit << 1 : 0;
                const uint32_t fraction = k & 3 ? (1u << bit) + upper + (k & 3) - 2 : chance >> 4;
                to[count++] =
                    (input){{(chance & 0x80000000u) | exponent << 23 | (fraction & 0x7fffffu),
                             0x3f800000u, 0}};
            }
    }
    return count;
}

/* ---- runs ---- */

static int has(const fp3_config *config, uint32_t op) {
    return op && fp3_operation_lacks(config, op) == FP3_KEY_NONE;
}

static int failed(bench *b, const fp3_error *error) {
    printf("FAIL %s %s: %s\n", b->config->name, b->engine, error->text);
    b->failed++;
    return 1;
}

static int load(bench *b, fp3_engine *engine) {
    uint32_t code[WORDS_MAX], count = 0;
    for (uint32_t i = 0; i < WORDS_MAX; i++) {
        if (!has(b->config, b->ops[i]))
            continue;
        const uint32_t sources = fp3_operation_find(b->ops[i])->sources;
        const fp3_instruction in = {.op = b->ops[i],
                                    .d = result_of(b->config, i),
                                    .b = sources > 1,
                                    .c = sources > 2 ? 2 : 0};
        code[count++] = fp3_word_encode(&in);
    }
    return fp3_engine_load(engine, &(fp3_image){.code = code, .code_count = count, .last = count});
}

static int run(bench *b, fp3_engine *engine, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t reg = 0; reg < 3; reg++) {
            const uint32_t word = b->inputs[i].operand[reg];
            if (fp3_engine_write_words(engine, i, 1, reg, &word))
                return 1;
        }
    return fp3_engine_run(engine, 1, NULL) != FP3_OK;
}

/* What the registers hold that the program has written. */
static int compare_read(bench *b, fp3_engine *engine, size_t count) {
    for (uint32_t i = 0; i < WORDS_MAX; i++) {
        if (!has(b->config, b->ops[i]))
            continue;
        for (size_t object = 0; object < count; object++) {
            uint32_t got, flags;
            if (fp3_engine_read_words(engine, object, 1, result_of(b->config, i), &got))
                return 1;
            const uint32_t *in = b->inputs[object].operand;
            const uint32_t bits = expected(b->config, b->ops[i], in, &flags);
            b->checked++;
            if (got != bits && b->failed++ < REPORTS)
                printf("FAIL %s %s: operation %" PRIu32 " of 0x%08" PRIx32 " 0x%08" PRIx32
                       " 0x%08" PRIx32 ": got 0x%08" PRIx32 ", expected 0x%08" PRIx32 "\n",
                       b->config->name, getenv("FP3_FAST"), b->ops[i], in[0], in[1], in[2], got,
                       bits);
        }
    }
    return 0;
}

static void check(bench *b, const input *inputs, size_t count) {
    const int is_fast = strcmp(b->engine, "fast") == 0;
    fp3_error error;
    fp3_engine_def def = fp3_engine_default();
    const uint32_t columns = fp3_config_schedulers(b->config) * b->config->lanes;
    const uint32_t room = b->config->store_words / 8 * columns;
    def.engine = b->engine;
    def.config = b->config->name;
    def.objects = !b->config->interleave ? 1 : room < OBJECTS_MAX ? room : OBJECTS_MAX;
    def.retire = is_fast ? NULL : compare;
    def.retire_user = b;
    def.error = &error;
    const size_t step = b->config->interleave ? def.objects : APART;
    fp3_engine *engine;
    if (fp3_engine_open(&def, &engine)) {
        failed(b, &error);
        return;
    }
    for (size_t p = 0; p < COUNT(programs); p++) {
        b->ops = programs[p];
        if (!has(b->config, b->ops[0]))
            continue;
        int is_wrong = load(b, engine);
        for (size_t at = 0; at < count && !is_wrong; at += step) {
            b->inputs = inputs + at;
            is_wrong =
                run(b, engine, def.objects) || (is_fast && compare_read(b, engine, def.objects));
        }
        if (is_wrong && failed(b, &error))
            break;
    }
    fp3_engine_close(&engine);
}

/* What logarithms have instead of estimates, and no signalling NaN, tests/lns checks. */
static int is_for(const fp3_config *config) {
    int is_any = 0;
    for (size_t p = 0; p < COUNT(programs); p++)
        is_any |= has(config, programs[p][0]);
    return is_any && config->registers >= REGISTERS && !config->logarithmic &&
           !config->storage; /* a record has few of the operands */
}

/* Of the processor's ways to execute those that it has; their order is that of what they need. */
static unsigned check_fast(const input *inputs, size_t count, uint64_t *checked) {
    static const char *const ways[] = {"interpreter", "x86-64", "x86-64-v3", "x86-64-v4"};
    const size_t here = __builtin_cpu_supports("avx512dq") ? 4
                        : __builtin_cpu_supports("avx2")   ? 3
                                                           : 2;
    const fp3_config *config = fp3_config_find("many_full");
    unsigned wrong = 0;
    for (size_t i = 0; config && i < here; i++) { /* a random configuration is alone */
        bench b = {.config = config, .engine = "fast"};
        setenv("FP3_FAST", ways[i], 1);
        check(&b, inputs, count);
        wrong += b.failed;
        *checked += b.checked;
    }
    return wrong;
}

int main(int argc, char **argv) {
    static input inputs[INPUTS_MAX + OBJECTS_MAX]; /* the last run may go beyond count */
    const size_t every = argc > 1 ? strtoul(argv[1], NULL, 10) : 1;
    size_t count = pairs(inputs);
    count += entries(inputs + count);
    count += halves(inputs + count);
    count += integers(inputs + count);
    unsigned wrong = 0;
    uint64_t checked = 0, of_fast = 0;
    wrong += check_fast(inputs, count, &of_fast);
    count = every ? count / every : 0;
    for (size_t i = 0; i < count; i++)
        inputs[i] = inputs[i * every];
    for (uint32_t i = 0; i < fp3_config_count; i++)
        for (int k = 0; k < 2; k++) {
            bench b = {.config = &fp3_configs[i], .engine = k ? "rtl" : "isa"};
            if (is_for(b.config))
                check(&b, inputs, count);
            wrong += b.failed;
            checked += b.checked;
        }
    printf("%zu operands, %" PRIu64 " results, %" PRIu64 " of the fast engine, %u wrong\n", count,
           checked, of_fast, wrong);
    return wrong != 0;
}
