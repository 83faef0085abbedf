/* early_ends.c - runs of objects that see each other, stopped or at an illegal word: what the host
 * reads then.
 *
 *     early_ends [SEED [CONFIGURATION [OBJECTS]]]    so many objects
 *
 * Published words are those of the last phase that ended, every other word is of that phase or of
 * the next: as the isa engine has them, which runs the program as far as each phase. The next run
 * goes on from what the host reads.
 */
#include "both.h"

#include <fp3/image.h>

enum { STEPS = 4, PHASES_MAX = 2, ENDS = STEPS * PHASES_MAX, WORDS_MAX = 64, STOPS = 24 };

/* Each phase changes what neighbours read, which is a word above 31, and another word, which it
 * stores first. */
static const char *const programs[] = {".state a = r40\n.state b = r1\n.temp l\nstep:\n"
                                       "ld l\nld a\nld b\neach l\naddn b, b, a\nnext\n"
                                       "add a, a, 1.0\nst b\nst a\n",
                                       ".state a = r40\n.state b = r1\n.temp l\nstep:\n"
                                       "ld l\nld a\nld b\neach l\naddn b, b, a\nnext\n"
                                       "add a, a, 1.0\nst b\nst a\nphase\n"
                                       "ld l\nld a\nld b\neach l\naddn a, a, a\nnext\n"
                                       "add b, b, 1.0\nst b\nst a\n"};

typedef struct {
    uint32_t word[WORDS_MAX][OBJECTS_MAX];
} records;

typedef struct {
    both b;
    uint32_t phases, words;              /* of a step; of a record */
    fp3_assembly *until[PHASES_MAX + 1]; /* until[p]: the program's phases below p */
    fp3_engine *isa[PHASES_MAX + 1];     /* ... on the isa engine */
    links l;
    records after[ENDS + 1]; /* what the isa engine has when so many phases have ended */
} bench;

static void read_all(const bench *s, fp3_engine *engine, records *r) {
    for (uint32_t reg = 0; reg < s->words; reg++)
        told(fp3_engine_read_words(engine, 0, s->b.objects, reg, r->word[reg]));
}

static void write_all(const bench *s, fp3_engine *engine, const records *r) {
    for (uint32_t reg = 0; reg < s->words; reg++)
        told(fp3_engine_write_words(engine, 0, s->b.objects, reg, r->word[reg]));
}

/* Lists of near objects change from phase to phase, each of which is then a run of its own. */
static int is_near;

static void link_all(const bench *s, fp3_engine *engine) {
    const fp3_neighbours some = {.begin = s->l.begin, .other = s->l.other};
    const fp3_near near = {.position = {"a"}, .dimensions = 1, .reach = 0.5, .skin = 0.01};
    told(is_near ? fp3_engine_set_near(engine, 0, "l", &near)
                 : fp3_engine_set_neighbours(engine, 0, "l", &some));
}

static void open_bench(bench *s, chance *c, const char *text) {
    static const char phase[] = "\nphase\n";
    const char *end = text;
    for (s->phases = 0; end; end = end ? end + strlen(phase) : NULL) {
        end = strstr(end, phase);
        told(fp3_assemble(text, end ? (size_t)(end - text) + 1 : strlen(text), "phases.s",
                          &s->until[++s->phases], &error));
    }
    s->b = open_both(s->until[s->phases]->image, most);
    s->words = words_of(&s->b);
    link_some(c, most, 3, 0, &s->l);
    link_all(s, s->b.isa);
    link_all(s, s->b.rtl);
    for (uint32_t p = 1; p <= s->phases; p++) {
        s->isa[p] = open_engine("isa", most, 0);
        told(fp3_engine_load(s->isa[p], s->until[p]->image));
        link_all(s, s->isa[p]);
    }
}

static void close_bench(bench *s) {
    close_both(&s->b);
    for (uint32_t p = 1; p <= s->phases; p++) {
        fp3_engine_close(&s->isa[p]);
        fp3_assembly_free(&s->until[p]);
    }
}

/* Words by chance, and what becomes of them. */
static void begin(bench *s, chance *c) {
    for (uint32_t reg = 0; reg < s->words; reg++)
        for (uint32_t i = 0; i < most; i++) {
            const float number = (float)(1 + below(c, 1000)) / 64;
            memcpy(&s->after[0].word[reg][i], &number, sizeof number);
        }
    for (uint32_t n = 0; n < STEPS * s->phases; n++) {
        fp3_engine *engine = s->isa[n % s->phases + 1];
        write_all(s, engine, &s->after[n / s->phases * s->phases]);
        told(fp3_engine_run(engine, 1, NULL));
        read_all(s, engine, &s->after[n + 1]);
    }
    write_all(s, s->b.rtl, &s->after[0]);
}

static int is_published(const bench *s, uint32_t reg) {
    return fp3_layout_published(group_of(s->b.rtl)) >> reg & 1;
}

/* How many phases have ended, by the published words; ENDS + 1: that many, nobody knows. */
static uint32_t phases_ended(const bench *s, const records *is) {
    for (uint32_t n = 0; n <= STEPS * s->phases; n++) {
        int is_same = 1;
        for (uint32_t reg = 0; reg < s->words; reg++)
            if (is_published(s, reg))
                is_same &= !memcmp(is->word[reg], s->after[n].word[reg], most * sizeof(uint32_t));
        if (is_same)
            return n;
    }
    return ENDS + 1;
}

/* Who is in the first batch has stored its words before the illegal word; no other has. is_stop:
 * some have. */
static void check_others(const bench *s, const records *is, uint32_t n, int is_stop,
                         const char *how) {
    const fp3_config *hardware = fp3_config_find(config);
    const records *before = &s->after[n], *then = &s->after[n + (n < STEPS * s->phases)];
    for (uint32_t reg = 0; reg < s->words; reg++)
        for (uint32_t i = 0; i < most; i++) {
            const int is_first = i < hardware->contexts * hardware->lanes;
            const uint32_t word = is->word[reg][i], old = before->word[reg][i],
                           new = then->word[reg][i];
            if (is_published(s, reg) ? word != old
                : is_stop            ? word != old && word != new
                                     : word != (is_first ? new : old))
                FAIL("%s: %" PRIu32 " phases have ended, object %" PRIu32 ", word %" PRIu32
                     " is 0x%08" PRIx32 ", 0x%08" PRIx32 " before, then 0x%08" PRIx32,
                     how, n, i, reg, word, old, new);
        }
}

/* Returns how many phases have ended. */
static uint32_t check_end(bench *s, int is_stop, const char *how) {
    static records is;
    read_all(s, s->b.rtl, &is);
    const uint32_t n = phases_ended(s, &is);
    if (n > STEPS * s->phases)
        FAIL("%s: published words are those of no phase", how);
    else
        check_others(s, &is, n, is_stop, how);
    return n;
}

static void go_on(bench *s, const char *how) {
    static records is;
    read_all(s, s->b.rtl, &is);
    write_all(s, s->b.isa, &is);
    run_both(&s->b, 1, "after an early end", how);
}

static void check_stops(chance *c, const char *text) {
    static bench s;
    uint64_t cycles;
    uint32_t seen = 0, last = 0;
    fp3_stats stats;
    open_bench(&s, c, text);
    const chance first = *c; /* other words have other neighbours, and take other cycles */
    begin(&s, c);
    told(fp3_engine_run(s.b.rtl, STEPS, &stats));
    cycles = stats.counter[FP3_COUNTER_CYCLES];
    for (uint64_t limit = 5; limit < cycles / 10 * 9; limit += cycles / STOPS) {
        char how[48];
        (void)snprintf(how, sizeof how, "stopped after %" PRIu64 " cycles", limit);
        chance again = first;
        begin(&s, &again);
        fp3_engine_definition(s.b.rtl)->cycle_limit = limit;
        if (fp3_engine_run(s.b.rtl, STEPS, NULL) != FP3_E_LIMIT)
            FAIL("%s: it did not", how);
        fp3_engine_definition(s.b.rtl)->cycle_limit = 0;
        const uint32_t n = check_end(&s, 1, how);
        if (n < last)
            FAIL("%s: %" PRIu32 " phases have ended after %" PRIu32, how, n, last);
        seen += n != last;
        last = n;
        go_on(&s, how);
    }
    if (seen + 1 < STEPS * s.phases)
        FAIL("stops in %" PRIu32 " of %" PRIu32 " phases", seen, STEPS * s.phases);
    close_bench(&s);
}

/* Between the two stores of the last phase. */
static void check_illegal(chance *c, const char *text) {
    static bench s;
    open_bench(&s, c, text);
    const fp3_image *good = s.until[s.phases]->image;
    uint32_t code[64];
    fp3_image draft = *good, *bad = NULL;
    memcpy(code, good->code, good->code_count * sizeof *code);
    code[draft.code_count] = code[draft.code_count - 1];
    code[draft.code_count - 1] = 0xffffffff;
    draft.code = code;
    draft.last = ++draft.code_count;
    told(fp3_image_make(&draft, &bad, &error));
    begin(&s, c);
    told(fp3_engine_load(s.b.rtl, bad));
    link_all(&s, s.b.rtl);
    write_all(&s, s.b.rtl, &s.after[0]);
    char told_of[48];
    (void)snprintf(told_of, sizeof told_of, "word %" PRIu32 " is 0xffffffff", draft.code_count - 2);
    if (fp3_engine_run(s.b.rtl, STEPS, NULL) != FP3_E_PROGRAM || !strstr(error.text, told_of))
        FAIL("an illegal word ends no run, or is told as another one: %s", error.text);
    const uint32_t n = check_end(&s, 0, "an illegal word");
    if (n != s.phases - 1)
        FAIL("an illegal word: %" PRIu32 " phases have ended", n);
    fp3_image_free(&bad);
    close_bench(&s);
}

/* Nobody reads its words, so a visit makes all steps: the hardware has forgotten what was
 * published. */
static void check_ordinary(chance *c) {
    static bench s;
    static const char ordinary[] = ".state x\nstep:\nadd x, x, 1.0\n";
    fp3_assembly *made = NULL;
    float x = 0;
    open_bench(&s, c, programs[0]);
    told(fp3_assemble(ordinary, strlen(ordinary), "ordinary.s", &made, &error));
    told(fp3_engine_run(s.b.rtl, 1, NULL));
    told(fp3_engine_load(s.b.rtl, made->image));
    told(fp3_engine_run(s.b.rtl, 3, NULL));
    told(fp3_engine_read(s.b.rtl, most - 1, 1, 0, &x));
    if (x != 3)
        FAIL("three steps of a program without neighbours: %g", (double)x);
    fp3_assembly_free(&made);
    close_bench(&s);
}

int main(int argc, char **argv) {
    chance c = {.state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1};
    if (argc > 2)
        config = argv[2];
    if (argc > 3)
        most = (uint32_t)strtoul(argv[3], NULL, 0);
    for (size_t i = 0; i < 2 * (sizeof programs / sizeof *programs); i++) {
        is_near = (int)(i % 2);
        check_stops(&c, programs[i / 2]);
        check_illegal(&c, programs[i / 2]);
    }
    is_near = 0;
    check_ordinary(&c);
    printf("%u runs, %u failed\n", runs, failed);
    return failed != 0;
}
