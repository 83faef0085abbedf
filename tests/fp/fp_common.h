/* fp_common.h - what the tests of the floating-point cores share: operations, rows, reports. */
#ifndef FP3_TESTS_FP_COMMON_H
#define FP3_TESTS_FP_COMMON_H

#include <argp.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fp_bench.h"

enum { FP3_BATCH = 4096, FP3_REPORTS = 10, FP3_ALL = -1 };

static const char *const fp3_op_names[] = {"add", "sub", "mul", "madd", "msub"};

/* An operation's number, -1 for an unknown name. */
static inline int fp3_op_of(const char *name) {
    for (int op = 0; op < FP3_BENCH_OPS; op++)
        if (strcmp(name, fp3_op_names[op]) == 0)
            return op;
    return -1;
}

/* The command line of every test of the cores. */
typedef struct {
    unsigned long seed;
    uint64_t pairs; /* random pairs for each operation */
    int op, row;    /* FP3_ALL, or the only one */
    bool one;       /* only the operands a, b, c */
    uint32_t a, b, c;
    const char *program;
} fp3_fp_options;

static inline uint64_t fp3_number(const char *text, uint64_t most, struct argp_state *state) {
    char *end;
    const uint64_t value = strtoull(text, &end, 0);
    if (end == text || *end || *text == '-' || value > most)
        argp_error(state, "'%s' is not a number in 0 .. %" PRIu64, text, most);
    return value;
}

static inline error_t fp3_option(int key, char *arg, struct argp_state *state) {
    fp3_fp_options *opt = state->input;
    switch (key) {
    case 's':
        opt->seed = fp3_number(arg, UINT32_MAX, state);
        return 0;
    case 'n':
        opt->pairs = fp3_number(arg, UINT64_MAX, state);
        return 0;
    case 'r':
        opt->row = (int)fp3_number(arg, 99, state);
        return 0;
    case 'a':
        opt->a = (uint32_t)fp3_number(arg, UINT32_MAX, state);
        opt->one = true;
        return 0;
    case 'b':
        opt->b = (uint32_t)fp3_number(arg, UINT32_MAX, state);
        opt->one = true;
        return 0;
    case 'c':
        opt->c = (uint32_t)fp3_number(arg, UINT32_MAX, state);
        return 0;
    case 'o':
        opt->op = fp3_op_of(arg);
        if (opt->op < 0)
            argp_error(state, "'%s' is not add, sub, mul, madd or msub", arg);
        return 0;
    case ARGP_KEY_END:
        if (opt->one && (opt->op == FP3_ALL || opt->row == FP3_ALL))
            argp_error(state, "one pair needs --row, --op, --a and --b");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Exits on a wrong command line. */
static inline fp3_fp_options fp3_parse(int argc, char **argv, const char *doc, uint64_t pairs) {
    static const struct argp_option table[] = {
        {"op", 'o', "NAME", 0, "Only add, sub, mul, madd (c + a * b) or msub (c - a * b)", 0},
        {"row", 'r', "N", 0, "Only this row of tests/fp/fp_bench.v", 0},
        {"seed", 's', "N", 0, "Seed of the random pairs (1)", 0},
        {"pairs", 'n', "N", 0, "Random pairs for each operation", 0},
        {"a", 'a', "BITS", 0, "Replay one pair: first operand", 0},
        {"b", 'b', "BITS", 0, "Replay one pair: second operand", 0},
        {"c", 'c', "BITS", 0, "Replay one pair: third operand, of madd and msub (0)", 0},
        {0}};
    const struct argp argp = {table, fp3_option, NULL, doc, NULL, NULL, NULL};
    fp3_fp_options opt = {
        .seed = 1, .pairs = pairs, .op = FP3_ALL, .row = FP3_ALL, .program = argv[0]};
    argp_parse(&argp, argc, argv, 0, NULL, &opt);
    return opt;
}

/* One batch of operands, what is expected, and what a core gave. */
typedef struct {
    size_t n;
    uint32_t a[FP3_BATCH], b[FP3_BATCH], c[FP3_BATCH], z[FP3_BATCH], got_z[FP3_BATCH];
    uint8_t flags[FP3_BATCH], got_flags[FP3_BATCH];
} fp3_batch;

static inline const char *fp3_row_name(unsigned row) {
    static const char *const rows[] = {
        "8-bit, flushed, truncated", "8-bit, flushed, nearest", "8-bit, gradual, truncated",
        "8-bit, gradual, nearest",   "8-bit, Cell's",           "binary16",
        "binary32, Cell's",          "binary32, uncut",
    };
    return row < FP3_BENCH_CUT ? rows[row] : "binary32, cut";
}

/* Whether a binary32 row is the first with its cuts; the others would repeat its work. */
static inline bool fp3_row_is_new(const fp3_bench *bench, unsigned row, fp3_bench_op op) {
    for (unsigned r = FP3_BENCH_BINARY32; r < row; r++)
        if (fp3_bench_describe(bench, r, op).cuts == fp3_bench_describe(bench, row, op).cuts)
            return false;
    return true;
}

static inline void fp3_print_result(const char *what, uint32_t z, unsigned flags) {
    static const char *const names[] = {"NX", "UF", "OF", "DZ", "NV"};
    printf("  %-8s 0x%08" PRIx32 "  flags", what, z);
    for (int i = 4; i >= 0; i--)
        if (flags >> i & 1)
            printf(" %s", names[i]);
    printf(flags ? "\n" : " none\n");
}

/* Runs a batch through one row. Returns the number of mismatches; the first FP3_REPORTS that
 * *reported has not counted yet are printed, each with a line that replays it. */
static inline uint64_t fp3_check(fp3_bench *bench, unsigned row, fp3_bench_op op, fp3_batch *t,
                                 const char *program, unsigned *reported) {
    uint64_t wrong = 0;
    fp3_bench_run(bench, row, op, t->n, t->a, t->b, t->c, t->got_z, t->got_flags);
    if (memcmp(t->z, t->got_z, t->n * sizeof *t->z) == 0 &&
        memcmp(t->flags, t->got_flags, t->n) == 0)
        return 0;
    for (size_t i = 0; i < t->n; i++) {
        if (t->z[i] == t->got_z[i] && t->flags[i] == t->got_flags[i])
            continue;
        wrong++;
        if ((*reported)++ >= FP3_REPORTS)
            continue;
        printf("FAIL %s 0x%08" PRIx32 " 0x%08" PRIx32 " 0x%08" PRIx32 "  (%s, cuts 0x%x)\n",
               fp3_op_names[op], t->a[i], t->b[i], t->c[i], fp3_row_name(row),
               fp3_bench_describe(bench, row, op).cuts);
        fp3_print_result("expected", t->z[i], t->flags[i]);
        fp3_print_result("got", t->got_z[i], t->got_flags[i]);
        printf("  replay:  %s --row %u --op %s --a 0x%" PRIx32 " --b 0x%" PRIx32 " --c 0x%" PRIx32
               "\n",
               program, row, fp3_op_names[op], t->a[i], t->b[i], t->c[i]);
    }
    return wrong;
}

#endif
