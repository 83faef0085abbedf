/* random_stream.c - random instruction streams: the hardware against the model at every retirement.
 *
 *     random_stream [--instructions N] [--config NAME] [--seed S] [--streams N]
 *
 * The hardware's units finish out of order, but each register is written in program order: the
 * model runs first and leaves a queue per register, from which each retirement of the hardware
 * takes one. Values, flags, final registers, sticky flags, counts, and the end of a run that meets
 * an illegal word must agree. A stream has its own seed: --seed S --streams 1 repeats it alone.
 */
#include "engines/kind.h"

#include <configs.h>
#include <fp3/asm.h>
#include <getopt.h>
#include <inttypes.h>
#include <isa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CODE_SHORT = 40, CODE_MAX = 160, STEPS_MAX = 4, OBJECTS_MAX = 64, REGISTERS_MAX = 64 };

/* ---- chance ---- */

typedef struct {
    uint64_t state;
    uint32_t last; /* the last value made */
} chance;

/* splitmix64 */
static uint64_t next64(chance *c) {
    uint64_t z = c->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static uint32_t below(chance *c, uint32_t bound) {
    return (uint32_t)((next64(c) >> 32) * bound >> 32);
}

/* Values of which neighbours meet: equal magnitudes cancel, products come close to both ends. */
static uint32_t value(chance *c) {
    static const uint32_t specials[] = {
        0x00000000, 0x00000001, 0x00000002, 0x007fffff, 0x00800000, 0x00800001, 0x01000000,
        0x33800000, 0x3effffff, 0x3f000000, 0x3f7fffff, 0x3f800000, 0x3f800001, 0x40000000,
        0x4b800000, 0x7effffff, 0x7f7fffff, 0x7f800000, 0x7f800001, 0x7fc00000, 0x7fc12345,
    };
    const uint32_t random = (uint32_t)next64(c);
    const uint32_t exponent = random & 0x807fffffu;
    switch (below(c, 16)) {
    case 0:
        return c->last = random;
    case 1:
        return c->last =
                   specials[below(c, sizeof specials / sizeof *specials)] | (random & 0x80000000u);
    case 2:
        return c->last = exponent | below(c, 3) << 23; /* subnormal, or nearly so */
    case 3:
    case 11:
        return c->last = exponent | (51 + below(c, 25)) << 23; /* two make a subnormal product */
    case 4:
        return c->last = exponent | (188 + below(c, 6))
                                        << 23; /* two make an overflow, or nearly so */
    case 5:
        return c->last = exponent | (251 + below(c, 4)) << 23;
    case 6:
        return c->last = (random & 0xff800000u) | 1u << below(c, 23);
    case 7:
    case 8:
    case 9:
    case 10:
        return c->last ^= (random & 0x80000000u) | below(c, 8) | (below(c, 4) ? 0 : 0x00800000u);
    default:
        return c->last = exponent | (122 + below(c, 10)) << 23;
    }
}

/* ---- a stream ---- */

typedef struct {
    uint32_t code[CODE_MAX];
    uint32_t count, step, last, steps;
    uint32_t recent[4]; /* destinations: what follows depends on them */
} stream;

static uint32_t source(chance *c, const stream *s, uint32_t registers) {
    switch (below(c, 8)) {
    case 0:
    case 1:
        return s->recent[below(c, 4)];
    case 2:
    case 3:
        return below(c, registers);
    default:
        return FP3_BANK_SHARED_BASE + below(c, registers);
    }
}

static uint32_t legal_word(chance *c, stream *s, const fp3_config *config) {
    static const struct {
        uint32_t op;
        int is_chain;
    } ops[] = {
        {FP3_OP_MADD, 1}, {FP3_OP_MSUB, 1}, {FP3_OP_ADD, 0}, {FP3_OP_SUB, 0}, {FP3_OP_MUL, 0}};
    const uint32_t first = config->chain ? 0 : 2;
    const uint32_t pick = first + below(c, 5 - first);
    fp3_instruction in = {.op = ops[pick].op};
    in.d = below(c, 5) ? below(c, config->registers) : s->recent[below(c, 4)];
    in.a = source(c, s, config->registers);
    in.b = source(c, s, config->registers);
    in.c = ops[pick].is_chain ? source(c, s, config->registers) : 0;
    s->recent[below(c, 4)] = in.d;
    return fp3_word_encode(&in);
}

static uint32_t illegal_word(chance *c, stream *s, const fp3_config *config) {
    const uint32_t word = legal_word(c, s, config);
    const uint32_t random = (uint32_t)next64(c);
    const uint32_t beyond = config->registers < 64 ? config->registers : 0;
    for (;;)
        switch (below(c, 4)) {
        case 0:
            return random & 0x07ffffffu; /* code 0 */
        case 1:
            return (random & 0x07ffffffu) | (6 + below(c, 26)) << 27; /* no such code */
        case 2:
            return (word & 0x07ffff80u) | FP3_OP_ADD << 27 | (1 + below(c, 127)); /* c of an add */
        default:
            if (!config->chain)
                return (word & 0x07ffffffu) | FP3_OP_MADD << 27;
            if (beyond) {
                static const int fields[] = {FP3_FIELD_D_LO, FP3_FIELD_A_LO, FP3_FIELD_B_LO,
                                             FP3_FIELD_C_LO};
                return (word & 0x07ffffffu) | (uint32_t)FP3_OP_MSUB << 27 |
                       beyond << fields[below(c, 4)];
            }
        }
}

static void make(chance *c, stream *s, const fp3_config *config) {
    const uint32_t room = config->program_words < CODE_MAX ? config->program_words : CODE_MAX;
    /* Mostly short: after some dozens of operations there are too many infinities and NaNs. */
    s->count = 1 + below(c, below(c, 4) && room > CODE_SHORT ? CODE_SHORT : below(c, 2) ? room : 6);
    s->step = below(c, below(c, 2) ? s->count : 1 + s->count / 4);
    s->last = s->step + 1 + below(c, s->count - s->step);
    s->steps = below(c, 40) ? 1 + below(c, STEPS_MAX) : 0;
    for (int i = 0; i < 4; i++)
        s->recent[i] = below(c, config->registers);
    for (uint32_t i = 0; i < s->count; i++)
        s->code[i] = legal_word(c, s, config);
    if (below(c, 12) == 0)
        s->code[below(c, s->count)] = illegal_word(c, s, config);
}

/* ---- what is compared ---- */

typedef struct {
    const stream *s;
    const fp3_config *config;
    fp3_retirement *expected; /* the model's, in program order */
    size_t *next;             /* of the same register, or 0 */
    size_t count;             /* entry 0 stays empty */
    size_t head[OBJECTS_MAX][REGISTERS_MAX], tail[OBJECTS_MAX][REGISTERS_MAX];
    fp3_error *error;
    int is_wrong;
} queues;

static void fill(void *user, const fp3_retirement *r) {
    queues *q = user;
    const size_t i = ++q->count;
    q->expected[i] = *r;
    q->next[i] = 0;
    if (q->head[r->object][r->reg])
        q->next[q->tail[r->object][r->reg]] = i;
    else
        q->head[r->object][r->reg] = i;
    q->tail[r->object][r->reg] = i;
}

/* Which word the model's n-th instruction was. */
static uint32_t word_index(const queues *q, uint64_t n) {
    const stream *s = q->s;
    const uint64_t k = n / q->config->contexts, length = s->last - s->step,
                   end = s->step + length * s->steps;
    return (uint32_t)(k < s->step ? k
                      : k < end   ? s->step + (k - s->step) % length
                                  : s->last + k - end);
}

static void take(void *user, const fp3_retirement *r) {
    queues *q = user;
    if (q->is_wrong)
        return;
    const size_t i = r->object < q->config->contexts && r->reg < q->config->registers
                         ? q->head[r->object][r->reg]
                         : 0;
    if (!i) {
        q->is_wrong = 1;
        fp3_fail(q->error, FP3_E_MISMATCH,
                 "cycle %" PRIu64 ": object %" PRIu32 " r%" PRIu32 " got 0x%08" PRIx32
                 ", expected no more writes",
                 r->cycle, r->object, r->reg, r->bits);
        return;
    }
    const fp3_retirement *e = &q->expected[i];
    q->head[r->object][r->reg] = q->next[i];
    if (e->bits == r->bits && e->flags == r->flags)
        return;
    const uint32_t index = word_index(q, e->cycle);
    char text[FP3_WORD_TEXT_SIZE] = "";
    fp3_word_text(q->s->code[index], NULL, text, NULL);
    q->is_wrong = 1;
    fp3_fail(q->error, FP3_E_MISMATCH,
             "instruction %" PRIu64 ", word %" PRIu32 " (%s), object %" PRIu32 ": got 0x%08" PRIx32
             " flags 0x%02" PRIx32 ", expected 0x%08" PRIx32 " flags 0x%02" PRIx32,
             e->cycle, index, text, r->object, r->bits, r->flags, e->bits, e->flags);
}

static const char *compare_end(fp3_engine *const engine[2], const fp3_stats stats[2],
                               fp3_error *error) {
    static const int counters[] = {FP3_COUNTER_ISSUED_ADD, FP3_COUNTER_ISSUED_MUL,
                                   FP3_COUNTER_ISSUED_CHAIN, FP3_COUNTER_RETIRED};
    const fp3_config *config = engine[0]->config;
    for (uint32_t object = 0; object <= config->contexts; object++)
        for (uint32_t reg = 0; reg < config->registers; reg++) {
            uint32_t bits[2] = {0, 0};
            for (int k = 0; k < 2; k++)
                if (object < config->contexts
                        ? engine[k]->kind->read(engine[k], object, reg, &bits[k])
                        : engine[k]->kind->read_shared(engine[k], reg, &bits[k]))
                    return error->text;
            if (bits[0] != bits[1]) {
                fp3_fail(error, FP3_E_MISMATCH,
                         "at the end: object %" PRIu32 " %c%" PRIu32 " got 0x%08" PRIx32
                         ", expected 0x%08" PRIx32,
                         object, object < config->contexts ? 'r' : 'k', reg, bits[1], bits[0]);
                return error->text;
            }
        }
    for (size_t i = 0; i < sizeof counters / sizeof *counters; i++)
        if (stats[0].counter[counters[i]] != stats[1].counter[counters[i]]) {
            fp3_fail(error, FP3_E_MISMATCH, "%s: got %" PRIu64 ", expected %" PRIu64,
                     fp3_counter_name((fp3_counter)counters[i]), stats[1].counter[counters[i]],
                     stats[0].counter[counters[i]]);
            return error->text;
        }
    if (stats[0].flags != stats[1].flags || stats[0].object_steps != stats[1].object_steps) {
        fp3_fail(error, FP3_E_MISMATCH,
                 "flags 0x%02" PRIx32 ", expected 0x%02" PRIx32 "; object-steps %" PRIu64
                 ", expected %" PRIu64,
                 stats[1].flags, stats[0].flags, stats[1].object_steps, stats[0].object_steps);
        return error->text;
    }
    return NULL;
}

/* Past the checks of fp3_engine_load: what it refuses, the hardware must trap. */
static fp3_status load_unchecked(fp3_engine *engine, const stream *s) {
    const fp3_image draft = {
        .code = s->code, .code_count = s->count, .step = s->step, .last = s->last};
    fp3_image_free(&engine->image);
    fp3_status status = fp3_image_make(&draft, &engine->image, engine->def.error);
    return status ? status : engine->kind->load(engine, engine->image);
}

typedef struct {
    fp3_engine *engine[2]; /* model, rtl */
    fp3_error error[2];
    queues q;
    uint64_t instructions, cycles, faults, nans, subnormals;
} bench;

/* NULL, or what went wrong. */
static const char *run_stream(bench *b, uint64_t seed) {
    chance c = {.state = seed};
    stream s;
    fp3_stats stats[2];
    fp3_status status[2];
    const fp3_config *config = b->engine[0]->config;
    make(&c, &s, config);
    memset(b->q.head, 0, sizeof b->q.head);
    b->q.s = &s;
    b->q.count = 0;
    b->q.is_wrong = 0;
    for (int k = 0; k < 2; k++)
        if (load_unchecked(b->engine[k], &s))
            return b->error[k].text;
    for (uint32_t object = 0; object <= config->contexts; object++)
        for (uint32_t reg = 0; reg < config->registers; reg++) {
            const uint32_t bits = value(&c);
            for (int k = 0; k < 2; k++)
                if (object < config->contexts
                        ? b->engine[k]->kind->write(b->engine[k], object, reg, bits)
                        : b->engine[k]->kind->write_shared(b->engine[k], reg, bits))
                    return b->error[k].text;
        }
    for (int k = 0; k < 2; k++) {
        b->error[k].text[0] = '\0';
        status[k] = fp3_engine_run(b->engine[k], s.steps, &stats[k]);
        if (b->q.is_wrong)
            return b->error[1].text;
    }
    if (status[0] != status[1] || strcmp(b->error[0].text, b->error[1].text) != 0) {
        char model[256];
        snprintf(model, sizeof model, "%.255s", b->error[0].text);
        fp3_error rtl = b->error[1];
        fp3_fail(&b->error[1], FP3_E_MISMATCH, "the end: got %d '%.200s', expected %d '%s'",
                 (int)status[1], rtl.text, (int)status[0], model);
        return b->error[1].text;
    }
    for (uint32_t object = 0; object < config->contexts; object++)
        for (uint32_t reg = 0; reg < config->registers; reg++)
            if (b->q.head[object][reg]) {
                fp3_fail(&b->error[1], FP3_E_MISMATCH,
                         "object %" PRIu32 " r%" PRIu32 " got too few writes", object, reg);
                return b->error[1].text;
            }
    for (size_t i = 1; i <= b->q.count; i++) {
        b->nans += (b->q.expected[i].bits & 0x7fffffffu) > 0x7f800000u;
        b->subnormals += (b->q.expected[i].bits & 0x7fffffffu) - 1 < 0x7fffffu;
    }
    b->instructions += stats[1].counter[FP3_COUNTER_RETIRED];
    b->cycles += stats[1].counter[FP3_COUNTER_CYCLES];
    b->faults += status[1] != FP3_OK;
    return compare_end(b->engine, stats, &b->error[1]);
}

static uint64_t number(const char *text) {
    char *end;
    const uint64_t value = strtoull(text, &end, 0);
    if (end != text && !*end && value > 0)
        return value;
    fprintf(stderr, "random_stream: '%s' is no number above 0\n", text);
    exit(2);
}

/* Exit code. */
static int run_config(const char *program, const char *name, uint64_t seed, uint64_t instructions,
                      uint64_t streams) {
    bench *b = calloc(1, sizeof *b);
    const char *wrong = b ? NULL : "out of memory";
    uint64_t n = 0;
    for (int k = 0; k < 2 && !wrong; k++) {
        fp3_engine_def def = fp3_engine_default();
        def.kind = k ? "rtl" : "model";
        def.config = name;
        def.cycle_limit = 1000000;
        def.retire = k ? take : fill;
        def.retire_user = &b->q;
        def.error = &b->error[k];
        if (fp3_engine_open(&def, &b->engine[k]))
            wrong = b->error[k].text;
    }
    if (!wrong) {
        const size_t room = (size_t)CODE_MAX * STEPS_MAX * b->engine[0]->config->contexts + 1;
        b->q.config = b->engine[0]->config;
        b->q.error = &b->error[1];
        b->q.expected = malloc(room * sizeof *b->q.expected);
        b->q.next = malloc(room * sizeof *b->q.next);
        if (!b->q.expected || !b->q.next)
            wrong = "out of memory";
    }
    for (; !wrong && n < streams && b->instructions < instructions; n++)
        if ((wrong = run_stream(b, seed + n)))
            break;
    if (wrong)
        printf("FAIL %s, stream %" PRIu64 ": %s\n  replay: %s --config %s --seed %" PRIu64
               " --streams 1\n",
               name, n, wrong, program, name, seed + n);
    else
        printf("%s: %" PRIu64 " instructions in %" PRIu64 " streams and %" PRIu64
               " cycles agree; %" PRIu64
               " streams ended at an illegal word; %.0f%% NaN, %.0f%% subnormal\n",
               name, b->instructions, n, b->cycles, b->faults,
               100.0 * (double)b->nans / (double)b->instructions,
               100.0 * (double)b->subnormals / (double)b->instructions);
    if (b) {
        fp3_engine_close(&b->engine[0]);
        fp3_engine_close(&b->engine[1]);
        free(b->q.expected);
        free(b->q.next);
    }
    free(b);
    return wrong ? 1 : 0;
}

int main(int argc, char **argv) {
    static const struct option options[] = {{"instructions", required_argument, NULL, 'i'},
                                            {"config", required_argument, NULL, 'c'},
                                            {"seed", required_argument, NULL, 's'},
                                            {"streams", required_argument, NULL, 'n'},
                                            {0}};
    static const char *const configs[] = {
#define X(name, ...) #name,
        FP3_CONFIGS(X)
#undef X
    };
    uint64_t seed = 1, instructions = 1200000, streams = UINT64_MAX;
    const char *only = NULL;
    for (int key; (key = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (key) {
        case 'i':
            instructions = number(optarg);
            break;
        case 'c':
            only = optarg;
            break;
        case 's':
            seed = number(optarg);
            break;
        case 'n':
            streams = number(optarg);
            break;
        default:
            return 2;
        }
    const size_t count = sizeof configs / sizeof *configs;
    printf("seed %" PRIu64 "\n", seed);
    if (only) /* run_config says so if there is none of this name */
        return run_config(argv[0], only, seed, instructions, streams);
    int code = 0;
    for (size_t i = 0; i < count; i++)
        code |= run_config(argv[0], configs[i], seed, (instructions + count - 1) / count, streams);
    return code;
}
