/* SPDX-License-Identifier: Apache-2.0 */
/* occupancy.c - where the cycles of a run went, as text. */
#include <fp3/trace.h>

#include <inttypes.h>
#include <string.h>

#define BAR 40 /* characters for all cycles */

/* A counter that is a share of the cycles: one of those that add up to them, and to `paired`. */
static int is_share(int counter) {
    return fp3_counter_is_stall((fp3_counter)counter) ||
           strncmp(fp3_counter_name((fp3_counter)counter), "issued_", 7) == 0;
}

static uint32_t tenths_of(uint64_t count, uint64_t cycles) {
    return (uint32_t)(1000.0 * (double)count / (double)cycles + 0.5);
}

/* Tenths of a per cent, rounded so that they add up to 1000 and those of `paired`: each down, and
 * what is then missing goes to those that lost most. */
static void round_shares(const uint64_t *counter, uint64_t cycles, uint32_t *tenths) {
    double lost[FP3_COUNTER_COUNT] = {0};
    uint32_t left = 1000 + tenths_of(counter[FP3_COUNTER_PAIRED], cycles);
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        const double share = is_share(i) ? 1000.0 * (double)counter[i] / (double)cycles : 0.0;
        tenths[i] = (uint32_t)share;
        lost[i] = share - tenths[i];
        left -= tenths[i] < left ? tenths[i] : left;
    }
    for (; left > 0 && left <= FP3_COUNTER_COUNT; left--) {
        int most = 0;
        for (int i = 1; i < FP3_COUNTER_COUNT; i++)
            if (lost[i] > lost[most])
                most = i;
        tenths[most]++;
        lost[most] = -1.0;
    }
}

/* " issued_add                 1200   30.0  ############". */
static void print_row(FILE *out, const char *name, uint64_t cycles, uint32_t tenths) {
    char bar[BAR + 1] = "";
    memset(bar, '#', ((tenths < 1000 ? tenths : 1000) * BAR + 500) / 1000);
    fprintf(out, "  %-18s %12" PRIu64 "  %3" PRIu32 ".%" PRIu32 " %%%s%s\n", name, cycles,
            tenths / 10, tenths % 10, *bar ? "  " : "", bar);
}

static void print_unit(FILE *out, const char *name, uint64_t used, uint64_t cycles) {
    print_row(out, name, used, tenths_of(used, cycles));
}

void fp3_occupancy_print(FILE *out, uint32_t scheduler, const uint64_t *counter) {
    const uint64_t cycles = counter[FP3_COUNTER_CYCLES];
    fprintf(out, "occupancy of scheduler %" PRIu32 "\n", scheduler);
    if (cycles == 0) {
        print_row(out, "cycles", 0, 0);
        return;
    }
    uint32_t tenths[FP3_COUNTER_COUNT];
    round_shares(counter, cycles, tenths);
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (is_share(i) && counter[i])
            print_row(out, fp3_counter_name((fp3_counter)i), counter[i], tenths[i]);
    if (counter[FP3_COUNTER_PAIRED]) /* cycles that are in two of the rows above */
        print_unit(out, "less paired", counter[FP3_COUNTER_PAIRED], cycles);
    fprintf(out, "  %-18s %12" PRIu64 "  100.0 %%\n", "cycles", cycles);
    print_unit(out, "adder in use",
               counter[FP3_COUNTER_ISSUED_ADD] + counter[FP3_COUNTER_ISSUED_CHAIN], cycles);
    print_unit(out, "multiplier in use",
               counter[FP3_COUNTER_ISSUED_MUL] + counter[FP3_COUNTER_ISSUED_CHAIN], cycles);
}
