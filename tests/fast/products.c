/* products.c - products by fp3_execute, by the processor in vectors, and as in tiny.h, with what
 * they raise: around all ends of the range, and at random where a result just is, or just is not,
 * subnormal.
 *
 *     products [RANDOM-PAIRS]     (default: 10000)
 */
#include "engine/fast/plan.h"
#include "engine/fast/sweep.h"
#include "gen/registers.h"
#include "machine/execute.h"
#include <base/bits.h>

#include <fp3/isa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#define LANES 16u
#define SHOWN 10

/* mul r2, r0, r1 as a step. */
typedef struct {
    fp3_config config;
    const fp3_sweep *sweep;
    fp3_fast_word word;
    fp3_fast_plan plan;
    _Alignas(64) float rows[3][FP3_BLOCK];
    _Alignas(64) int awake[FP3_BLOCK];
    fp3_witness witness;
    unsigned long made, wrong;
} bench;

static uint64_t chance = 88172645463325252u;
static uint32_t draw(void) {
    chance ^= chance << 13;
    chance ^= chance >> 7;
    chance ^= chance << 17;
    return (uint32_t)(chance >> 32);
}

static void wrong(bench *b, const char *what, const uint32_t *operands, uint32_t found,
                  uint32_t expected) {
    if (b->wrong++ < SHOWN)
        printf("%s, nearest %u, subnormal %u, %s: %08x * %08x gives %08x, expected %08x\n",
               b->sweep->name, b->config.nearest, b->config.subnormal, what, operands[0],
               operands[1], found, expected);
}

static void fill(bench *b, uint32_t (*pairs)[2]) {
    for (unsigned i = 0; i < LANES; i++)
        for (unsigned k = 0; k < 2; k++)
            memcpy(&b->rows[k][i], &pairs[i][k], sizeof(float));
    memset(b->rows[2], 0, sizeof b->rows[2]);
    memset(b->awake, 0xff, sizeof b->awake);
    memset(&b->witness, 0, sizeof b->witness);
}

static int is_nan(uint32_t bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

static int is_subnormal(uint32_t bits) {
    return (bits & 0x7fffffffu) != 0 && (bits & 0x7f800000u) == 0;
}

/* Whether tiny.h is still needed: a run goes back to the processor's products without. A result
 * that is rounded up to the least normal number may be counted or not, and so may a product with 0.
 */
static void compare_need(bench *b, uint32_t (*pairs)[2], const uint32_t *products, unsigned seen) {
    int is_needed = 0, is_either = 0;
    for (unsigned i = 0; i < LANES; i++)
        is_needed |=
            is_subnormal(pairs[i][0]) || is_subnormal(pairs[i][1]) || is_subnormal(products[i]);
    for (unsigned i = 0; i < LANES; i++)
        is_either |= (products[i] & 0x7fffffffu) == 0x00800000u || (pairs[i][0] << 1) == 0 ||
                     (pairs[i][1] << 1) == 0;
    if (b->config.subnormal && !(seen & FP3_SEEN_UNDERFLOW) && !is_either &&
        !(seen & FP3_SEEN_SUBNORMAL) != !is_needed)
        wrong(b, "tiny, subnormal", pairs[0], seen, (uint32_t)is_needed);
}

static void compare(bench *b, const char *what, uint32_t (*pairs)[2], const uint32_t *expected) {
    for (unsigned i = 0; i < LANES; i++) {
        uint32_t found;
        memcpy(&found, &b->rows[2][i], sizeof found);
        if (found != expected[i] && !(is_nan(found) && is_nan(expected[i])))
            wrong(b, what, pairs[i], found, expected[i]);
    }
}

static void multiply(bench *b, uint32_t (*pairs)[2]) {
    uint32_t expected[LANES], flags[LANES], all = 0;
    unsigned seen = 0;
    const uint64_t callers = fp3_fpu_begin(b->config.nearest);
    for (unsigned i = 0; i < LANES; i++) {
        const uint32_t operands[3] = {pairs[i][0], pairs[i][1]};
        expected[i] = fp3_execute(&b->config, FP3_OP_MUL, operands, &flags[i]);
        all |= flags[i];
    }
    fp3_fpu_set(callers);
    const fp3_fast_place place = {
        .rows = b->rows[0], .awake = b->awake, .seen = &seen, .vectors = LANES / b->sweep->lanes};
    const uint32_t mxcsr = _mm_getcsr();
    _mm_setcsr(0x1f80u | (b->config.nearest ? 0 : 0x6000u));
    fill(b, pairs);
    b->sweep->run(&b->plan, &place, FP3_PART_STEP, 1, 0);
    compare(b, "the processor", pairs, expected);
    fill(b, pairs);
    _mm_setcsr(0x1f80u | (b->config.nearest ? 0 : 0x6000u));
    b->sweep->run_tiny(&b->plan, &place, FP3_PART_STEP, 1, 0);
    const uint32_t raised = _mm_getcsr();
    compare(b, "tiny", pairs, expected);
    compare_need(b, pairs, expected, seen);
    if (!(seen & FP3_SEEN_UNDERFLOW) != !(all & FP3_FLAG_UNDERFLOW))
        wrong(b, "tiny, underflow", pairs[0], seen, all);
    if (b->config.subnormal && b->config.nearest && !(raised >> 5 & 1) != !(all & FP3_FLAG_INEXACT))
        wrong(b, "tiny, inexact", pairs[0], raised, all);
    fill(b, pairs);
    b->sweep->watch(&(fp3_watch_plan){&b->plan, (const uint8_t[]){0}, 0, 0}, &place, FP3_PART_STEP,
                    1, 0, &b->witness);
    compare(b, "watched", pairs, expected);
    for (unsigned i = 0; i < LANES; i++)
        if ((uint32_t)b->witness.flags[i] != flags[i])
            wrong(b, "watched, flags", pairs[i], (uint32_t)b->witness.flags[i], flags[i]);
    _mm_setcsr(mxcsr);
    b->made += LANES;
}

/* One pair in all lanes: what was seen was seen of it. */
static void multiply_one(bench *b, uint32_t x, uint32_t y) {
    uint32_t pairs[LANES][2];
    for (unsigned i = 0; i < LANES; i++)
        memcpy(pairs[i], (const uint32_t[]){x, y}, sizeof pairs[i]);
    multiply(b, pairs);
}

/* Each power of two and its neighbours, zeros, infinity, the NaN; the least and largest subnormal
 * numbers. */
static void multiply_chosen(bench *b) {
    static const uint32_t near[] = {0, 1, 0x7fffff, 0x400000};
    for (uint32_t e = 0; e < 256; e += e < 8 || e > 250 ? 1 : 9)
        for (uint32_t f = 0; f < 256; f += f < 8 || f > 250 ? 1 : 9)
            for (unsigned i = 0; i < 16; i++) {
                const uint32_t x =
                    e == 255 ? (i & 1 ? 0x7fc00000u : 0x7f800000u) : e << 23 | near[i & 3];
                const uint32_t y =
                    f == 255 ? (i & 4 ? 0x7fc00000u : 0x7f800000u) : f << 23 | near[i >> 2];
                multiply_one(b, x | (draw() & 0x80000000u), y | (draw() & 0x80000000u));
            }
}

/* Of a product of some 2^-126 or some multiple of 2^-149: the factors differ by units in the last
 * place. */
static uint32_t partner(uint32_t x) {
    const float f = fp3_value_of(x & 0x7fffffffu);
    const double target = draw() & 1 ? 0x1p-126 : 0x1p-149 * (1 + draw() % (1u << (draw() % 25)));
    return fp3_bits_of((float)(target / (double)f)) + draw() % 5 - 2;
}

static void multiply_random(bench *b, unsigned long pairs) {
    for (unsigned long n = 0; n < pairs; n++) {
        const uint32_t x = draw() & 0x7fffffffu;
        const uint32_t y = (n & 7) == 0 ? draw() : partner(x < 0x7f800000u ? x : 0x00800000u);
        multiply_one(b, x, y);
    }
}

static unsigned long try(uint32_t nearest, uint32_t subnormal, const char *kind,
                         unsigned long pairs) {
    static bench b;
    const unsigned long none = 0;
    b = (bench){.config = *fp3_config_find("many_full"),
                .word.in = {.op = FP3_OP_MUL, .d = 2, .a = 0, .b = 1}};
    b.config.nearest = nearest;
    b.config.subnormal = subnormal;
    b.sweep = fp3_sweep_choose(&b.config, kind);
    if (*kind && strcmp(kind, b.sweep->name) != 0) {
        printf("%s: not this processor\n", kind);
        return none;
    }
    b.plan = (fp3_fast_plan){.config = &b.config, .code = &b.word, .count = 1};
    b.plan.part[FP3_PART_STEP].end = 1;
    multiply_chosen(&b);
    multiply_random(&b, pairs);
    printf("%s, nearest %u, subnormal %u: %lu products, %lu wrong\n", b.sweep->name, nearest,
           subnormal, b.made, b.wrong);
    return b.wrong;
}

int main(int argc, char **argv) {
    const unsigned long pairs = argc > 1 ? strtoul(argv[1], NULL, 0) : 10000;
    unsigned long wrong = 0;
    wrong += try(1, 1, "x86-64", pairs);
    wrong += try(1, 1, "x86-64-v3", pairs);
    wrong += try(1, 1, "x86-64-v4", pairs);
    wrong += try(0, 1, "", pairs);
    wrong += try(1, 0, "", pairs);
    wrong += try(0, 0, "", pairs);
    printf("%lu wrong\n", wrong);
    return wrong != 0;
}
