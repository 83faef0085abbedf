/* pictures.c - a host, fp3_pictures and a processor, by lines from standard input.
 *
 *     pictures LIBRARY SEED     the simulated hardware of a configuration
 *     pictures memory SEED      64 Ki words instead, which can be set, and refuse
 *
 *     w ADDRESS WORD     the host writes: prints ok or refused
 *     r ADDRESS          the host reads: prints the word, or refused
 *     go CYCLES
 *     frame FILE PIXELS  prints the cycles of a pixel; see pictures.h
 *     set NAME           the host loads a scene of scenes.c
 *     run STEPS          and runs it
 *     m ADDRESS WORD     a word of the memory
 *     x ADDRESS          the memory refuses this address from now on
 *
 * Addresses and words are in hexadecimal digits, all other numbers are decimal. scenes_data.h is
 * made by the test. */
#include "scenes.c"

#include "fp3_rtl.h"
#include "pictures.h"
#include <dlfcn.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(what)                                                                               \
    do {                                                                                           \
        if (!(what)) {                                                                             \
            fprintf(stderr, "line %d: not so: %s\n", __LINE__, #what);                             \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define WORDS (1u << 16)
#define LATENCY 9 /* of the memory */

static pictures *chip;

/* ---- processors ---- */

static uint32_t memory[WORDS];
static unsigned char refuses[WORDS];

static int memory_access(int is_write, uint32_t address, uint32_t *data, uint64_t *cycles) {
    *cycles = is_write ? 1 : LATENCY;
    if (address % 4 || address / 4 >= WORDS || refuses[address / 4])
        return 1;
    if (is_write)
        memory[address / 4] = *data;
    else
        *data = memory[address / 4];
    return 0;
}

static void memory_rest(void) {}

static const fp3_rtl_ops *ops;
static fp3_rtl *rtl;
static int is_running;

/* A processor without a run is not clocked: nothing changes in it. */
static int rtl_access(int is_write, uint32_t address, uint32_t *data, uint64_t *cycles) {
    const uint64_t from = ops->now(rtl);
    const int refused = fp3_rtl_transfer_one(ops, rtl, is_write, address, data);
    EXPECT(refused >= 0);
    is_running = is_running || (is_write && address == FP3_ADDR_CONTROL);
    if (!is_write && address == FP3_ADDR_STATUS && !refused)
        is_running = *data >> FP3_STATUS_RUNNING_LO & 1;
    *cycles = ops->now(rtl) - from;
    return refused;
}

static void rtl_rest(void) {
    if (is_running)
        ops->clock(rtl, 1, 2);
}

/* ---- the host ---- */

static int read_word(void *user, uint32_t address, uint32_t *word) {
    (void)user;
    return pictures_access(chip, 0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    (void)user;
    return pictures_access(chip, 1, address, &word);
}

const fp3_bare_bus machine_bus = {read_word, write_word, NULL};

void machine_print(const char *text) { fputs(text, stdout); }

static const scene *scene_of(const char *name) {
    for (uint32_t i = 0; i < COUNT(scenes); i++)
        if (strcmp(scenes[i].name, name) == 0)
            return &scenes[i];
    fprintf(stderr, "there is no scene %s\n", name);
    exit(1);
}

static void access_word(int is_write, uint32_t address, uint32_t word) {
    const int refused = pictures_access(chip, is_write, address, &word);
    EXPECT(refused >= 0);
    if (refused)
        puts("refused");
    else if (is_write)
        puts("ok");
    else
        printf("%08" PRIx32 "\n", word);
}

static void write_frame(const char *name, uint64_t pixels) {
    FILE *to = fopen(name, "wb");
    EXPECT(to);
    printf("%" PRIu64 "\n", pictures_frame(chip, to, pixels));
    EXPECT(fclose(to) == 0);
}

static void obey(char *line) {
    const char *what = strtok(line, " \n");
    char *first = strtok(NULL, " \n"), *second = strtok(NULL, " \n");
    EXPECT(what && first);
    const uint32_t at = (uint32_t)strtoul(first, NULL, 16);
    const uint32_t word = second ? (uint32_t)strtoul(second, NULL, 16) : 0;
    if (strcmp(what, "w") == 0) {
        access_word(1, at, word);
    } else if (strcmp(what, "r") == 0) {
        access_word(0, at, 0);
    } else if (strcmp(what, "go") == 0) {
        pictures_clock(chip, strtoull(first, NULL, 10));
    } else if (strcmp(what, "frame") == 0) {
        EXPECT(second);
        write_frame(first, strtoull(second, NULL, 10));
    } else if (strcmp(what, "set") == 0) {
        EXPECT(!fp3_bare_open(&fp3, &machine_bus) && !set(scene_of(first)));
    } else if (strcmp(what, "run") == 0) {
        EXPECT(!run((uint32_t)strtoul(first, NULL, 10)));
    } else if (strcmp(what, "m") == 0) {
        memory[at / 4 % WORDS] = word;
    } else {
        EXPECT(strcmp(what, "x") == 0);
        refuses[at / 4 % WORDS] = 1;
    }
}

int main(int argc, char **argv) {
    char line[4096];
    EXPECT(argc == 3);
    pictures_processor processor = {memory_access, memory_rest};
    if (strcmp(argv[1], "memory") != 0) {
        const fp3_rtl_watch watch = {NULL, NULL, NULL};
        void *library = dlopen(argv[1], RTLD_NOW);
        ops = library ? dlsym(library, "fp3_rtl_table") : NULL;
        EXPECT(ops && (rtl = ops->open(&watch, 0)));
        processor = (pictures_processor){rtl_access, rtl_rest};
    }
    chip = pictures_open(&processor, strtoull(argv[2], NULL, 10));
    while (fgets(line, sizeof line, stdin))
        obey(line);
    pictures_close(chip);
    if (rtl)
        ops->close(rtl);
    return 0;
}
