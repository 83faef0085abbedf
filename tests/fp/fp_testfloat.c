/* fp_testfloat - the binary32 cores against test vectors in the format of Berkeley TestFloat.
 *
 *     testfloat_gen -rnear_even -tininessafter -level 1 f32_add | build/tests/fp_testfloat --op add
 *
 * A line is "A B Z flags" in hexadecimal, of madd (f32_mulAdd) "A B C Z flags"; the flags are
 * invalid 16, divide by zero 8, overflow 4, underflow 2, inexact 1. Each vector goes through the
 * uncut core and every named set of cuts.
 */
#include "fp_common.h"

static uint64_t flush(const fp3_fp_options *opt, fp3_bench *bench, fp3_batch *t,
                      unsigned *reported) {
    uint64_t wrong = 0;
    for (unsigned row = FP3_BENCH_BINARY32; row < fp3_bench_rows(bench); row++)
        if (fp3_row_is_new(bench, row, (fp3_bench_op)opt->op))
            wrong +=
                fp3_check(bench, row, (fp3_bench_op)opt->op, t, "build/tests/fp_host", reported);
    t->n = 0;
    return wrong;
}

/* "A B Z flags", of f32_mulAdd "A B C Z flags", nothing else. */
static bool parse_line(const char *line, int operands, unsigned long field[5]) {
    char *end = (char *)(uintptr_t)line;
    for (int i = 0; i < operands + 2; i++) {
        const char *start = end;
        field[i] = strtoul(start, &end, 16);
        if (end == start || field[i] > (i <= operands ? 0xffffffff : 0x1f))
            return false;
    }
    return end[strspn(end, " \r\n")] == '\0';
}

int main(int argc, char **argv) {
    const fp3_fp_options opt =
        fp3_parse(argc, argv, "Tests the binary32 cores against vectors on stdin.", 0);
    if (opt.op == FP3_ALL || opt.op == FP3_BENCH_MSUB || opt.row != FP3_ALL || opt.one) {
        fprintf(stderr, "fp_testfloat: --op add, sub, mul or madd is needed, and nothing else\n");
        return 2;
    }
    fp3_bench *bench = fp3_bench_open();
    if (!bench) {
        fprintf(stderr, "fp_testfloat: no memory\n");
        return 1;
    }

    const int operands = opt.op == FP3_BENCH_MADD ? 3 : 2;
    char line[128];
    uint64_t vectors = 0, wrong = 0;
    unsigned reported = 0;
    bool readable = true;
    fp3_batch t = {.n = 0};
    while (fgets(line, sizeof line, stdin)) {
        unsigned long field[5];
        vectors++;
        readable = parse_line(line, operands, field);
        if (!readable) {
            fprintf(stderr, "fp_testfloat: line %" PRIu64 " is not '%s Z flags': %s\n", vectors,
                    operands == 3 ? "A B C" : "A B", line);
            break;
        }
        t.a[t.n] = (uint32_t)field[0];
        t.b[t.n] = (uint32_t)field[1];
        t.c[t.n] = operands == 3 ? (uint32_t)field[2] : 0;
        t.z[t.n] = (uint32_t)field[operands];
        t.flags[t.n] = (uint8_t)field[operands + 1];
        if (++t.n == FP3_BATCH)
            wrong += flush(&opt, bench, &t, &reported);
    }
    wrong += flush(&opt, bench, &t, &reported);
    printf("%s: %" PRIu64 " vectors, %" PRIu64 " mismatches\n", fp3_op_names[opt.op], vectors,
           wrong);
    if (vectors == 0)
        fprintf(stderr, "fp_testfloat: no vectors\n");
    fp3_bench_close(bench);
    return wrong != 0 || !readable || vectors == 0;
}
