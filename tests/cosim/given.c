/* given.c - arithmetic with what a neighbour gives, in programs by chance: engines against the isa
 * engine.
 *
 *     given [SEED [CONFIGURATION [PROGRAMS [OBJECTS]]]]    engines fast (native, interpreter) and
 * rtl; at most so many objects
 *
 * Programs of one phase or two, the second of which may be repeated, with loops over two lists.
 * What they load, what they compute with a word or a field of a neighbour, and what they do
 * between, is random, and so are the lists; the words are numbers of any size, zeros of both signs,
 * infinities, NaNs and subnormal numbers. Every word must be that of the isa engine, and so must
 * the flags; the hardware's cycles are those that are foreseen.
 */
#include "chance.h"
#include "foreseen.h"
#include <base/bits.h>

#include <fp3/compile.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/format.h>
#include <machine/operation.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS_MAX = 64, LISTS = 2, LINKS_MAX = 4, FIELDS_MAX = 4, WORDS = 8, ROOM = 16384 };

static unsigned failed, runs, native;
static const char *config = "world";
static fp3_error error;

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

/* ---- a program ---- */

typedef struct {
    char text[ROOM];
    size_t used;
    chance *c;
    uint32_t fields[LISTS]; /* of each list's entries */
} program;

static void put(program *p, const char *format, ...) {
    va_list list;
    va_start(list, format);
    p->used += (size_t)vsnprintf(p->text + p->used, ROOM - p->used, format, list);
    va_end(list);
}

static const char *word(program *p) {
    static const char *const names[] = {"x0", "x1", "x2", "x3", "x4", "x5", "x6", "x7", "p"};
    return names[below(p->c, WORDS + 1)];
}

static const char *own(program *p) {
    static const char *const numbers[] = {"0.5", "-1.0", "0.0", "-0.0", "3.0e38"};
    return below(p->c, 6) ? word(p) : numbers[below(p->c, 5)];
}

static int has_select(void) {
    return fp3_operation_lacks(fp3_config_find(config), FP3_OP_MIN) == FP3_KEY_NONE;
}

static uint32_t state(program *p) { return below(p->c, WORDS); }

/* In a loop over a list whose `ldl` have read so many fields. */
static void put_word(program *p, uint32_t fields, uint32_t *loaded) {
    static const char *const plain[] = {"add", "sub", "mul", "min"};
    static const char *const words[] = {"addn", "subn", "rsbn", "muln"};
    static const char *const of_entry[] = {"addl", "subl", "rsbl", "mull"};
    switch (below(p->c, 8)) {
    case 0:
        put(p, "ldn x%" PRIu32 ", %s\n", state(p), word(p));
        return;
    case 1:
        if (*loaded < fields)
            put(p, "ldl x%" PRIu32 "\n", state(p));
        *loaded += *loaded < fields;
        return;
    case 2:
        put(p, "%s x%" PRIu32 ", %s, x%" PRIu32 "\n", plain[below(p->c, has_select() ? 4 : 3)],
            state(p), own(p), state(p));
        return;
    case 3:
        put(p, "madd x%" PRIu32 ", %s, x%" PRIu32 ", x%" PRIu32 "\n", state(p), own(p), state(p),
            state(p));
        return;
    case 4:
    case 5:
        if (fields)
            put(p, "%s x%" PRIu32 ", %s, %" PRIu32 "\n", of_entry[below(p->c, 4)], state(p), own(p),
                below(p->c, fields));
        return;
    default:
        put(p, "%s x%" PRIu32 ", %s, %s\n", words[below(p->c, 4)], state(p), own(p), word(p));
    }
}

static void put_loop(program *p, uint32_t list) {
    uint32_t loaded = 0;
    put(p, "each l%" PRIu32 "\n", list);
    const uint32_t words = below(p->c, 9), last = below(p->c, words + 1);
    for (uint32_t i = 0; i <= words; i++) {
        if (i == last && p->fields[list]) /* so many, in each loop */
            put(p, "mull x0, x1, %" PRIu32 "\n", p->fields[list] - 1);
        if (i < words)
            put_word(p, p->fields[list], &loaded);
    }
    put(p, "next\n");
}

/* Sums alone, which the fast engine has native code for. */
static void put_sums(program *p, uint32_t list) {
    static const char *const sums[] = {"addn s, s, x1", "subn s, s, p", "addl s, s, 0",
                                       "madd s, t0, t1, s", "msub s, t1, x7, s"};
    put(p, "add s, x0, -0.0\neach l%" PRIu32 "\nrsbn t0, x2, x0\nmuln t1, t0, %s\n", list, word(p));
    for (uint32_t i = below(p->c, 5); i > 0; i--) {
        const uint32_t which = below(p->c, 5);
        if (which != 2 || p->fields[list])
            put(p, "%s\n", sums[which]);
    }
    if (p->fields[list])
        put(p, "mull t1, t0, %" PRIu32 "\nadd s, s, t1\n", p->fields[list] - 1);
    put(p, "next\n");
    if (below(p->c, 3)) /* else the sum counts for its flags alone */
        put(p, "add x%" PRIu32 ", s, 0.0\n", 4 + list);
}

static void make(program *p) {
    const uint32_t phases = 1 + below(p->c, 2), kind = below(p->c, 3);
    const int is_repeated = (int)below(p->c, 2);
    p->used = 0;
    for (uint32_t i = 0; i < LISTS; i++)
        p->fields[i] = below(p->c, FIELDS_MAX + 1);
    put(p, ".state x0 x1 x2 x3 x4 x5 x6 x7\n.param p\n.temp l0 l1 t0 t1 s\nstep:\n");
    for (uint32_t phase = 0; phase < phases; phase++) {
        if (phase && is_repeated)
            put(p, "repeat %" PRIu32 "\n", 1 + below(p->c, 3));
        put(p, "%sld p\nld l0\nld l1\n", phase && !is_repeated ? "phase\n" : "");
        for (uint32_t i = 0; i < WORDS; i++)
            put(p, "ld x%" PRIu32 "\n", i);
        for (uint32_t list = 0; list < LISTS; list++)
            if (kind == 0)
                put_sums(p, list);
            else
                put_loop(p, list);
        for (uint32_t i = 0; i < WORDS; i++)
            put(p, "st x%" PRIu32 "\n", i);
    }
    if (phases > 1 && is_repeated)
        put(p, "again\n");
}

/* ---- engines ---- */

typedef struct {
    fp3_engine *engine;
    const char *name;
    fp3_stats stats;
} subject;

static void open_subject(subject *s, const char *name, uint32_t objects, const fp3_image *image) {
    fp3_engine_def def = fp3_engine_default();
    def.engine = strcmp(name, "interpreter") ? name : "fast";
    def.config = config;
    def.objects = objects;
    def.error = &error;
    if (strcmp(name, "interpreter"))
        unsetenv("FP3_FAST");
    else
        setenv("FP3_FAST", name, 1);
    s->name = name;
    told(fp3_engine_open(&def, &s->engine));
    told(fp3_engine_load(s->engine, image));
    native += strncmp(fp3_engine_how(s->engine), "native", 6) == 0;
}

static uint32_t any_word(chance *c) {
    return below(c, 3) ? below(c, 2) << 31 | (120 + below(c, 12)) << 23 | below(c, 1u << 23)
                       : value(c);
}

/* That the configuration has a word for. */
static float number(chance *c) {
    float f = fp3_value_of(any_word(c));
    for (uint32_t word; fp3_format_word(fp3_config_find(config), f, &word);)
        f = fp3_value_of(any_word(c));
    return f;
}

/* The same words and lists for all. */
static void fill(chance *c, const program *p, subject *s, unsigned count, uint32_t objects) {
    static const char *const lists[LISTS] = {"l0", "l1"};
    for (uint32_t reg = 0; reg <= WORDS; reg++) {
        uint32_t column[OBJECTS_MAX];
        for (uint32_t i = 0; i < objects; i++)
            column[i] = any_word(c);
        for (unsigned k = 0; k < count; k++)
            told(fp3_engine_write_words(s[k].engine, 0, objects, reg, column));
    }
    for (uint32_t list = 0; list < LISTS; list++) {
        uint32_t begin[OBJECTS_MAX + 1], other[OBJECTS_MAX * LINKS_MAX], entries = 0;
        float fields[OBJECTS_MAX * LINKS_MAX * FIELDS_MAX];
        const uint32_t most = below(c, LINKS_MAX + 1);
        for (uint32_t i = 0; i < objects; i++) {
            begin[i] = entries;
            for (uint32_t n = objects > 1 ? below(c, most + 1) : 0; n > 0; n--) {
                other[entries] = (i + 1 + below(c, objects - 1)) % objects;
                for (uint32_t f = 0; f < p->fields[list]; f++)
                    fields[entries * p->fields[list] + f] = number(c);
                entries++;
            }
        }
        begin[objects] = entries;
        const fp3_neighbours given = {.begin = begin, .other = other, .fields = fields};
        for (unsigned k = 0; k < count; k++)
            told(fp3_engine_set_neighbours(s[k].engine, 0, lists[list], &given));
    }
}

static void compare(const program *p, const subject *isa, const subject *other, uint32_t objects) {
    unsigned wrong = isa->stats.flags != other->stats.flags;
    if (wrong)
        printf("flags %" PRIx32 ", %s has %" PRIx32 "\n", isa->stats.flags, other->name,
               other->stats.flags);
    for (uint32_t reg = 0; reg <= WORDS; reg++) {
        uint32_t a[OBJECTS_MAX], b[OBJECTS_MAX];
        told(fp3_engine_read_words(isa->engine, 0, objects, reg, a));
        told(fp3_engine_read_words(other->engine, 0, objects, reg, b));
        for (uint32_t i = 0; i < objects; i++)
            if (a[i] != b[i] && !wrong++)
                printf("object %" PRIu32 " of %" PRIu32 ", word %" PRIu32 ": isa 0x%08" PRIx32
                       ", %s 0x%08" PRIx32 "\n",
                       i, objects, reg, a[i], other->name, b[i]);
    }
    if (strcmp(other->name, "rtl") == 0) {
        uint64_t foreseen = 0;
        told(foreseen_cycles(other->engine, 2, &foreseen));
        if (other->stats.counter[FP3_COUNTER_CYCLES] != foreseen)
            printf("%" PRIu64 " cycles, %" PRIu64 " are foreseen\n",
                   other->stats.counter[FP3_COUNTER_CYCLES], foreseen);
        wrong += other->stats.counter[FP3_COUNTER_CYCLES] != foreseen;
    }
    runs++;
    failed += wrong != 0;
    if (wrong && failed < 4)
        printf("%s\n", p->text);
}

static void check(chance *c, uint32_t most) {
    static const char *const names[] = {"isa", "fast", "interpreter", "rtl"};
    static program p;
    subject s[4];
    fp3_assembly *made = NULL;
    const uint32_t objects = 1 + below(c, below(c, 2) ? most : 8);
    p.c = c;
    make(&p);
    told(fp3_assemble(p.text, strlen(p.text), "given.s", &made, &error));
    for (unsigned k = 0; k < 4; k++)
        open_subject(&s[k], names[k], objects, made->image);
    fill(c, &p, s, 4, objects);
    for (unsigned k = 0; k < 4; k++)
        told(fp3_engine_run(s[k].engine, 2, &s[k].stats));
    for (unsigned k = 1; k < 4; k++)
        compare(&p, &s[0], &s[k], objects);
    for (unsigned k = 0; k < 4; k++)
        fp3_engine_close(&s[k].engine);
    fp3_assembly_free(&made);
}

int main(int argc, char **argv) {
    chance c = {.state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1};
    if (argc > 2)
        config = argv[2];
    const unsigned long programs = argc > 3 ? strtoul(argv[3], NULL, 0) : 200;
    const uint32_t most = argc > 4 ? (uint32_t)strtoul(argv[4], NULL, 0) : OBJECTS_MAX;
    for (unsigned long i = 0; i < programs; i++)
        check(&c, most);
    printf("%u runs, %u of native code, %u failed\n", runs, native, failed);
    return failed != 0;
}
