/* lns_rtl.c - rtl/lns/lns_*.v against sw/machine/lns.c, value and flags.
 *
 *     lns_rtl [PAIRS]          of each operation every pair of special words, and so many random
 * pairs (default 1,000,000)
 */
#include "lns_operands.h"

#include <inttypes.h>
#include <machine/lns.h>
#include <stdio.h>
#include <stdlib.h>

#include "lns_bench.h"

enum { BATCH = 4096, REPORTS = 10 };

static const struct {
    const char *name;
    fp3_lns_op op;
} operations[] = {
    {"add", FP3_LNS_ADD},
    {"sub", FP3_LNS_SUB},
    {"mul", FP3_LNS_MUL},
    {"div", FP3_LNS_DIV},
    {"sqrt", FP3_LNS_SQRT},
    {"rsqrt", FP3_LNS_RSQRT},
    {"from_float", FP3_LNS_FROM_FLOAT},
    {"to_float", FP3_LNS_TO_FLOAT},
    {"float_rcp", FP3_LNS_FLOAT_RCP},
    {"float_rsqrt", FP3_LNS_FLOAT_RSQRT},
};

/* lns_inverse gives 0 for a NaN, which the adder makes quiet. */
static uint32_t of_number(uint32_t (*inverse)(uint32_t, uint32_t *), uint32_t a, uint32_t *flags) {
    *flags = 0;
    return (a & 0x7fffffff) > LNS_INFINITE ? 0 : inverse(a, flags);
}

static uint32_t model(fp3_lns_op op, uint32_t a, uint32_t b, uint32_t *flags) {
    switch (op) {
    case FP3_LNS_ADD:
        return fp3_lns_add(a, b, flags);
    case FP3_LNS_SUB:
        return fp3_lns_sub(a, b, flags);
    case FP3_LNS_MUL:
        return fp3_lns_mul(a, b, flags);
    case FP3_LNS_DIV:
        return fp3_lns_div(a, b, flags);
    case FP3_LNS_SQRT:
        return lns_sqrt(a, flags);
    case FP3_LNS_RSQRT:
        return fp3_lns_rsqrt(a, flags);
    case FP3_LNS_FLOAT_RCP:
        return of_number(fp3_lns_float_rcp, a, flags);
    case FP3_LNS_FLOAT_RSQRT:
        return of_number(fp3_lns_float_rsqrt, a, flags);
    case FP3_LNS_FROM_FLOAT:
        return fp3_lns_from_float(a, flags);
    default:
        return fp3_lns_to_float(a, flags);
    }
}

typedef struct {
    fp3_lns_bench *bench;
    uint32_t a[BATCH], b[BATCH];
    size_t n;
    uint64_t wrong, raised[5]; /* NX, UF, OF, DZ, NV */
} test;

static void flush(test *t, size_t which) {
    static uint32_t z[BATCH];
    static uint8_t flags[BATCH];
    fp3_lns_bench_run(t->bench, operations[which].op, t->n, t->a, t->b, z, flags);
    for (size_t i = 0; i < t->n; i++) {
        uint32_t raised;
        const uint32_t word = model(operations[which].op, t->a[i], t->b[i], &raised);
        for (int f = 0; f < 5; f++)
            t->raised[f] += raised >> f & 1;
        if ((word != z[i] || raised != flags[i]) && t->wrong++ < REPORTS)
            printf("FAIL %s 0x%08" PRIx32 " 0x%08" PRIx32 ": hardware 0x%08" PRIx32
                   " flags 0x%02x, model 0x%08" PRIx32 " flags 0x%02" PRIx32 "\n",
                   operations[which].name, t->a[i], t->b[i], z[i], (unsigned)flags[i], word,
                   raised);
    }
    t->n = 0;
}

static void put(test *t, size_t which, uint32_t a, uint32_t b) {
    t->a[t->n] = a;
    t->b[t->n] = b;
    if (++t->n == BATCH)
        flush(t, which);
}

int main(int argc, char **argv) {
    const unsigned long pairs = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000000;
    static test t;
    uint32_t words[LNS_SPECIAL];
    const size_t count = lns_special_words(words);
    uint64_t wrong = 0;
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_taus2);
    t.bench = fp3_lns_bench_open();
    if (!rng || !t.bench)
        return 2;
    for (size_t which = 0; which < sizeof operations / sizeof *operations; which++) {
        for (size_t f = 0; f < 5; f++)
            t.raised[f] = 0;
        t.wrong = 0;
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < count; j++)
                put(&t, which, words[i], words[j]);
        for (unsigned long i = 0; i < pairs; i++) {
            uint32_t a, b;
            lns_draw(rng, &a, &b);
            put(&t, which, a, b);
        }
        flush(&t, which);
        printf("%s: %zu special and %lu random pairs (NV %" PRIu64 ", DZ %" PRIu64 ", OF %" PRIu64
               ", UF %" PRIu64 ", NX %" PRIu64 "): %" PRIu64 " mismatches\n",
               operations[which].name, count * count, pairs, t.raised[4], t.raised[3], t.raised[2],
               t.raised[1], t.raised[0], t.wrong);
        wrong += t.wrong;
    }
    fp3_lns_bench_close(t.bench);
    gsl_rng_free(rng);
    return wrong != 0;
}
