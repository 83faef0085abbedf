/* SPDX-License-Identifier: Apache-2.0 */
/* fold.c - see fold.h. */
#include "fold.h"

#include "machine/operation.h"

#include <fp3/isa.h>

/* The operation that computes the same with a neighbour's word as operand a (is_first) or b; 0:
 * none. */
static uint32_t folded(uint32_t op, fp3_gives gives, int is_first) {
    for (unsigned i = 0; i < fp3_operation_count; i++) {
        const fp3_operation *of = &fp3_operations[i];
        if (of->computes == op && of->gives == gives &&
            (of->is_first == is_first || fp3_operation_find(op)->commutes))
            return of->code;
    }
    return 0;
}

/* A load that is no longer needed has operation 0. */
static fp3_gives gives(const fp3_line *line) {
    return line->op ? fp3_operation_find(line->op)->gives : FP3_GIVES_NOTHING;
}

static uint32_t sources_of(const fp3_line *line) {
    return line->op ? fp3_operation_find(line->op)->sources : 0;
}

/* Whether the line reads it, as operand a or b or elsewhere. */
static int reads(const fp3_line *line, uint32_t reg, int *a, int *b) {
    if (line->op && fp3_operation_find(line->op)->takes_field) {
        *a = *b = 0;
        return line->d == reg;
    }
    const uint32_t sources = sources_of(line);
    *a = sources > 0 && line->operand[0] == reg;
    *b = sources > 1 && line->operand[1] == reg;
    return *a || *b || (sources > 2 && line->operand[2] == reg);
}

/* The next line from `at` on that reads what this load gives, or count. */
static uint32_t next_use(const fp3_line *lines, uint32_t count, uint32_t load, uint32_t at) {
    int a, b;
    for (; at < count; at++) {
        if (reads(&lines[at], lines[load].d, &a, &b))
            return at;
        if (lines[at].d == lines[load].d)
            break; /* another value from here on */
    }
    return count;
}

static uint32_t after(const fp3_line *lines, uint32_t count, uint32_t load, uint32_t use) {
    return lines[use].d == lines[load].d ? count : use + 1;
}

/* Whether all that read it can have it as an operand. */
static int can_fold(const fp3_line *lines, uint32_t count, uint32_t load) {
    const uint32_t reg = lines[load].d;
    int a, b;
    for (uint32_t use = next_use(lines, count, load, load + 1); use < count;
         use = next_use(lines, count, load, after(lines, count, load, use)))
        if (!reads(&lines[use], reg, &a, &b) || a == b ||
            !folded(lines[use].op, gives(&lines[load]), a))
            return 0;
    return 1;
}

static void fold(fp3_line *lines, uint32_t count, uint32_t load, uint32_t number) {
    const uint32_t reg = lines[load].d;
    const fp3_gives kind = gives(&lines[load]);
    int a, b;
    for (uint32_t use = next_use(lines, count, load, load + 1); use < count;) {
        fp3_line *line = &lines[use];
        use = next_use(lines, count, load, after(lines, count, load, use));
        reads(line, reg, &a, &b);
        line->op = folded(line->op, kind, a);
        line->operand[0] = line->operand[a];
        line->operand[1] = number;
    }
    lines[load].op = 0;
}

uint32_t fp3_phases_fold(fp3_line *lines, uint32_t count) {
    uint32_t loads = 0, fields = 0, left = 0;
    for (; loads < count && gives(&lines[loads]) != FP3_GIVES_NOTHING; loads++)
        fields += lines[loads].op == FP3_OP_LDL;
    for (uint32_t i = 0; i < loads - fields; i++)
        if (can_fold(lines, count, i))
            fold(lines, count, i, lines[i].operand[0]);
    /* Fields that are still loaded must be the first fields. The last field is read, so that the
     * entry has its full length. */
    for (uint32_t number = fields; number-- > 0;) {
        const uint32_t load = loads - fields + number;
        const int is_read = next_use(lines, count, load, load + 1) < count;
        if (!can_fold(lines, count, load) || (!is_read && number == fields - 1))
            break;
        fold(lines, count, load, number);
    }
    for (uint32_t i = 0; i < count; i++)
        if (lines[i].op)
            lines[left++] = lines[i];
    return left;
}
