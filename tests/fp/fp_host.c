/* fp_host - binary32 add, subtract, multiply and multiply-add, rounded once, against the FPU of
 * this machine, values and flags.
 *
 * Every pair (of multiply-add, every triple of fewer) of special values and many random ones,
 * through the uncut cores and through every distinct set of cuts of the named configurations. The
 * host must be an IEEE 754 machine that detects tininess after rounding, as x86 and RISC-V do and
 * ARM does not: checked at the start.
 */
#include <base/bits.h>
#include <fenv.h>
#include <float.h>
#include <math.h>

#include "fp_common.h"
#include "fp_pairs.h"

enum { QUIET_NAN = 0x7fc00000, NO_REFERENCE = 77 /* exit status: skipped */ };

typedef struct {
    const fp3_fp_options *opt;
    fp3_bench *bench;
    fp3_batch batch;
    unsigned reported;
    uint64_t raised[5]; /* how often each flag was expected */
} test;

/* volatile: computed here and now, between the two calls that handle the flags. */
static uint32_t host(fp3_bench_op op, uint32_t a, uint32_t b, uint32_t c, uint8_t *flags) {
    volatile float x = fp3_value_of(a), y = fp3_value_of(b), w = fp3_value_of(c), z;
    feclearexcept(FE_ALL_EXCEPT);
    switch (op) {
    case FP3_BENCH_ADD:
        z = x + y;
        break;
    case FP3_BENCH_SUB:
        z = x - y;
        break;
    case FP3_BENCH_MADD:
        z = fmaf(x, y, w);
        break;
    case FP3_BENCH_MSUB:
        z = fmaf(-x, y, w);
        break;
    default:
        z = x * y;
        break;
    }
    /* 754 leaves open whether infinity times zero is invalid if a quiet NaN is added. Ours is. */
    if (op >= FP3_BENCH_MADD && ((isinf(x) && y == 0) || (x == 0 && isinf(y))))
        feraiseexcept(FE_INVALID);
    const int raised = fetestexcept(FE_ALL_EXCEPT);
    *flags = (uint8_t)(!!(raised & FE_INVALID) << 4 | !!(raised & FE_DIVBYZERO) << 3 |
                       !!(raised & FE_OVERFLOW) << 2 | !!(raised & FE_UNDERFLOW) << 1 |
                       !!(raised & FE_INEXACT));
    const float result = z;
    return result != result ? QUIET_NAN : fp3_bits_of(result);
}

/* NULL if this host computes as the cores should, otherwise what it does differently. */
static const char *host_differs(void) {
    static const struct {
        uint32_t a, b, z;
        uint8_t flags;
        const char *why;
    } checks[] = {
        {0x3f800001, 0x3f800001, 0x3f800002, 0x01, "it does not round to nearest"},
        {0x00000001, 0x3f800000, 0x00000001, 0x00, "it flushes subnormal numbers"},
        {0x00800000, 0x3f000000, 0x00400000, 0x00, "it flushes subnormal results"},
        {0x00000001, 0x3f000000, 0x00000000, 0x03, "it does not report underflow"},
        /* 2^-126 (1 - 2^-46): below the smallest normal number, but not once it is rounded */
        {0x3f800001, 0x007fffff, 0x00800000, 0x01, "it detects tininess before rounding"},
        {0x7f800001, 0x3f800000, QUIET_NAN, 0x10, "a signalling NaN is not invalid"},
    };
    if (FLT_EVAL_METHOD != 0)
        return "it evaluates float in a wider format";
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
        uint8_t flags;
        if (host(FP3_BENCH_MUL, checks[i].a, checks[i].b, 0, &flags) != checks[i].z ||
            flags != checks[i].flags)
            return checks[i].why;
    }
    return NULL;
}

static bool wanted(const test *t, unsigned row, fp3_bench_op op) {
    return t->opt->row == FP3_ALL ? fp3_row_is_new(t->bench, row, op) : t->opt->row == (int)row;
}

/* Expected results, then the batch through every row that is asked for. */
static uint64_t flush(test *t, fp3_bench_op op) {
    fp3_batch *batch = &t->batch;
    uint64_t wrong = 0;
    for (size_t i = 0; i < batch->n; i++) {
        batch->z[i] = host(op, batch->a[i], batch->b[i], batch->c[i], &batch->flags[i]);
        for (int f = 0; f < 5; f++)
            t->raised[f] += batch->flags[i] >> f & 1;
    }
    for (unsigned row = FP3_BENCH_BINARY32; row < fp3_bench_rows(t->bench); row++)
        if (wanted(t, row, op))
            wrong += fp3_check(t->bench, row, op, batch, t->opt->program, &t->reported);
    batch->n = 0;
    return wrong;
}

static uint64_t put(test *t, fp3_bench_op op, uint32_t a, uint32_t b, uint32_t c) {
    t->batch.a[t->batch.n] = a;
    t->batch.b[t->batch.n] = b;
    t->batch.c[t->batch.n] = c;
    return ++t->batch.n == FP3_BATCH ? flush(t, op) : 0;
}

/* Exponents and fractions at which something changes, all combinations, both signs. */
static size_t special_values(uint32_t *values) {
    static const uint32_t exponents[] = {0,   1,   2,   22,  23,  24,  25,  103, 104, 126,
                                         127, 128, 150, 151, 229, 230, 252, 253, 254, 255};
    static const uint32_t fractions[] = {0, 1, 2, 0x3fffff, 0x400000, 0x400001, 0x7ffffe, 0x7fffff};
    size_t n = 0;
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
        for (size_t f = 0; f < sizeof fractions / sizeof *fractions; f++)
            for (uint32_t sign = 0; sign < 2; sign++)
                values[n++] = sign << 31 | exponents[e] << 23 | fractions[f];
    return n;
}

/* Every pair of special values. Of multiply-add there are 32,768,000 triples: all of them are in a
 * long run only. */
static uint64_t put_special(test *t, fp3_bench_op op, size_t *count) {
    enum { LONG = 10000000 };
    const size_t step = op < FP3_BENCH_MADD || t->opt->pairs >= LONG ? 1 : 31;
    const size_t third = t->opt->pairs >= LONG ? 1 : 3;
    uint32_t values[1024];
    const size_t n = special_values(values);
    uint64_t wrong = 0;
    *count = 0;
    for (size_t i = 0; i < n * n; i += step)
        for (size_t k = op < FP3_BENCH_MADD ? n - 1 : i % third; k < n; k += third, ++*count)
            wrong += put(t, op, values[i / n], values[i % n], values[k]);
    return wrong;
}

static uint64_t run_op(test *t, fp3_bench_op op) {
    uint64_t wrong = 0;
    size_t special;

    memset(t->raised, 0, sizeof t->raised);
    t->reported = 0;
    wrong += put_special(t, op, &special);

    gsl_rng *rng = gsl_rng_alloc(FP3_PAIRS_RNG);
    if (!rng)
        abort();
    gsl_rng_set(rng, t->opt->seed + (unsigned long)op);
    for (uint64_t i = 0; i < t->opt->pairs; i++) {
        uint32_t a, b;
        fp3_pair(rng, 8, 23, op, &a, &b);
        wrong += put(t, op, a, b, op < FP3_BENCH_MADD ? 0 : fp3_third(rng, 8, 23, a, b));
    }
    gsl_rng_free(rng);
    wrong += flush(t, op);

    printf("%s: %zu special and %" PRIu64 " random pairs (NV %" PRIu64 ", OF %" PRIu64
           ", UF %" PRIu64 ", NX %" PRIu64 ") through",
           fp3_op_names[op], special, t->opt->pairs, t->raised[4], t->raised[2], t->raised[1],
           t->raised[0]);
    for (unsigned row = FP3_BENCH_BINARY32; row < fp3_bench_rows(t->bench); row++)
        if (wanted(t, row, op))
            printf(" [%s, cuts 0x%x]", fp3_row_name(row),
                   fp3_bench_describe(t->bench, row, op).cuts);
    printf(": %" PRIu64 " mismatches\n", wrong);
    if (wrong)
        printf("  all again: %s --op %s --seed %lu --pairs %" PRIu64 "\n", t->opt->program,
               fp3_op_names[op], t->opt->seed, t->opt->pairs);
    return wrong;
}

static uint64_t run_one(test *t, fp3_bench_op op) {
    put(t, op, t->opt->a, t->opt->b, t->opt->c);
    const uint64_t wrong = flush(t, op);
    fp3_print_result(wrong ? "expected" : "as expected", t->batch.z[0], t->batch.flags[0]);
    return wrong;
}

int main(int argc, char **argv) {
    const fp3_fp_options opt =
        fp3_parse(argc, argv, "Tests the binary32 cores against this machine's FPU.", 10000000);
    const char *why = host_differs();
    if (why) {
        fprintf(stderr, "fp_host: this host cannot be the reference: %s\n", why);
        return NO_REFERENCE;
    }
    fp3_bench *bench = fp3_bench_open();
    if (!bench) {
        fprintf(stderr, "fp_host: no memory\n");
        return 1;
    }
    const int rows = (int)fp3_bench_rows(bench);
    if (opt.row != FP3_ALL && (opt.row < FP3_BENCH_BINARY32 || opt.row >= rows)) {
        fprintf(stderr, "fp_host: the binary32 rows are %d .. %d\n", FP3_BENCH_BINARY32, rows - 1);
        fp3_bench_close(bench);
        return 2;
    }

    test t = {.opt = &opt, .bench = bench};
    uint64_t wrong = 0;
    printf("seed %lu\n", opt.seed);
    for (int op = 0; op < FP3_BENCH_OPS; op++)
        if (opt.op == FP3_ALL || opt.op == op)
            wrong += opt.one ? run_one(&t, (fp3_bench_op)op) : run_op(&t, (fp3_bench_op)op);
    fp3_bench_close(bench);
    return wrong != 0;
}
