/* SPDX-License-Identifier: Apache-2.0 */
/* needs.c - see needs.h. */
#include "needs.h"

#include "operation.h"

#include <inttypes.h>

typedef struct {
    const char *what;
    uint32_t needs, has;
} row;

enum { REGISTERS, CONSTANTS, WORDS, ROWS };

static void find_rows(const fp3_needs *needs, const fp3_config *config, row rows[ROWS]) {
    rows[REGISTERS] = (row){"object registers", needs->registers, config->registers};
    rows[CONSTANTS] = (row){"shared constants", needs->constants, config->registers};
    rows[WORDS] = (row){needs->is_visited ? "words of instruction memory with its loads and stores"
                                          : "words of instruction memory",
                        needs->words, config->program_words};
}

/* Index of what is too few; ROWS: nothing. */
static int find_short(const fp3_needs *needs, const fp3_config *config) {
    row rows[ROWS];
    int i = 0;
    find_rows(needs, config, rows);
    while (i < ROWS && rows[i].needs <= rows[i].has)
        i++;
    return i;
}

static int has_operations(const fp3_needs *needs, const fp3_config *config) {
    for (unsigned i = 0; i < fp3_operation_count; i++)
        if (needs->operations >> i & 1 &&
            fp3_operation_lacks(config, fp3_operations[i].code) != FP3_KEY_NONE)
            return 0;
    return 1;
}

static uint32_t distance(const fp3_config *one, const fp3_config *other) {
    uint32_t changes = 0;
    for (uint32_t key = 0; key < FP3_KEYS_SET; key++)
        changes += fp3_config_value(one, (fp3_key)key) != fp3_config_value(other, (fp3_key)key);
    return changes;
}

static const fp3_config *find_nearest(const fp3_needs *needs, const fp3_config *config) {
    const fp3_config *best = NULL;
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        const fp3_config *other = &fp3_configs[i];
        if (other->interleave == config->interleave && fp3_config_computes_as(config, other) &&
            has_operations(needs, other) && find_short(needs, other) == ROWS &&
            (!best || distance(config, other) < distance(config, best)))
            best = other;
    }
    return best;
}

fp3_status fp3_needs_check(const fp3_needs *needs, const fp3_config *config, fp3_error *error) {
    const int i = find_short(needs, config);
    row here[ROWS], there[ROWS];
    if (i == ROWS)
        return FP3_OK;
    const fp3_config *other = find_nearest(needs, config);
    find_rows(needs, config, here);
    if (!other)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "the program needs %" PRIu32 " %s, configuration '%s' has %" PRIu32
                        "; none has enough%s",
                        here[i].needs, here[i].what, config->name, here[i].has,
                        i == WORDS ? " (fp3 run takes it with engine isa or fast)" : "");
    find_rows(needs, other, there);
    return fp3_fail(
        error, FP3_E_PROGRAM,
        "the program needs %" PRIu32 " %s, configuration '%s' has %" PRIu32 "; '%s' has %" PRIu32,
        here[i].needs, here[i].what, config->name, here[i].has, other->name, there[i].has);
}
