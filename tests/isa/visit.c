/* visit - the loads and stores that the library adds to a program: a visit loads what the program
 * needs and stores what is read later. An object that is visited behaves like one that keeps its
 * registers.
 *
 *     visit [--seed N] [--programs N]
 *     visit --ship DIRECTORY
 *
 * The test has its own interpreter. It runs random programs for many visits, three times: once as
 * written, with registers that keep their values; and twice with loads and stores added, with a
 * record, and with registers that hold different junk at the beginning of every visit. The records
 * must agree with the registers.
 * To find a load that is not needed, the test enumerates all paths through the program.
 *
 * --ship: compares ship_sleep.s with ship_madd.s, both in DIRECTORY, visit by visit, until it
 * sleeps.
 */
#include <base/bits.h>
#include <fp3/image.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "machine/visit.h"
#include <fp3/isa.h>

enum { OBJECT = FP3_BANK_OBJECT_COUNT, SHARED = FP3_BANK_SHARED_COUNT, CODE = 48, SPAN = 7 };

static uint64_t state;
static unsigned long long seed, program;
static const fp3_image *shown; /* with a failure */

static uint32_t random32(void) { /* splitmix64 */
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)(z >> 32 ^ z);
}

static uint32_t below(uint32_t limit) { return random32() % limit; }

static void fail(const char *what, unsigned long long expected, unsigned long long got) {
    char *text = NULL;
    if (shown && !fp3_disassemble(shown, &text, NULL))
        printf("%s", text);
    printf("FAIL %s\n  expected: 0x%llx\n  got:      0x%llx\n", what, expected, got);
    printf("  replay:   visit --seed %llu, program %llu\n", seed, program);
    exit(1);
}

#define CHECK(what, expected, got)                                                                 \
    do {                                                                                           \
        if ((unsigned long long)(expected) != (unsigned long long)(got))                           \
            fail(what, (unsigned long long)(expected), (unsigned long long)(got));                 \
    } while (0)

static uint64_t bit(uint32_t reg) { return UINT64_C(1) << reg; }

/* ---- the interpreter ------------------------------------------------------------------------- */

typedef struct {
    uint32_t reg[OBJECT];
    const uint32_t *shared;
    uint32_t *record, record_words;
    int asleep, absent, fell; /* fell: asleep in this visit */
    uint32_t now;             /* number of the step */
} object;

static uint32_t bits_of(float v) {
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return isnan(v) ? 0x7fc00000u : bits;
}

static float operand(const object *o, uint32_t number) {
    return fp3_value_of(number < FP3_BANK_SHARED_BASE ? o->reg[number]
                                                      : o->shared[number - FP3_BANK_SHARED_BASE]);
}

static void execute(object *o, uint32_t word) {
    fp3_instruction in;
    if (fp3_word_decode(word, &in, NULL))
        fail("a word of a program is legal", 0, word);
    const float a = operand(o, in.a), b = operand(o, in.b), c = operand(o, in.c);
    volatile float product = a * b;
    if (in.op >= FP3_OP_LD && in.d >= o->record_words)
        fail("a register has a word in the record", o->record_words, in.d);
    switch (in.op) {
    case FP3_OP_ADD:
        o->reg[in.d] = bits_of(a + b);
        break;
    case FP3_OP_SUB:
        o->reg[in.d] = bits_of(a - b);
        break;
    case FP3_OP_MUL:
        o->reg[in.d] = bits_of(product);
        break;
    case FP3_OP_MADD:
        o->reg[in.d] = bits_of(c + product);
        break;
    case FP3_OP_MSUB:
        o->reg[in.d] = bits_of(c - product);
        break;
    case FP3_OP_SLEEP:
        if (!o->asleep && fabsf(a) < b) {
            o->reg[in.d] = o->now;
            o->asleep = o->fell = 1;
        }
        break;
    case FP3_OP_LD:
    case FP3_OP_LDS:
        o->reg[in.d] = o->record[in.d];
        o->absent = in.op == FP3_OP_LDS && o->reg[in.d];
        break;
    default: /* FP3_OP_ST */
        o->record[in.d] = o->reg[in.d];
        break;
    }
}

/* One visit of steps steps, numbered from clock + 1. */
static void visit(object *o, const uint32_t *code, uint32_t step, uint32_t last, uint32_t count,
                  uint32_t steps, uint32_t clock) {
    o->asleep = o->fell = 0;
    o->now = clock;
    for (uint32_t i = 0; i < step && !o->asleep && !o->absent; i++)
        execute(o, code[i]);
    for (uint32_t n = 0; n < steps; n++) {
        o->now++;
        for (uint32_t i = step; i < last && !o->asleep && !o->absent; i++)
            execute(o, code[i]);
    }
    for (uint32_t i = last; i < count && !o->absent; i++)
        execute(o, code[i]);
}

/* ---- random programs ------------------------------------------------------------------------- */

typedef struct {
    uint32_t code[CODE];
    fp3_symbol symbols[SPAN];
    uint32_t shared[SHARED];
    fp3_image *image;
} draft;

/* Few registers, so that instructions share them; sometimes far apart, for large records. */
static void make_program(draft *p) {
    const uint32_t stride = below(8) ? 1 : 9, span = 1 + below(SPAN), slept = below(span) * stride;
    const int may_sleep = below(4) > 0;
    fp3_image image = {.code_count = 1 + below(below(4) ? 12 : CODE)};
    image.step = below(image.code_count);
    image.last = image.step + 1 + below(image.code_count - image.step);
    for (uint32_t i = 0; i < image.code_count; i++) {
        static const uint32_t ops[] = {FP3_OP_ADD,  FP3_OP_SUB,   FP3_OP_MUL,  FP3_OP_MADD,
                                       FP3_OP_MSUB, FP3_OP_SLEEP, FP3_OP_SLEEP};
        fp3_instruction in = {.op = ops[below(may_sleep ? 7 : 5)], .d = below(span) * stride};
        uint32_t *const operands[] = {&in.a, &in.b, &in.c};
        for (int j = 0; j < (in.op == FP3_OP_MADD || in.op == FP3_OP_MSUB ? 3 : 2); j++)
            *operands[j] = below(5) ? below(span) * stride : FP3_BANK_SHARED_BASE + below(SHARED);
        if (in.op == FP3_OP_SLEEP) {
            in.d = slept;
            if (below(4))
                in.b = FP3_BANK_SHARED_BASE + below(SHARED);
        } else if (may_sleep && in.d == slept && below(4)) {
            in.d = (slept + stride) % (span * stride); /* mostly for sleep alone */
        }
        p->code[i] = fp3_word_encode(&in);
    }
    memset(p->symbols, 0, sizeof p->symbols);
    for (uint32_t r = 0; r < span; r++) {
        const uint32_t kind = below(5);
        if (kind > FP3_SYMBOL_TEMP && kind < 4)
            continue; /* without a name */
        fp3_symbol *s = &p->symbols[image.symbol_count++];
        s->symbol_class = kind > FP3_SYMBOL_TEMP ? FP3_SYMBOL_TEMP : (fp3_symbol_class)kind;
        s->index = r * stride;
        if (may_sleep && s->index == slept)
            s->symbol_class = FP3_SYMBOL_STATE;
        snprintf(s->name, sizeof s->name, "n%u", r);
    }
    for (uint32_t i = 0; i < SHARED; i++)
        p->shared[i] = bits_of(ldexpf((float)(1 + below(99)) / 32, (int)below(7) - 4));
    image.code = p->code;
    image.symbols = p->symbols;
    fp3_error error;
    shown = NULL;
    if (fp3_image_make(&image, &p->image, &error)) {
        printf("%s\n", error.text);
        fail("a random program makes an image", FP3_OK, FP3_E_PROGRAM);
    }
    shown = p->image;
}

/* ---- what must be loaded, path by path ------------------------------------------------------- */

typedef struct {
    uint64_t written, needed;
} path;

static void walk(path *p, const fp3_image *image, uint32_t begin, uint32_t end) {
    for (uint32_t i = begin; i < end; i++) {
        fp3_instruction in;
        if (fp3_word_decode(image->code[i], &in, NULL))
            fail("a word of a program is legal", 0, image->code[i]);
        const uint32_t read[] = {in.a, in.b, in.c};
        for (int j = 0; j < (in.op == FP3_OP_MADD || in.op == FP3_OP_MSUB ? 3 : 2); j++)
            if (read[j] < FP3_BANK_SHARED_BASE)
                p->needed |= bit(read[j]) & ~p->written;
        if (in.op != FP3_OP_SLEEP)
            p->written |= bit(in.d);
    }
}

static uint64_t finished(path p, const fp3_image *image, uint64_t stored) {
    walk(&p, image, image->last, image->code_count);
    return p.needed | (stored & ~p.written);
}

/* The same with an end at each sleep on the way. */
static uint64_t walk_part(path *p, const fp3_image *image, uint32_t begin, uint32_t end,
                          uint64_t stored) {
    uint64_t needed = 0;
    for (uint32_t i = begin; i < end; i++) {
        walk(p, image, i, i + 1);
        if (image->code[i] >> FP3_FIELD_OP_LO == FP3_OP_SLEEP)
            needed |= finished(*p, image, stored);
    }
    return needed;
}

static uint64_t needed(const fp3_image *image, uint64_t stored) {
    path p = {0};
    uint64_t found = walk_part(&p, image, 0, image->step, stored);
    for (int steps = 0; steps < 3; steps++) {
        found |= walk_part(&p, image, image->step, image->last, stored);
        found |= finished(p, image, stored);
    }
    return found;
}

/* ---- the checks ------------------------------------------------------------------------------ */

static uint64_t written_by(const fp3_image *image) {
    uint64_t written = 0;
    for (uint32_t i = 0; i < image->code_count; i++)
        written |= bit(image->code[i] >> FP3_FIELD_D_LO & (OBJECT - 1));
    return written;
}

static uint64_t temps_of(const fp3_image *image) {
    uint64_t found = 0;
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_TEMP)
            found |= bit(image->symbols[i].index);
    return found;
}

/* The words of a visit: lds, then ld, then the program, then st, a register each once. */
static void check_form(const fp3_image *image, const fp3_visit *v) {
    uint64_t loaded = 0, stored = 0;
    CHECK("step", image->step + v->loads_in_front, v->step);
    CHECK("last", image->last + v->loads_in_front, v->last);
    CHECK("words", v->loads_in_front + image->code_count + v->stores_behind, v->code_count);
    for (uint32_t i = 0; i < v->code_count; i++) {
        const int front = i < v->loads_in_front, behind = i >= v->code_count - v->stores_behind;
        if (!front && !behind) {
            CHECK("the program's words", image->code[i - v->loads_in_front], v->code[i]);
            continue;
        }
        fp3_instruction in = {0};
        CHECK("a load or store is legal", FP3_OK, fp3_word_decode(v->code[i], &in, NULL));
        const int is_slept = front && (int)in.d == v->slept;
        CHECK("lds first, ld, st", behind ? FP3_OP_ST : is_slept ? FP3_OP_LDS : FP3_OP_LD, in.op);
        if (is_slept)
            CHECK("lds is the very first word", 0, i);
        CHECK("a register once", 0, (front ? loaded : stored) & bit(in.d));
        *(front ? &loaded : &stored) |= bit(in.d);
    }
    CHECK("registers loaded", loaded, v->loaded);
    CHECK("registers stored", stored, v->stored);
    if (!loaded || !stored)
        fail("one load and one store at least", 1, 0);
    if (v->log2 > 6 || (v->kept | loaded | stored) >> ((1u << v->log2) - 1) >> 1)
        fail("1 << log2 is above every register", v->kept, v->log2);
    if (v->log2 > 0 && !(v->kept >> (1u << (v->log2 - 1))))
        fail("log2 is the smallest", v->kept, v->log2);
}

/* Exactly the loads and stores that are needed. */
static void check_sets(const fp3_image *image, const fp3_visit *v) {
    const uint64_t written = written_by(image), slept = v->slept < 0 ? 0 : bit((uint32_t)v->slept);
    const uint64_t outside = (written & ~temps_of(image)) | slept;
    const uint64_t loaded = needed(image, outside) | slept;
    const uint64_t stored = outside | (loaded & written);
    CHECK("what is loaded is what some path reads first", loaded ? loaded : 1, v->loaded);
    if (stored)
        CHECK("what is stored", stored, v->stored);
    else if (v->stored & (v->stored - 1) || !(v->stored & v->loaded))
        fail("the one store stores what was loaded", v->loaded, v->stored);
}

static unsigned long long visits, sleeps, last_sleeps;

static void check_visits(const draft *p, const fp3_visit *v) {
    uint32_t record[2][OBJECT];
    object plain = {.shared = p->shared}, composed[2];
    for (uint32_t r = 0; r < OBJECT; r++)
        plain.reg[r] = bits_of(ldexpf((float)below(1000) - 500, (int)below(20) - 14));
    if (v->slept >= 0)
        plain.reg[v->slept] = 0;
    for (int i = 0; i < 2; i++) {
        for (uint32_t r = 0; r < OBJECT; r++)
            record[i][r] = v->kept & bit(r) ? plain.reg[r] : random32();
        composed[i] =
            (object){.shared = p->shared, .record = record[i], .record_words = 1u << v->log2};
    }
    uint32_t clock = below(8) ? below(100) : UINT32_MAX - below(20);
    for (int n = 0; n < 6; n++) {
        const uint32_t steps = 1 + below(3);
        const uint64_t seen = v->slept < 0 ? 0 : plain.reg[v->slept];
        if (!seen)
            visit(&plain, p->image->code, p->image->step, p->image->last, p->image->code_count,
                  steps, clock);
        visits += !seen;
        sleeps += !seen && plain.fell;
        last_sleeps += !seen && plain.fell && plain.reg[v->slept] == clock + steps;
        for (int i = 0; i < 2; i++) {
            for (uint32_t r = 0; r < OBJECT; r++)
                composed[i].reg[r] = i ? random32() : bits_of((float)below(100) / 16);
            composed[i].absent = 0;
            visit(&composed[i], v->code, v->step, v->last, v->code_count, steps, clock);
            CHECK("an object that slept is absent", !!seen, composed[i].absent);
            for (uint32_t r = 0; r < OBJECT; r++)
                if (v->kept & bit(r) && record[i][r] != plain.reg[r]) {
                    printf("visit %d of the object, junk %d, r%u\n", n, i, r);
                    fail("a record is what the registers were", plain.reg[r], record[i][r]);
                }
        }
        clock += steps;
        if (v->slept >= 0 && below(3) == 0) /* the host wakes it */
            plain.reg[v->slept] = record[0][v->slept] = record[1][v->slept] = 0;
    }
}

/* Nothing is added to a program that loads and stores by itself. */
static void check_own(const fp3_image *composed, const fp3_visit *made) {
    fp3_error error;
    fp3_visit *again = NULL;
    const fp3_image draft = {.code_count = made->code_count,
                             .step = made->step,
                             .last = made->last,
                             .code = made->code,
                             .symbol_count = composed->symbol_count,
                             .symbols = composed->symbols};
    fp3_image *image = NULL;
    CHECK("a composed program is an image", FP3_OK, fp3_image_make(&draft, &image, &error));
    CHECK("and composed again", FP3_OK, fp3_visit_make(image, &again, &error));
    CHECK("nothing in front", 0, again->loads_in_front);
    CHECK("nothing behind", 0, again->stores_behind);
    CHECK("its words", made->code_count, again->code_count);
    CHECK("its words", 0, memcmp(made->code, again->code, made->code_count * sizeof *made->code));
    CHECK("step", made->step, again->step);
    CHECK("last", made->last, again->last);
    CHECK("loaded", made->loaded, again->loaded);
    CHECK("stored", made->stored, again->stored);
    CHECK("kept, and what an unasked load or store moves", made->kept | made->loaded | made->stored,
          again->kept);
    CHECK("slept", made->slept, again->slept);
    CHECK("log2", made->log2, again->log2);
    fp3_visit_free(&again);
    fp3_image_free(&image);
}

static void check_program(void) {
    static draft p;
    fp3_error error;
    fp3_visit *v = NULL;
    make_program(&p);
    if (fp3_visit_make(p.image, &v, &error)) {
        printf("%s\n", error.text);
        fail("a random program is composed", FP3_OK, FP3_E_PROGRAM);
    }
    check_form(p.image, v);
    check_sets(p.image, v);
    for (int i = 0; i < 3; i++)
        check_visits(&p, v);
    check_own(p.image, v);
    fp3_visit_free(&v);
    fp3_image_free(&p.image);
}

/* ---- by hand --------------------------------------------------------------------------------- */

/* "front | behind | log2 slept", as in "lds r2, ld r0 | st r0, st r2 | 2 2" */
static void describe(const fp3_visit *v, char *text, size_t size) {
    size_t used = 0;
    for (uint32_t i = 0; i < v->code_count; i++) {
        const int front = i < v->loads_in_front, behind = i >= v->code_count - v->stores_behind;
        char word[FP3_WORD_TEXT_SIZE] = "?", name[8], reg[8];
        if (!front && !behind)
            continue;
        fp3_word_text(v->code[i], NULL, word, NULL);
        sscanf(word, "%7s %7s", name, reg);
        used += (size_t)snprintf(text + used, size - used, "%s%s %s",
                                 i == 0 || i + v->stores_behind == v->code_count ? "" : ", ", name,
                                 reg);
        if (i + 1 == v->loads_in_front)
            used += (size_t)snprintf(text + used, size - used, " | ");
    }
    snprintf(text + used, size - used, " | %u %d", v->log2, v->slept);
}

static const struct {
    const char *why, *source, *expected;
} table[] = {
    {"state and param that are read; temps are not moved",
     ".state v s\n.param T\n.temp t\nstep: mul t, T, v\nadd v, v, t\nadd s, s, v",
     "ld r0, ld r1, ld r2 | st r0, st r1 | 2 -1"},
    {"a state written first is stored only", ".state v\n.param T\nstep: mul v, T, T",
     "ld r1 | st r0 | 1 -1"},
    {"a state that is only read is loaded only", ".state v w\nstep: add w, v, v",
     "ld r0 | st r1 | 1 -1"},
    {"a state that the program does not touch has its place in the record",
     ".state v\n.state x = r8\nstep: add v, v, v", "ld r0 | st r0 | 4 -1"},
    {"a temp that is read first is a state in truth",
     ".temp t\n.state v\nstep: add v, v, t\nadd t, v, v", "ld r0, ld r1 | st r0, st r1 | 1 -1"},
    {"a temp that a step leaves for the next one",
     ".temp t\n.state v\nfirst: add t, v, v\nstep: add v, v, t\nadd t, v, v",
     "ld r1 | st r1 | 1 -1"},
    {"a temp that the first part gives and a step leaves for the last part",
     ".temp t\n.state v\nstep: add t, v, v\nlast: add v, t, t", "ld r1 | st r1 | 1 -1"},
    {"a param that is written keeps what was written", ".param T\nstep: add T, T, T",
     "ld r0 | st r0 | 0 -1"},
    {"registers without a name are kept", "step: add r5, r4, r4", "ld r4 | st r5 | 3 -1"},
    {"nothing to load", ".state v\nstep: add v, 1.0, 1.0", "ld r0 | st r0 | 0 -1"},
    {"nothing to load, the state elsewhere",
     ".state v = r3\n.temp t = r0\nstep: add t, 1.0, 1.0\nadd v, t, t", "ld r0 | st r3 | 2 -1"},
    {"nothing to store", ".param T = r3\n.temp t\nstep: add t, T, T", "ld r3 | st r3 | 2 -1"},
    {"nothing at all", ".temp t\nstep: add t, 1.0, 1.0", "ld r0 | st r0 | 0 -1"},
    {"the sleep register comes first and is stored",
     ".state v z\n.param T\nstep: add v, v, T\nsleep z, v, 1.0",
     "lds r1, ld r0, ld r2 | st r0, st r1 | 2 1"},
    {"a state written after a sleep: an object that sleeps stores what it was",
     ".state v z\nstep: sleep z, k0, k1\nadd v, 1.0, 1.0", "lds r1, ld r0 | st r0, st r1 | 1 1"},
    {"a state written before a sleep", ".state v z\nstep: add v, 1.0, 1.0\nsleep z, k2, k3",
     "lds r1 | st r0, st r1 | 1 1"},
    {"a sleep of the first part jumps over the step part",
     ".state v z\n.temp t\nfirst: sleep z, k0, k1\nstep: add t, 1.0, 1.0\nlast: add v, t, t",
     "lds r1, ld r2 | st r0, st r1, st r2 | 2 1"},
    {"a sleep of the last part jumps over nothing",
     ".state v z\nstep: add k, 1.0, 1.0\nlast: sleep z, k, 1.0\nadd v, k, k\n.temp k",
     "lds r1 | st r0, st r1 | 1 1"},
    {"a sleep register without a name", "step: sleep r7, k0, k1", "lds r7 | st r7 | 3 7"},
    {"the largest record", ".state v = r63\nstep: add v, v, v", "ld r63 | st r63 | 6 -1"},
    {"loads and stores of its own",
     ".state v w z\nstep: lds z\nld v\nsleep z, v, 1.0\nlast: st v\nst z", " | 2 2"},
    {"a store of its own, out of a register that nothing writes", "step: st r4", " | 3 -1"},
};

static void check_table(void) {
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        fp3_error error;
        fp3_assembly *assembly = NULL;
        fp3_visit *v = NULL;
        char got[sizeof error.text] = "";
        if (fp3_assemble(table[i].source, strlen(table[i].source), "table", &assembly, &error) ||
            fp3_visit_make(assembly->image, &v, &error))
            snprintf(got, sizeof got, "%s", error.text);
        else
            describe(v, got, sizeof got);
        if (strcmp(got, table[i].expected)) {
            printf("FAIL %s\n%s\n  expected: %s\n  got:      %s\n", table[i].why, table[i].source,
                   table[i].expected, got);
            exit(1);
        }
        fp3_visit_free(&v);
        fp3_assembly_free(&assembly);
    }
}

static void check_limit(void) {
    static uint32_t code[FP3_IMAGE_CODE_LIMIT];
    for (uint32_t i = 0; i < FP3_IMAGE_CODE_LIMIT; i++)
        code[i] = FP3_OP_ADD << FP3_FIELD_OP_LO;
    fp3_error error;
    for (uint32_t count = FP3_IMAGE_CODE_LIMIT - 2; count <= FP3_IMAGE_CODE_LIMIT; count++) {
        const fp3_image draft = {.code_count = count, .last = count, .code = code};
        fp3_image *image = NULL;
        fp3_visit *v = NULL;
        const fp3_status expected = count + 2 > FP3_IMAGE_CODE_LIMIT ? FP3_E_PROGRAM : FP3_OK;
        CHECK("a long image", FP3_OK, fp3_image_make(&draft, &image, &error));
        CHECK("a load and a store more", expected, fp3_visit_make(image, &v, &error));
        if (expected && (v || !strstr(error.text, "65537 code words, with 1 loads and 1 stores")) &&
            count + 1 == FP3_IMAGE_CODE_LIMIT) {
            printf("%s\n", error.text);
            fail("the message names the words", 0, 1);
        }
        fp3_visit_free(&v);
        fp3_image_free(&image);
    }
}

/* ---- the ship -------------------------------------------------------------------------------- */

typedef struct {
    fp3_assembly *assembly;
    fp3_visit *visit;
    uint32_t record[OBJECT], shared[SHARED];
    object o;
} ship;

/* The word of a name, in the record or among the shared constants. */
static uint32_t *word_of(ship *s, const char *name) {
    const fp3_symbol *symbol = fp3_image_find(s->assembly->image, name, FP3_CLASSES_HOST);
    if (!symbol) {
        printf("FAIL no %s\n", name);
        exit(1);
    }
    return symbol->symbol_class == FP3_SYMBOL_SHARED ? &s->shared[symbol->index]
                                                     : &s->record[symbol->index];
}

static void launch(ship *s, const char *directory, const char *name) {
    char path[1024], *source = NULL;
    size_t size = 0;
    fp3_error error;
    memset(s, 0, sizeof *s);
    snprintf(path, sizeof path, "%s/%s", directory, name);
    if (fp3_file_read(path, &source, &size, &error) ||
        fp3_assemble(source, size, path, &s->assembly, &error) ||
        fp3_visit_make(s->assembly->image, &s->visit, &error)) {
        printf("FAIL %s\n", error.text);
        exit(1);
    }
    free(source);
    for (uint32_t i = 0; i < s->assembly->image->constant_count; i++)
        s->shared[s->assembly->image->constants[i].index] = s->assembly->image->constants[i].bits;
    static const struct {
        const char *name;
        float value;
    } given[] = {{"T", 2.9e5f}, {"C", 4.1e4f}, {"rm", 1 / 8.7e5f}, {"h", 0.25f}};
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        *word_of(s, given[i].name) = bits_of(given[i].value);
    s->o = (object){.shared = s->shared, .record = s->record, .record_words = 1u << s->visit->log2};
}

static void sail(ship *s, uint32_t steps, uint32_t clock) {
    const fp3_visit *v = s->visit;
    for (uint32_t r = 0; r < OBJECT; r++)
        s->o.reg[r] = random32();
    visit(&s->o, v->code, v->step, v->last, v->code_count, steps, clock);
}

static void land(ship *s) {
    fp3_visit_free(&s->visit);
    fp3_assembly_free(&s->assembly);
}

/* The other program makes one step at a time, so that it can be compared after any step. */
static uint32_t check_ship(const char *directory, uint32_t steps, float eps) {
    ship one, other;
    launch(&one, directory, "ship_sleep.s");
    launch(&other, directory, "ship_madd.s");
    *word_of(&one, "eps") = bits_of(eps);
    const uint32_t *v = word_of(&other, "v"), *s = word_of(&other, "s");
    for (uint32_t clock = 0; clock < 4000; clock += steps) {
        sail(&one, steps, clock);
        const uint32_t slept = *word_of(&one, "slept");
        for (uint32_t now = clock + 1; now <= clock + steps && !(slept && now > slept); now++) {
            const float before = fp3_value_of(*v);
            sail(&other, 1, 0);
            CHECK("the ship sleeps when its velocity changes by less than eps",
                  fabsf(fp3_value_of(*v) - before) < eps, slept == now);
        }
        CHECK("v is that of ship_madd.s", *v, *word_of(&one, "v"));
        CHECK("s is that of ship_madd.s", *s, *word_of(&one, "s"));
        if (slept) {
            sail(&one, steps, clock + steps);
            CHECK("an object that sleeps is absent", 1, one.o.absent);
            CHECK("v of a ship that sleeps", *v, *word_of(&one, "v"));
            land(&one);
            land(&other);
            return slept;
        }
    }
    fail("the ship falls asleep", 1, 0);
    return 0;
}

static int check_ships(const char *directory) {
    static const float eps[] = {1.0f, 1e-2f, 1e-4f, 1e-30f};
    static const uint32_t steps[] = {1, 2, 7, 100, 4000};
    for (size_t i = 0; i < sizeof eps / sizeof *eps; i++)
        for (size_t j = 0; j < sizeof steps / sizeof *steps; j++)
            printf("eps %g, %u steps a visit: asleep at step %u\n", (double)eps[i], steps[j],
                   check_ship(directory, steps[j], eps[i]));
    return 0;
}

int main(int argc, char **argv) {
    unsigned long long programs = 20000;
    seed = 1;
    if (argc == 3 && !strcmp(argv[1], "--ship"))
        return check_ships(argv[2]);
    for (int i = 1; i < argc; i += 2) {
        char *end = NULL;
        unsigned long long given = i + 1 < argc ? strtoull(argv[i + 1], &end, 0) : 0;
        if (!end || *end || (strcmp(argv[i], "--seed") && strcmp(argv[i], "--programs"))) {
            fprintf(stderr, "usage: visit [--seed N] [--programs N] | --ship DIRECTORY\n");
            return 2;
        }
        *(strcmp(argv[i], "--seed") ? &programs : &seed) = given;
    }
    printf("seed %llu\n", seed);
    state = seed;
    check_table();
    check_limit();
    for (program = 0; program < programs; program++)
        check_program();
    printf("%llu programs, %llu visits, %llu fell asleep, %llu of them at the last step\n",
           programs, visits, sleeps, last_sleeps);
    return 0;
}
