/* scheduler.c - what the scheduler makes computes the same, in the cycles that it says, and in few.
 *
 *     scheduler steps|integrators [--config NAME] [--registers N] [--seed S] [--count N] [--rtl N]
 *                                 [--limit OPERATIONS] [--spill] [--verbose]
 *     scheduler lines [--config NAME] [--seed S] [--count N]
 *     scheduler ship|rows [--config NAME]
 *     scheduler large [--config NAME] [--registers N] [--seed S] [--count N] [--limit OPERATIONS]
 *
 * steps: random steps, scheduled, executed in C, and every Nth one on the hardware, bits and
 * cycles. integrators: likewise, steps as a Runge-Kutta method makes them. lines: random
 * instructions, no scheduler, the hardware's cycles against the prediction. ship: the ship's step.
 * rows: batches that are not full. --spill: values may be stored and loaded within the step. large:
 * how long the scheduler takes.
 */
#include "step_check.h"

#include <compiler/schedule/cost.h>
#include <compiler/schedule/schedule.h>
#include <fp3/engine.h>
#include <fp3/isa.h>
#include <getopt.h>
#include <inttypes.h>
#include <machine/cycles.h>
#include <stdio.h>
#include <time.h>

typedef struct {
    const fp3_config *config;
    uint64_t seed;
    uint32_t count, rtl, limit, objects, visit;
    unsigned failed;
    double worst, sum; /* cycles over bound */
    int is_integrator, is_verbose, may_spill;
    uint32_t scheduled, refused, measured, copies, ahead, spills;
} bench;

static void fail(bench *b, uint64_t seed, const char *what) {
    if (b->failed++ < 10)
        printf("FAIL %s: %s; repeat with --seed %" PRIu64 " --count 1 --rtl 1\n", b->config->name,
               what, seed);
}

/* ---- on the hardware ---- */

static uint32_t word_of(const fp3_line *line) {
    return fp3_word_encode(&(fp3_instruction){line->op, line->d, line->operand[0], line->operand[1],
                                              line->operand[2]});
}

/* States have names, so that a visit loads and stores them; temps say what they are. */
static fp3_status make_image(const sample *t, const fp3_schedule *s, fp3_image **image,
                             fp3_error *error) {
    static uint32_t code[3 * OPS_MAX];
    static fp3_symbol symbols[REGISTERS];
    fp3_constant constants[CONSTANTS_MAX + 1];
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->first_count; i++)
        code[count++] = word_of(&s->first[i]);
    for (uint32_t i = 0; i < s->step_count; i++)
        code[count++] = word_of(&s->step[i]);
    for (uint32_t i = 0; i < s->last_count; i++)
        code[count++] = word_of(&s->last[i]);
    for (uint32_t i = 0; i < s->constants; i++)
        constants[i] = (fp3_constant){i, t->constants[i]};
    for (uint32_t r = 0; r < s->registers; r++) {
        const uint32_t params = t->s.variable_count;
        symbols[r].symbol_class = r >= params && r < params + t->s.param_count ? FP3_SYMBOL_PARAM
                                  : r < params && t->variables[r].first.at == FP3_AT_NOWHERE
                                      ? FP3_SYMBOL_STATE
                                      : FP3_SYMBOL_TEMP;
        symbols[r].index = r;
        snprintf(symbols[r].name, sizeof symbols[r].name, "x%" PRIu32, r);
    }
    const fp3_image draft = {.code_count = count,
                             .step = s->first_count,
                             .last = s->first_count + s->step_count,
                             .constant_count = s->constants,
                             .symbol_count = s->registers,
                             .code = code,
                             .constants = constants,
                             .symbols = symbols};
    return fp3_image_make(&draft, image, error);
}

static fp3_status open_with(const bench *b, const sample *t, const fp3_image *image,
                            fp3_engine **engine, fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    def.config = b->config->name;
    def.error = error;
    def.objects = b->objects;
    def.visit = b->visit;
    fp3_status status = fp3_engine_open(&def, engine);
    if (!status)
        status = fp3_engine_load(*engine, image);
    for (size_t object = 0; !status && object < fp3_engine_objects(*engine); object++) {
        for (uint32_t x = 0; !status && x < t->s.variable_count; x++)
            if (t->variables[x].first.at == FP3_AT_NOWHERE) {
                const float value = fp3_value_of(t->start[x]);
                status = fp3_engine_write(*engine, object, 1, x, &value);
            }
        for (uint32_t p = 0; !status && p < t->s.param_count; p++) {
            const float value = fp3_value_of(t->params[p]);
            status = fp3_engine_write(*engine, object, 1, t->s.variable_count + p, &value);
        }
    }
    return status;
}

/* The states of every object after a run, and its cycles. */
static fp3_status compare_run(bench *b, const sample *t, const fp3_schedule *s, fp3_engine *engine,
                              uint32_t steps, const char **wrong) {
    uint32_t after[VARIABLES_MAX], ended[VARIABLES_MAX];
    fp3_stats stats;
    fp3_status status = fp3_engine_run(engine, steps, &stats);
    if (!t->is_special)
        reference(t, steps, after, ended);
    for (size_t object = 0; !status && !t->is_special && object < fp3_engine_objects(engine);
         object++)
        for (uint32_t x = 0; !status && x < t->s.variable_count; x++) {
            float value = 0;
            if (t->variables[x].first.at != FP3_AT_NOWHERE)
                continue;
            status = fp3_engine_read(engine, object, 1, x, &value);
            if (bits_of(value) != bits_of(fp3_value_of(ended[x])))
                *wrong = "the hardware has other bits";
        }
    const uint64_t predicted = fp3_cost_cycles(s, b->config, steps);
    if (!status && predicted && predicted != stats.counter[FP3_COUNTER_CYCLES]) {
        static char text[128];
        snprintf(text, sizeof text,
                 "%" PRIu32 " steps: the hardware takes %" PRIu64 " cycles, predicted %" PRIu64,
                 steps, stats.counter[FP3_COUNTER_CYCLES], predicted);
        *wrong = text;
    }
    b->measured += predicted != 0;
    return status;
}

static const char *check_rtl(bench *b, const sample *t, const fp3_schedule *s) {
    static fp3_error error;
    const char *wrong = NULL;
    for (uint32_t steps = 1; !wrong && steps <= 40; steps = steps < 6 ? steps + 1 : steps * 4) {
        fp3_image *image = NULL;
        fp3_engine *engine = NULL;
        fp3_status status = make_image(t, s, &image, &error);
        if (!status)
            status = open_with(b, t, image, &engine, &error);
        if (!status)
            status = compare_run(b, t, s, engine, steps, &wrong);
        if (status)
            wrong = error.text;
        fp3_engine_close(&engine);
        fp3_image_free(&image);
    }
    return wrong;
}

/* ---- random steps, and steps as an integrator makes them ---- */

static void one_step(bench *b, sample *t, uint64_t seed, int is_rtl) {
    fp3_schedule *s = NULL;
    fp3_error error;
    (b->is_integrator ? integrator_sample : random_sample)(t, b->config, seed, b->limit);
    t->s.may_spill = b->may_spill;
    fp3_status status = fp3_schedule_make(&t->s, b->config, &s, &error);
    if (status == FP3_E_LIMIT || (b->may_spill && status == FP3_E_PROGRAM)) {
        b->refused++;
        return;
    }
    const char *wrong = status ? error.text : t->is_special ? NULL : check_lines(b->config, t, s);
    t->is_hashed = 1;
    if (!wrong)
        wrong = check_lines(b->config, t, s);
    t->is_hashed = 0;
    const uint32_t words = status ? 0 : s->first_count + s->step_count + s->last_count + 70;
    if (!wrong && is_rtl && words <= b->config->program_words)
        wrong = check_rtl(b, t, s);
    if (wrong)
        fail(b, seed, wrong);
    if (!status && s->bound > 0 && s->cycles > 0) {
        const double ratio = s->cycles / s->bound;
        if (ratio < 0.999999)
            fail(b, seed, "fewer cycles than the bound");
        if (ratio > b->worst)
            b->worst = ratio;
        b->sum += ratio;
        b->scheduled++;
        b->copies += s->copies;
        b->ahead += s->ahead;
        b->spills += s->spills;
        if (b->is_verbose)
            printf("%" PRIu64 ": %" PRIu32 " operations, %" PRIu32 " variables, %" PRIu32
                   " registers, %.3f cycles, bounds %.1f %.3f, %" PRIu32 " copies, %" PRIu32
                   " ahead, %.3f\n",
                   seed, t->s.step_count, t->s.variable_count, s->registers, s->cycles,
                   s->bound_issue, s->bound_path, s->copies, s->ahead, ratio);
    }
    fp3_schedule_free(&s);
}

static void steps(bench *b) {
    static sample t;
    for (uint32_t i = 0; i < b->count; i++)
        one_step(b, &t, b->seed + i, b->rtl && i % b->rtl == 0);
    printf("%s: %" PRIu32 " steps, %" PRIu32 " need more registers, %" PRIu32
           " runs measured; cycles over bound: mean %.4f, worst %.4f; copies %u, ahead %u, spills "
           "%u\n",
           b->config->name, b->count, b->refused, b->measured,
           b->scheduled ? b->sum / b->scheduled : 1, b->worst, b->copies, b->ahead, b->spills);
}

static void integrators(bench *b) {
    b->is_integrator = 1;
    steps(b);
}

/* ---- random instructions ---- */

static void random_lines(sample *t, const fp3_config *config, fp3_line *lines, uint32_t count,
                         uint32_t registers) {
    chance *c = &t->c;
    for (uint32_t i = 0; i < count; i++) {
        lines[i] = (fp3_line){.op = random_kind(t, config), .d = below(c, registers)};
        for (uint32_t k = 0; k < operands_of(lines[i].op); k++)
            lines[i].operand[k] =
                below(c, 3) ? below(c, registers) : FP3_BANK_SHARED_BASE + below(c, 4);
    }
}

static void lines(bench *b) {
    static sample t;
    static fp3_line code[3][OPS_MAX];
    for (uint32_t i = 0; i < b->count; i++) {
        t.c = (chance){.state = b->seed + i};
        fp3_schedule s = {.first = code[0], .step = code[1], .last = code[2], .constants = 4};
        s.registers = 2 + below(&t.c, b->config->registers - 2);
        s.first_count = below(&t.c, 3) ? 0 : below(&t.c, 20);
        s.step_count = 1 + below(&t.c, below(&t.c, 2) ? 5 : 60);
        s.last_count = below(&t.c, 3) ? 0 : below(&t.c, 20);
        random_lines(&t, b->config, s.first, s.first_count, s.registers);
        random_lines(&t, b->config, s.step, s.step_count, s.registers);
        random_lines(&t, b->config, s.last, s.last_count, s.registers);
        const char *wrong = check_rtl(b, &t, &s);
        if (wrong)
            fail(b, b->seed + i, wrong);
    }
    printf("%s: %" PRIu32 " programs, %" PRIu32 " runs measured\n", b->config->name, b->count,
           b->measured);
}

/* ---- the ship ---- */

static void ship(bench *b) {
    static sample t;
    fp3_schedule *s = NULL;
    fp3_error error;
    ship_sample(&t);
    if (!b->config->chain)
        unchain(&t);
    fp3_status status = fp3_schedule_make(&t.s, b->config, &s, &error);
    const char *wrong = status ? error.text : check_lines(b->config, &t, s);
    if (!wrong)
        wrong = check_rtl(b, &t, s);
    if (wrong)
        fail(b, 0, wrong);
    if (!status)
        printf("%s: %" PRIu32 " instructions, %.3f cycles, bound %.3f, %" PRIu32
               " registers, %" PRIu32 " copies, %" PRIu32 " ahead\n",
               b->config->name, s->step_count, s->cycles, s->bound, s->registers, s->copies,
               s->ahead);
    fp3_schedule_free(&s);
}

/* ---- batches that are not full ---- */

/* Three steps, in so many rounds: 1 or 3. */
static const char *check_objects(bench *b, const sample *t, const fp3_schedule *s, uint32_t rows,
                                 uint32_t rounds) {
    static fp3_error error;
    static char text[128];
    fp3_image *image = NULL;
    fp3_engine *engine = NULL;
    fp3_stats stats = {0};
    b->objects = rows * b->config->lanes * fp3_config_schedulers(b->config);
    b->visit = 3 / rounds;
    fp3_status status = make_image(t, s, &image, &error);
    if (!status)
        status = open_with(b, t, image, &engine, &error);
    if (!status)
        status = fp3_engine_run(engine, 3, &stats);
    /* Sweeps follow each other in turn here, so that their number counts alone. */
    const uint32_t in_step = s->step_count;
    const fp3_swept visit = {.count =
                                 s->loads + s->first_count + in_step + s->last_count + s->stores,
                             .last = in_step,
                             .steps = 3 / rounds};
    const uint64_t predicted = fp3_cycles_interleaved(b->config, rows, rounds, &visit);
    snprintf(text, sizeof text,
             "%" PRIu32 " rows, %" PRIu32 " rounds: %" PRIu64 " cycles, predicted %" PRIu64, rows,
             rounds, stats.counter[FP3_COUNTER_CYCLES], predicted);
    fp3_engine_close(&engine);
    fp3_image_free(&image);
    b->measured++;
    b->objects = b->visit = 0;
    return status ? error.text : predicted != stats.counter[FP3_COUNTER_CYCLES] ? text : NULL;
}

static void rows(bench *b) {
    static sample t;
    fp3_schedule *s = NULL;
    fp3_error error;
    ship_sample(&t);
    if (fp3_schedule_make(&t.s, b->config, &s, &error))
        fail(b, 0, error.text);
    const uint32_t every = b->rtl ? b->rtl : 1;
    for (uint32_t n = 1; s && n <= 3 * b->config->contexts && 8 * n <= b->config->store_words;
         n += every) {
        const char *wrong = check_objects(b, &t, s, n, 1);
        if (!wrong)
            wrong = check_objects(b, &t, s, n, 3);
        if (wrong)
            fail(b, n, wrong);
    }
    printf("%s: %" PRIu32 " runs measured\n", b->config->name, b->measured);
    fp3_schedule_free(&s);
}

/* ---- the scheduler's own time ---- */

static void large(bench *b) {
    static sample t;
    double worst = 0;
    for (uint32_t i = 0; i < b->count; i++) {
        random_sample(&t, b->config, b->seed + i, 1);
        t.s.step_count = b->limit;
        t.s.allow_ahead = 1;
        random_ops(&t, b->config, t.step, t.s.step_count, FP3_AT_OP, FP3_AT_VARIABLE);
        random_variables(&t);
        fp3_schedule *s = NULL;
        struct timespec begin, end;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
        const fp3_status status = fp3_schedule_make(&t.s, b->config, &s, NULL);
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
        const double ms = 1e3 * (double)(end.tv_sec - begin.tv_sec) +
                          1e-6 * (double)(end.tv_nsec - begin.tv_nsec);
        worst = ms > worst ? ms : worst;
        if (status && status != FP3_E_LIMIT)
            fail(b, b->seed + i, "large");
        fp3_schedule_free(&s);
    }
    printf("%s: %" PRIu32 " operations: at most %.1f ms\n", b->config->name, b->limit, worst);
}

int main(int argc, char **argv) {
    static const struct option options[] = {{"config", required_argument, NULL, 'c'},
                                            {"seed", required_argument, NULL, 's'},
                                            {"count", required_argument, NULL, 'n'},
                                            {"rtl", required_argument, NULL, 'r'},
                                            {"registers", required_argument, NULL, 'g'},
                                            {"verbose", no_argument, NULL, 'v'},
                                            {"limit", required_argument, NULL, 'l'},
                                            {"spill", no_argument, NULL, 'p'},
                                            {0}};
    static const struct {
        const char *name;
        void (*run)(bench *b);
    } modes[] = {{"steps", steps}, {"integrators", integrators},
                 {"lines", lines}, {"rows", rows},
                 {"ship", ship},   {"large", large}};
    bench b = {.seed = 1, .count = 20, .limit = 300};
    fp3_config changed = *fp3_config_find("single");
    b.config = &changed;
    for (int o; (o = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (o) {
        case 'c':
            if (!fp3_config_find(optarg))
                return 2;
            changed = *fp3_config_find(optarg);
            break;
        case 's':
            b.seed = strtoull(optarg, NULL, 0);
            break;
        case 'n':
            b.count = (uint32_t)strtoul(optarg, NULL, 0);
            break;
        case 'r':
            b.rtl = (uint32_t)strtoul(optarg, NULL, 0);
            break;
        case 'g':
            changed.registers = (uint32_t)strtoul(optarg, NULL, 0);
            break;
        case 'v':
            b.is_verbose = 1;
            break;
        case 'p':
            b.may_spill = 1;
            break;
        case 'l':
            b.limit = (uint32_t)strtoul(optarg, NULL, 0);
            break;
        default:
            return 2;
        }
    int found = 0;
    for (size_t i = 0; optind < argc && i < sizeof modes / sizeof *modes; i++)
        if (strcmp(argv[optind], modes[i].name) == 0) {
            found = 1;
            modes[i].run(&b);
        }
    return found ? b.failed != 0 : 2;
}
