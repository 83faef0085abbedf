/* simulated.c - the program of examples/litex on the simulated hardware, without a SoC around it.
 *
 *     simulated LIBRARY well | deaf | gone | BROKEN [IMAGE ADDRESS BYTES]
 *
 * deaf: no interrupt comes; gone: nothing is behind the bus, which reads as ones; BROKEN: the
 * number of a transfer that is answered with an error, from 1 on. Their number goes to stderr.
 * IMAGE: what a memory of so many bytes has from ADDRESS on. ship.h and memory_data.h are made by
 * the test.
 */
#include "machine.h"

#include "fp3_rtl.h"
#include <dlfcn.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PAUSE 200 /* cycles */

static struct {
    const fp3_rtl_ops *ops;
    fp3_rtl *rtl;
    uint32_t *memory;
    int is_deaf, is_gone;
    uint64_t transfers, broken_at;
} board;

static int transfer(int is_write, uint32_t address, uint32_t *word) {
    if (!is_write && board.is_gone)
        *word = UINT32_MAX;
    if (++board.transfers == board.broken_at)
        return 1;
    return !board.is_gone && fp3_rtl_transfer_one(board.ops, board.rtl, is_write, address, word);
}

static int read_word(void *user, uint32_t address, uint32_t *word) {
    (void)user;
    return transfer(0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    (void)user;
    return transfer(1, address, &word);
}

const fp3_bare_bus machine_bus = {read_word, write_word, NULL};

volatile uint32_t *machine_memory(uint32_t address) { return board.memory + address / 4; }

void machine_forget(void) {}

uint64_t machine_cycles(void) { return board.ops->now(board.rtl); }

void machine_print(const char *text) { fputs(text, stdout); }

/* The wire is high while the register has both bits. A look at it keeps transfers waiting, so there
 * are some cycles from one to the next. */
int machine_wait(int (*is_over)(void), uint32_t cycles) {
    const uint32_t both = 1u << FP3_INTERRUPT_ENABLE_LO | 1u << FP3_INTERRUPT_ENDED_LO;
    const uint64_t end = board.ops->now(board.rtl) + cycles;
    while (!is_over() && board.ops->now(board.rtl) < end) {
        uint32_t word = 0;
        board.ops->clock(board.rtl, PAUSE, PAUSE);
        if (fp3_rtl_transfer_one(board.ops, board.rtl, 0, FP3_ADDR_INTERRUPT, &word))
            break;
        if ((word & both) == both && !board.is_deaf)
            program_interrupt();
    }
    return is_over();
}

/* Returns 0 if it is not there. */
static int open_memory(const char *image, uint32_t address, uint32_t bytes) {
    const fp3_rtl_memory shape = {bytes / 4, 1000, 20};
    FILE *file = fopen(image, "rb");
    board.memory = file ? board.ops->memory(board.rtl, &shape) : NULL;
    const size_t words =
        board.memory ? fread(board.memory + address / 4, 4, (bytes - address) / 4, file) : 0;
    if (file)
        fclose(file);
    return words > 0;
}

int main(int argc, char **argv) {
    void *library = argc == 3 || argc == 6 ? dlopen(argv[1], RTLD_NOW) : NULL;
    board.ops = library ? dlsym(library, "fp3_rtl_table") : NULL;
    if (!board.ops)
        return 2;
    board.is_deaf = strcmp(argv[2], "deaf") == 0;
    board.is_gone = strcmp(argv[2], "gone") == 0;
    board.broken_at = strtoull(argv[2], NULL, 10);
    const fp3_rtl_watch watch = {NULL, NULL, NULL};
    board.rtl = board.ops->open(&watch, 0);
    if (!board.rtl || (argc == 6 && !open_memory(argv[3], (uint32_t)strtoul(argv[4], NULL, 10),
                                                 (uint32_t)strtoul(argv[5], NULL, 10))))
        return 2;
    const int status = program();
    board.ops->close(board.rtl);
    fprintf(stderr, "%" PRIu64 " transfers\n", board.transfers);
    return status;
}
