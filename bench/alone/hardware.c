/* SPDX-License-Identifier: Apache-2.0 */
/* hardware.c - see hardware.h. */
#include "hardware.h"

static int read_word(void *user, uint32_t address, uint32_t *word) {
    alone *a = user;
    a->accesses += address != FP3_ADDR_TRANSFER_STATUS;
    return fp3_rtl_transfer_one(a->hardware.ops, a->rtl, 0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    alone *a = user;
    a->accesses++;
    return fp3_rtl_transfer_one(a->hardware.ops, a->rtl, 1, address, &word);
}

void alone_open(alone *a, const char *config, const fp3_rtl_memory *shape, uint64_t waits) {
    const fp3_rtl_watch watch = {NULL, NULL, NULL};
    const fp3_bare_bus bus = {read_word, write_word, a};
    fp3_error error;
    *a = (alone){.shape = *shape};
    if (fp3_hardware_load(config, &a->hardware, &error)) {
        fprintf(stderr, "alone: %s\n", error.text);
        exit(1);
    }
    NEED(a->rtl = a->hardware.ops->open(&watch, waits));
    if (shape->words)
        NEED(a->memory = a->hardware.ops->memory(a->rtl, shape));
    NEED(!fp3_bare_open(&a->fp3, &bus));
}

void alone_close(alone *a) {
    a->hardware.ops->close(a->rtl);
    fp3_hardware_unload(&a->hardware);
}

uint64_t alone_now(const alone *a) { return a->hardware.ops->now(a->rtl); }

void alone_move(alone *a, fp3_bare_direction direction, uint32_t lane, uint32_t row, uint32_t rows,
                uint32_t memory) {
    fp3_bare_moved how;
    NEED(!fp3_bare_move_rows(&a->fp3, direction, 0, lane, row, rows, memory));
    NEED(!fp3_bare_move_wait(&a->fp3, POLLS, &how) && how == FP3_BARE_MOVED);
}
