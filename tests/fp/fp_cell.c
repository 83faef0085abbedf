/* fp_cell - Cell's arithmetic against an oracle of its own: the cores, and the engine isa's
 * functions.
 *
 * Neither the cores nor sw/machine/finite.c computes as this does: numbers are doubles here, whose
 * exponents go far beyond 2^129. A product of two is exact. A sum is rounded to nearest, and the
 * error of that is a double, too (Knuth, "The Art of Computer Programming" 2, 4.2.2, theorem B).
 * Then both are truncated to 24 bits. Every pair of special numbers, and random ones.
 */
#include <math.h>

#include "fp_common.h"
#include "fp_pairs.h"
#include "machine/execute.h"

#include <fp3/isa.h>

enum { OF = 4, UF = 2, NX = 1 };
#define TOP 0x1p129 /* the first number that is too large */

static double value_of(uint32_t bits) {
    const int e = (int)(bits >> 23 & 255);
    const double size = e ? ldexp((bits & 0x7fffff) | 0x800000, e - 150) : 0;
    return bits >> 31 ? -size : size;
}

/* The number exact + rest, where rest is below the last bit of exact. */
static uint32_t truncated(double exact, double rest, uint8_t *flags) {
    const uint32_t sign = exact < 0 ? 0x80000000u : 0;
    int e;
    *flags = 0;
    if (exact == 0)
        return 0;
    const double towards = exact < 0 ? -rest : rest, scaled = ldexp(frexp(fabs(exact), &e), 24);
    double whole = floor(scaled);
    if (scaled == whole && towards < 0) { /* one less; below a power of two, that has a bit more */
        whole = whole == 0x1p23 ? 0x1p24 - 1 : whole - 1;
        e -= whole == 0x1p24 - 1;
    }
    const double size = ldexp(whole, e - 24);
    if (size >= TOP) {
        *flags = OF | NX;
        return sign | 0x7fffffff;
    }
    if (size < 0x1p-126) {
        *flags = UF | NX;
        return 0;
    }
    *flags = scaled != whole || rest != 0 ? NX : 0;
    return sign | (uint32_t)(e + 126) << 23 | ((uint32_t)whole & 0x7fffff);
}

static uint32_t expected(fp3_bench_op op, uint32_t a, uint32_t b, uint8_t *flags) {
    const double x = value_of(a), y = op == FP3_BENCH_SUB ? -value_of(b) : value_of(b);
    if (op == FP3_BENCH_MUL)
        return truncated(x * y, 0, flags);
    const volatile double sum = x + y, of_y = sum - x, of_x = sum - of_y;
    const double rest = (x - of_x) + (y - of_y);
    return truncated(sum, rest, flags);
}

/* Around every place where something changes: exponents 0, 1, 127, 254 and 255, and runs of ones
 * and zeros. */
static size_t specials(uint32_t *of) {
    static const uint32_t fractions[] = {0, 1, 2, 0x3fffff, 0x400000, 0x400001, 0x7ffffe, 0x7fffff};
    static const uint32_t exponents[] = {0,   1,   2,   23,  24,  25,  103, 125, 126, 127, 128,
                                         129, 151, 152, 229, 230, 231, 252, 253, 254, 255};
    size_t n = 0;
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
        for (size_t f = 0; f < sizeof fractions / sizeof *fractions; f++)
            for (uint32_t sign = 0; sign < 2; sign++)
                of[n++] = sign << 31 | exponents[e] << 23 | fractions[f];
    return n;
}

typedef struct {
    fp3_bench *bench;
    const fp3_fp_options *opt;
    fp3_bench_op op;
    fp3_batch batch;
    unsigned reported;
    uint64_t wrong, raised[3];
} test;

static void flush(test *t) {
    static const fp3_config cell = {.finite = 1, .flags = 1, .name = "cell"};
    static const uint32_t ops[] = {FP3_OP_ADD, FP3_OP_SUB, FP3_OP_MUL};
    fp3_batch *batch = &t->batch;
    for (size_t i = 0; i < batch->n; i++) {
        batch->z[i] = expected(t->op, batch->a[i], batch->b[i], &batch->flags[i]);
        for (int flag = 0; flag < 3; flag++)
            t->raised[flag] += batch->flags[i] >> flag & 1;
        uint32_t flags;
        const uint32_t operands[] = {batch->a[i], batch->b[i], 0};
        const uint32_t z = fp3_execute(&cell, ops[t->op], operands, &flags);
        if (z == batch->z[i] && flags == batch->flags[i])
            continue;
        t->wrong++;
        if (t->reported++ < FP3_REPORTS) {
            printf("FAIL isa: %s 0x%08" PRIx32 " 0x%08" PRIx32 "\n", fp3_op_names[t->op],
                   batch->a[i], batch->b[i]);
            fp3_print_result("expected", batch->z[i], batch->flags[i]);
            fp3_print_result("got", z, flags);
        }
    }
    t->wrong += fp3_check(t->bench, FP3_BENCH_CELL, t->op, batch, t->opt->program, &t->reported);
    batch->n = 0;
}

static void put(test *t, uint32_t a, uint32_t b) {
    t->batch.a[t->batch.n] = a;
    t->batch.b[t->batch.n] = b;
    if (++t->batch.n == FP3_BATCH)
        flush(t);
}

static uint64_t run(const fp3_fp_options *opt, fp3_bench *bench, fp3_bench_op op) {
    static test t;
    static uint32_t special[512];
    t = (test){.bench = bench, .opt = opt, .op = op};
    const size_t n = opt->one ? 0 : specials(special);
    gsl_rng *rng = gsl_rng_alloc(FP3_PAIRS_RNG);
    if (!rng)
        abort();
    gsl_rng_set(rng, opt->seed + (unsigned long)op);
    for (size_t i = 0; i < n * n; i++)
        put(&t, special[i / n], special[i % n]);
    for (uint64_t i = 0; i < (opt->one ? 1 : opt->pairs); i++) {
        uint32_t a = opt->a, b = opt->b;
        if (!opt->one)
            fp3_pair(rng, 8, 23, op, &a, &b);
        put(&t, a, b);
    }
    flush(&t);
    printf("%s: %zu special and %" PRIu64 " random pairs (OF %" PRIu64 ", UF %" PRIu64
           ", NX %" PRIu64 "), cores and isa: %" PRIu64 " mismatches\n",
           fp3_op_names[op], n * n, opt->one ? 1 : opt->pairs, t.raised[2], t.raised[1],
           t.raised[0], t.wrong);
    gsl_rng_free(rng);
    return t.wrong;
}

int main(int argc, char **argv) {
    const fp3_fp_options opt = fp3_parse(
        argc, argv, "Tests Cell's arithmetic in binary32's format against doubles.", 1000000);
    fp3_bench *bench = fp3_bench_open();
    if (!bench) {
        fprintf(stderr, "fp_cell: no memory\n");
        return 1;
    }
    printf("seed %lu\n", opt.seed);
    uint64_t wrong = 0;
    for (int op = 0; op < 3; op++)
        if (opt.op == FP3_ALL || opt.op == op)
            wrong += run(&opt, bench, (fp3_bench_op)op);
    fp3_bench_close(bench);
    return wrong != 0;
}
