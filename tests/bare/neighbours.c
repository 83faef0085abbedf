/* neighbours.c - fp3_bare_neighbours.h on the whole simulated hardware of configuration `world`.
 *
 *     neighbours LIBRARY SEED words SKIN CELLS
 *         prints all states of scenes.c's scenes, of the balls with this skin (bits) and so many
 *         cells, and how many lists were made
 *     neighbours LIBRARY SEED program     prints what the program prints
 *     neighbours LIBRARY 0 ends           every range to its end, and beyond
 *     neighbours LIBRARY 0 broken         each transfer fails once
 *
 * scenes_data.h is made by the test. */
#include "scenes.c"

#include "fp3_rtl.h"
#include <dlfcn.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(what)                                                                               \
    do {                                                                                           \
        if (!(what)) {                                                                             \
            fprintf(stderr, "line %d: not so: %s\n", __LINE__, #what);                             \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define CLOTH (&scenes[0])
#define STARS (&scenes[1])
#define BALLS (&scenes[2])

static struct {
    const fp3_rtl_ops *ops;
    fp3_rtl *rtl;
    uint64_t transfers, broken_at;
} board;

static int read_word(void *user, uint32_t address, uint32_t *word) {
    (void)user;
    return ++board.transfers == board.broken_at ||
           fp3_rtl_transfer_one(board.ops, board.rtl, 0, address, word);
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    (void)user;
    return ++board.transfers == board.broken_at ||
           fp3_rtl_transfer_one(board.ops, board.rtl, 1, address, &word);
}

const fp3_bare_bus machine_bus = {read_word, write_word, NULL};

void machine_print(const char *text) { fputs(text, stdout); }

static void print_words(uint32_t skin, uint32_t cells) {
    for (uint32_t i = 0; i < COUNT(scenes); i++) {
        const scene *s = &scenes[i];
        EXPECT(!set(s));
        if (around.near) {
            touch.skin = skin;
            touch.cells = cells;
            EXPECT(!fp3_bare_near_add(&around, &touch));
        }
        /* In two runs: published words begin in either half of the store. */
        EXPECT(!run(1) && !run(s->steps - 1));
        for (uint32_t k = 0; k < s->objects * s->state_count; k++) {
            uint32_t bits = 0;
            EXPECT(
                !fp3_bare_read(&fp3, 0, k / s->state_count, s->states[k % s->state_count], &bits));
            printf("%s %08" PRIx32 "\n", s->name, bits);
        }
    }
    printf("lists %" PRIu32 "\n", touch.lists);
}

/* ---- the ends of ranges ---- */

/* Of objects, lists and links; nothing that is refused costs a transfer. */
static void refuse_lists(void) {
    const uint32_t room = fp3.store / 2 >> stars_program.record;
    static fp3_bare_link links[4096];
    static uint32_t fields[2];
    const fp3_bare_link outside = {0, CLOTH_OBJECTS}, itself = {5, 5};
    fp3_bare_program p = stars_program;
    static uint32_t many[4096];
    EXPECT(!set(CLOTH));
    const uint64_t transfers = board.transfers;
    EXPECT(fp3_bare_links(&around, cloth_list_springs, links, 1, fields) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_start(&fp3, 0, 1, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_write(&fp3, 0, CLOTH_OBJECTS, 0, 0) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_list(&fp3, 0, CLOTH_OBJECTS - 1) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_neighbours_open(&around, &fp3, room + 1, many) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_neighbours_open(&around, &fp3, 1, NULL) == FP3_E_ARGUMENT);
    p.loads = 1;
    EXPECT(fp3_bare_load(&fp3, 0, &p) == FP3_E_PROGRAM);
    fp3.features_more &= ~(1u << FP3_FEATURES_MORE_NEIGHBOURS_LO);
    EXPECT(fp3_bare_load(&fp3, 0, &stars_program) == FP3_E_PROGRAM);
    fp3.features_more |= 1u << FP3_FEATURES_MORE_NEIGHBOURS_LO;
    EXPECT(board.transfers == transfers);
    EXPECT(!fp3_bare_neighbours_open(&around, &fp3, CLOTH_OBJECTS, next));
    EXPECT(fp3_bare_start(&fp3, 0, 1, 1, 0) == FP3_E_ARGUMENT); /* without its list */
    links[1] = outside;
    EXPECT(fp3_bare_links(&around, cloth_list_springs, links, 2, fields) == FP3_E_ARGUMENT);
    EXPECT(around.failed == 0); /* the first one, an object with itself */
    links[0] = (fp3_bare_link){0, 1};
    EXPECT(fp3_bare_links(&around, cloth_list_springs, links, 2, fields) == FP3_E_ARGUMENT);
    EXPECT(around.failed == 1);
    links[1] = itself;
    EXPECT(fp3_bare_links(&around, cloth_list_springs, links, 2, fields) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_links(&around, cloth_list_springs, links, 1, NULL) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_links(&around, cloth_list_springs, NULL, 1, fields) == FP3_E_ARGUMENT);
    EXPECT(fp3_bare_all(&around, cloth_list_springs) == FP3_E_ARGUMENT); /* it has fields */
    EXPECT(fp3_bare_links(&around, cloth_list_springs + 1, links, 1, fields) == FP3_E_ARGUMENT);
    /* As many objects as there is room for; all see all up to 120; the longest list. */
    EXPECT(!fp3_bare_load(&fp3, 0, &stars_program));
    EXPECT(!fp3_bare_neighbours_open(&around, &fp3, room, many));
    EXPECT(fp3_bare_all(&around, stars_list_others) == FP3_E_PROGRAM && around.failed == 0);
    EXPECT(!fp3_bare_neighbours_open(&around, &fp3, 120, many));
    EXPECT(!fp3_bare_all(&around, stars_list_others) && !fp3.missing);
    EXPECT(!fp3_bare_neighbours_open(&around, &fp3, 121, many));
    EXPECT(fp3_bare_all(&around, stars_list_others) == FP3_E_PROGRAM && around.failed == 120);
    /* What was refused has taken no room: a list that leaves little is given behind it. */
    for (uint32_t i = 0; i < 4096; i++)
        links[i] = (fp3_bare_link){i % 120, 120};
    EXPECT(!fp3_bare_links(&around, stars_list_others, links, 4095, NULL));
    for (uint32_t i = 0; i < 4096; i++)
        links[i] = (fp3_bare_link){0, 1};
    EXPECT(!fp3_bare_neighbours_open(&around, &fp3, 2, many));
    EXPECT(fp3_bare_links(&around, stars_list_others, links, 4096, NULL) == FP3_E_PROGRAM);
    EXPECT(around.failed == 0 && fp3.missing);
    EXPECT(!fp3_bare_links(&around, stars_list_others, links, 4095, NULL) && !fp3.missing);
}

static void refuse_near(void) {
    fp3_bare_near right, near;
    EXPECT(!set(BALLS));
    right = touch;
#define REFUSE(change)                                                                             \
    do {                                                                                           \
        near = right;                                                                              \
        change;                                                                                    \
        EXPECT(fp3_bare_near_add(&around, &near) == FP3_E_ARGUMENT);                               \
    } while (0)
    const uint64_t transfers = board.transfers;
    REFUSE(near.dimensions = 0);
    REFUSE(near.dimensions = 4);
    REFUSE(near.cells = 0);
    REFUSE(near.list++);
    REFUSE(near.made = NULL);
    REFUSE(near.order = NULL);
    REFUSE(near.first = NULL);
    REFUSE(near.position[1] = 1u << balls_program.record);
    REFUSE(near.reach = 0);
    REFUSE(near.reach = fp3_bare_bits(-0.1f));
    REFUSE(near.reach = fp3_bare_bits(0x1.fp-51f));
    REFUSE(near.reach = fp3_bare_bits(0x1p63f));
    REFUSE(near.reach = 0x7f800000u);
    REFUSE(near.skin = 0x7fc00000u);
    REFUSE(near.skin = fp3_bare_bits(-0.0f));
    REFUSE(near.skin = fp3_bare_bits(0x1p18f * 0.0625f)); /* the reach has the exponent of 2^-4 */
    EXPECT(fp3_bare_start(&fp3, 0, 1, 1, 0) == FP3_E_ARGUMENT); /* not without a look at them */
    EXPECT(board.transfers == transfers);
    near = right;
    near.skin = fp3_bare_bits(0x1.fffffep17f * 0.0625f);
    EXPECT(!fp3_bare_near_add(&around, &near));
    near.skin = 0;
    near.reach = fp3_bare_bits(0x1.fffffep62f);
    EXPECT(!fp3_bare_near_add(&around, &near));
    near.reach = fp3_bare_bits(0x1p-50f);
    EXPECT(!fp3_bare_near_add(&around, &near));
}

/* A ball where none can be; then the balls are set anew. */
static fp3_status put_ball(uint32_t ball, uint32_t bits) {
    EXPECT(!set(BALLS));
    EXPECT(!fp3_bare_write(&fp3, 0, ball, balls_state_x_y, bits));
    const fp3_status status = run(1);
    EXPECT(!status || (!around.near && run(1) == FP3_E_ARGUMENT));
    EXPECT(status != FP3_E_ARGUMENT);
    return status;
}

static void lose_balls(void) {
    EXPECT(put_ball(299, 0x7fc00000u) == FP3_E_FAILED && around.failed == 299);
    EXPECT(put_ball(0, 0xff800000u) == FP3_E_FAILED && around.failed == 0);
    EXPECT(put_ball(7, fp3_bare_bits(0x1p18f * 0.0625f)) == FP3_E_LIMIT && around.failed == 7);
    EXPECT(put_ball(7, fp3_bare_bits(-0x1p18f * 0.0625f)) == FP3_E_LIMIT && around.failed == 7);
    EXPECT(!put_ball(7, fp3_bare_bits(0x1.fffffep17f * 0.0625f)));
    EXPECT(!put_ball(7, fp3_bare_bits(-0x1.fffffep17f * 0.0625f)));
    /* Subnormal numbers and -0 are places. */
    EXPECT(!put_ball(7, 1) && !put_ball(7, 0x80000001u) && !put_ball(7, 0x80000000u));
    /* All at one place: 299 entries each are too many. */
    EXPECT(!set(BALLS));
    for (uint32_t i = 0; i < BALLS_OBJECTS; i++)
        for (uint32_t k = 0; k < 3; k++)
            EXPECT(!fp3_bare_write(&fp3, 0, i, touch.position[k], fp3_bare_bits(0.5f)));
    EXPECT(run(1) == FP3_E_PROGRAM && around.failed > 0 && around.failed < BALLS_OBJECTS);
    /* A phase that takes longer than one look. */
    fp3_bare_outcome outcome;
    EXPECT(!set(BALLS) && fp3_bare_near_run(&around, 1, 0, 1, &outcome) == FP3_E_LIMIT);
    EXPECT(outcome == FP3_BARE_RUNNING && !fp3_bare_wait(&fp3, 0, POLLS, &outcome));
    EXPECT(!set(BALLS) && fp3_bare_near_run(&around, 1, 0, 0, &outcome) == FP3_E_LIMIT);
    EXPECT(outcome == FP3_BARE_RUNNING && !fp3_bare_wait(&fp3, 0, POLLS, &outcome));
    EXPECT(!set(BALLS) &&
           fp3_bare_near_run(&around, 2, UINT32_MAX - 1, 1, &outcome) == FP3_E_ARGUMENT);
    /* Another program: these neighbours are of the one before. */
    EXPECT(!set(BALLS) && !fp3_bare_load(&fp3, 0, &cloth_program) && run(1) == FP3_E_ARGUMENT);
}

/* What objects publish is where it was, whatever the run of another program has left behind: after
 * a look without a run, and a run of no steps. */
static void stand_still(void) {
    const uint32_t reg = cloth_state_x_y;
    fp3_bare_outcome outcome = FP3_BARE_NONE;
    uint32_t bits = 0;
    EXPECT(!set(CLOTH) && !run(1) && fp3.half); /* one phase */
    EXPECT(!set(CLOTH) && !fp3_bare_poll(&fp3, 0, &outcome));
    EXPECT(!fp3_bare_read(&fp3, 0, 7, reg, &bits) && bits == fp3_bare_bits(2.0f));
    EXPECT(!run(0) && !fp3_bare_read(&fp3, 0, 7, reg, &bits) && bits == fp3_bare_bits(2.0f));
    EXPECT(!set(BALLS) && !run(0) && !touch.lists);
}

/* Whichever transfer fails: it is told. The balls are the first few, so that there are not many. */
static fp3_status run_few(void) {
    scene s = *BALLS;
    s.objects = 3;
    const fp3_status status = set(&s);
    return status ? status : run(2);
}

static void break_each_transfer(void) {
    board.transfers = board.broken_at = 0;
    EXPECT(!fp3_bare_open(&fp3, &machine_bus) && !run_few());
    const uint64_t last = board.transfers;
    EXPECT(last > 100);
    for (uint64_t at = 1; at <= last; at++) {
        fp3_bare_outcome outcome;
        board.transfers = 0;
        board.broken_at = at;
        fp3_status status = fp3_bare_open(&fp3, &machine_bus);
        if (!status)
            status = run_few();
        EXPECT(status == FP3_E_SYSTEM || board.transfers < at); /* it was one look less */
        board.broken_at = 0;
        EXPECT(!fp3_bare_open(&fp3, &machine_bus) && !fp3_bare_wait(&fp3, 0, POLLS, &outcome));
    }
}

int main(int argc, char **argv) {
    EXPECT(argc >= 4);
    void *library = dlopen(argv[1], RTLD_NOW);
    board.ops = library ? dlsym(library, "fp3_rtl_table") : NULL;
    EXPECT(board.ops);
    const fp3_rtl_watch watch = {NULL, NULL, NULL};
    EXPECT(board.rtl = board.ops->open(&watch, strtoull(argv[2], NULL, 10)));
    int status = 0;
    if (strcmp(argv[3], "program") == 0) {
        status = program();
    } else if (strcmp(argv[3], "broken") == 0) {
        break_each_transfer();
    } else {
        EXPECT(!fp3_bare_open(&fp3, &machine_bus));
        if (strcmp(argv[3], "words") == 0) {
            EXPECT(argc == 6);
            print_words((uint32_t)strtoul(argv[4], NULL, 16), (uint32_t)strtoul(argv[5], NULL, 10));
        } else {
            refuse_lists();
            refuse_near();
            lose_balls();
            stand_still();
        }
    }
    board.ops->close(board.rtl);
    return status;
}
