/* scheduler.c - what the scheduler makes computes the same, in the cycles that it says, and in few.
 *
 *     scheduler steps|integrators [--config NAME] [--registers N] [--seed S] [--count N] [--rtl N]
 *                                 [--limit OPERATIONS] [--verbose]
 *     scheduler lines [--config NAME] [--seed S] [--count N]
 *     scheduler ship|rows [--config NAME]
 *     scheduler large [--config NAME] [--registers N] [--seed S] [--count N] [--limit OPERATIONS]
 *
 * steps: random steps, scheduled, executed in C, and every Nth one on the hardware, bits and
 * cycles. integrators: likewise, steps as a Runge-Kutta method makes them. lines: random
 * instructions, no scheduler, the hardware's cycles against the prediction. ship: the ship's step.
 * rows: batches that are not full. large: how long the scheduler takes.
 */
#include "../cosim/chance.h"

#include <fp3/engine.h>
#include <getopt.h>
#include <inttypes.h>
#include <isa.h>
#include <machine/cycles.h>
#include <machine/operation.h>
#include <math.h>
#include <schedule/code.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { VARIABLES_MAX = 40, PARAMS_MAX = 6, CONSTANTS_MAX = 6, OPS_MAX = 1000, REGISTERS = 64 };

#define MINUS_ZERO 0x80000000u

typedef struct {
    chance c;
    fp3_op first[OPS_MAX], step[OPS_MAX], last[OPS_MAX];
    fp3_variable variables[VARIABLES_MAX];
    uint32_t start[VARIABLES_MAX], params[PARAMS_MAX], constants[CONSTANTS_MAX + 1];
    fp3_step s;
    int is_hashed;  /* operations give numbers that depend on all that went in, no sums */
    int is_special; /* has operations that this file does not know */
} sample;

typedef struct {
    const fp3_config *config;
    uint64_t seed;
    uint32_t count, rtl, limit, objects;
    unsigned failed;
    double worst, sum; /* cycles over bound */
    int is_integrator, is_verbose;
    uint32_t scheduled, refused, measured, copies, ahead;
} bench;

static void fail(bench *b, uint64_t seed, const char *what) {
    if (b->failed++ < 10)
        printf("FAIL %s: %s; repeat with --seed %" PRIu64 " --count 1 --rtl 1\n", b->config->name,
               what, seed);
}

/* ---- arithmetic ---- */

static float value_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return isnan(value) ? 0x7fc00000u : bits;
}

/* A sum with -0.0 is a copy, whatever the rest is. */
static uint32_t hash(uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    chance h = {.state = op};
    if (op == FP3_OP_ADD && b == MINUS_ZERO)
        return a;
    h.state = next64(&h) ^ a;
    h.state = next64(&h) ^ b;
    h.state = next64(&h) ^ c;
    return (uint32_t)next64(&h);
}

static uint32_t calculate(const sample *t, uint32_t op, uint32_t a_bits, uint32_t b_bits,
                          uint32_t c_bits) {
    if (t->is_hashed)
        return hash(op, a_bits, b_bits, c_bits);
    const float a = value_of(a_bits), b = value_of(b_bits), c = value_of(c_bits);
    volatile float product = a * b;
    switch (op) {
    case FP3_OP_ADD:
        return bits_of(a + b);
    case FP3_OP_SUB:
        return bits_of(a - b);
    case FP3_OP_MUL:
        return bits_of(product);
    case FP3_OP_MADD:
        return bits_of(c + product);
    case FP3_OP_MSUB:
        return bits_of(c - product);
    default:
        abort();
    }
}

/* ---- a step, evaluated as it stands ---- */

typedef struct {
    const sample *t;
    const uint32_t *variables; /* as they are named by VARIABLE and NEXT */
    uint32_t values[OPS_MAX];  /* of the part's operations */
} evaluation;

static uint32_t look_up(const evaluation *e, fp3_ref ref) {
    switch (ref.at) {
    case FP3_AT_NOWHERE:
        return 0;
    case FP3_AT_VARIABLE:
    case FP3_AT_NEXT:
        return e->variables[ref.index];
    case FP3_AT_PARAM:
        return e->t->params[ref.index];
    case FP3_AT_CONSTANT:
        return e->t->constants[ref.index];
    default:
        return e->values[ref.index];
    }
}

static void evaluate(evaluation *e, const fp3_op *ops, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        e->values[i] = calculate(e->t, ops[i].op, look_up(e, ops[i].a), look_up(e, ops[i].b),
                                 look_up(e, ops[i].c));
}

/* The variables of the part that follow from those of e. which: 0 first, 1 next, 2 last. */
static void assign(const evaluation *e, int which, uint32_t *to) {
    uint32_t made[VARIABLES_MAX] = {0};
    for (uint32_t x = 0; x < e->t->s.variable_count; x++) {
        const fp3_variable *v = &e->t->variables[x];
        const fp3_ref ref = which == 0 ? v->first : which == 1 ? v->next : v->last;
        made[x] = ref.at == FP3_AT_NOWHERE ? e->variables[x] : look_up(e, ref);
    }
    memcpy(to, made, sizeof made);
}

/* after[]: all variables after the steps; ended[]: after the last part, too. */
static void reference(const sample *t, uint32_t steps, uint32_t *after, uint32_t *ended) {
    static evaluation e;
    e = (evaluation){.t = t, .variables = after};
    memcpy(after, t->start, sizeof t->start);
    evaluate(&e, t->first, t->s.first_count);
    assign(&e, 0, after);
    for (uint32_t i = 0; i < steps; i++) {
        evaluate(&e, t->step, t->s.step_count);
        assign(&e, 1, after);
    }
    evaluate(&e, t->last, t->s.last_count);
    assign(&e, 2, ended);
}

/* ---- lines, executed ---- */

/* Operands that an operation has: "dab" has two. */
static uint32_t operands_of(uint32_t op) {
    return (uint32_t)strlen(fp3_operation_find(op)->operands) - 1;
}

static uint32_t fetch(const sample *t, const uint32_t *registers, const fp3_line *line,
                      uint32_t k) {
    const uint32_t operand = line->operand[k];
    if (k >= operands_of(line->op))
        return 0;
    return operand < FP3_BANK_SHARED_BASE ? registers[operand]
                                          : t->constants[operand - FP3_BANK_SHARED_BASE];
}

static void execute(const sample *t, const fp3_line *lines, uint32_t count, uint32_t *registers) {
    for (uint32_t i = 0; i < count; i++)
        registers[lines[i].d] =
            calculate(t, lines[i].op, fetch(t, registers, &lines[i], 0),
                      fetch(t, registers, &lines[i], 1), fetch(t, registers, &lines[i], 2));
}

/* What no host has written is something else in every register. */
static void fill(const sample *t, uint32_t *registers) {
    for (uint32_t r = 0; r < REGISTERS; r++)
        registers[r] = 0x43000000u + (r << 16);
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        if (t->variables[x].first.at == FP3_AT_NOWHERE)
            registers[x] = t->start[x];
    memcpy(registers + t->s.variable_count, t->params, t->s.param_count * sizeof *registers);
}

static int is_within(const fp3_schedule *s, const fp3_config *config, const sample *t,
                     const fp3_line *lines, uint32_t count) {
    const uint32_t params = t->s.variable_count, temps = params + t->s.param_count;
    for (uint32_t i = 0; i < count; i++) {
        if (lines[i].d >= s->registers || (lines[i].d >= params && lines[i].d < temps))
            return 0;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t operand = lines[i].operand[k];
            if (k >= operands_of(lines[i].op)    ? operand != 0
                : operand < FP3_BANK_SHARED_BASE ? operand >= s->registers
                                                 : operand - FP3_BANK_SHARED_BASE >= s->constants)
                return 0;
        }
    }
    return s->registers <= config->registers;
}

static const char *check_lines(const bench *b, const sample *t, const fp3_schedule *s) {
    uint32_t registers[REGISTERS], after[VARIABLES_MAX], ended[VARIABLES_MAX];
    if (s->registers > REGISTERS || !is_within(s, b->config, t, s->first, s->first_count) ||
        !is_within(s, b->config, t, s->step, s->step_count) ||
        !is_within(s, b->config, t, s->last, s->last_count))
        return "a register that is not there";
    for (uint32_t steps = 1; steps <= 5; steps += 2) {
        reference(t, steps, after, ended);
        fill(t, registers);
        execute(t, s->first, s->first_count, registers);
        for (uint32_t i = 0; i < steps; i++)
            execute(t, s->step, s->step_count, registers);
        if (memcmp(registers, after, t->s.variable_count * sizeof *after) != 0)
            return "other bits after the steps";
        if (memcmp(registers + t->s.variable_count, t->params,
                   t->s.param_count * sizeof *registers) != 0)
            return "a param changes";
        execute(t, s->last, s->last_count, registers);
        for (uint32_t x = 0; x < t->s.variable_count; x++)
            if (t->variables[x].first.at == FP3_AT_NOWHERE && registers[x] != ended[x])
                return "other bits after the last part";
    }
    return NULL;
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
    fp3_status status = fp3_engine_open(&def, engine);
    if (!status)
        status = fp3_engine_load(*engine, image);
    for (size_t object = 0; !status && object < fp3_engine_objects(*engine); object++) {
        for (uint32_t x = 0; !status && x < t->s.variable_count; x++)
            if (t->variables[x].first.at == FP3_AT_NOWHERE) {
                const float value = value_of(t->start[x]);
                status = fp3_engine_write(*engine, object, 1, x, &value);
            }
        for (uint32_t p = 0; !status && p < t->s.param_count; p++) {
            const float value = value_of(t->params[p]);
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
            if (bits_of(value) != bits_of(value_of(ended[x])))
                *wrong = "the hardware has other bits";
        }
    const uint64_t predicted = fp3_schedule_cycles(s, b->config, steps);
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

/* ---- random steps ---- */

static uint32_t number(chance *c) {
    return below(c, 16) ? 0x3f000000u + below(c, 0x01000000) + (below(c, 2) << 31) : value(c);
}

/* before: how many operations may be named; reach: how far back, mostly. */
static fp3_ref any_ref(sample *t, fp3_place op_at, fp3_place variable_at, uint32_t before,
                       uint32_t reach) {
    chance *c = &t->c;
    for (;;)
        switch (below(c, 8)) {
        default:
            if (before) {
                const uint32_t back = below(c, 8) && reach < before ? reach : before;
                return (fp3_ref){op_at, before - 1 - below(c, back)};
            }
            break;
        case 0:
        case 1:
            if (t->s.variable_count)
                return (fp3_ref){variable_at, below(c, t->s.variable_count)};
            break;
        case 2:
            if (t->s.param_count && below(c, 2))
                return (fp3_ref){FP3_AT_PARAM, below(c, t->s.param_count)};
            if (t->s.constant_count)
                return (fp3_ref){FP3_AT_CONSTANT, below(c, t->s.constant_count)};
        }
}

static uint32_t random_kind(sample *t, const fp3_config *config) {
    static const uint32_t kinds[] = {FP3_OP_ADD, FP3_OP_SUB,  FP3_OP_MUL,
                                     FP3_OP_MUL, FP3_OP_MADD, FP3_OP_MSUB};
    static const uint32_t specials[] = {FP3_OP_MIN, FP3_OP_ABS, FP3_OP_LT,
                                        FP3_OP_SEL, FP3_OP_RCP, FP3_OP_RSQRT};
    if (config->select && config->estimate && below(&t->c, 6) == 0) {
        t->is_special = 1;
        return specials[below(&t->c, 6)];
    }
    return kinds[below(&t->c, config->chain ? 6 : 4)];
}

static void random_ops(sample *t, const fp3_config *config, fp3_op *ops, uint32_t count,
                       fp3_place op_at, fp3_place variable_at) {
    const uint32_t reach = 1 + below(&t->c, 2 + below(&t->c, 40));
    for (uint32_t i = 0; i < count; i++) {
        ops[i] = (fp3_op){.op = random_kind(t, config), .note = i};
        fp3_ref *refs[3] = {&ops[i].a, &ops[i].b, &ops[i].c};
        for (uint32_t k = 0; k < operands_of(ops[i].op); k++)
            *refs[k] = any_ref(t, op_at, variable_at, i, reach);
    }
}

/* The first part reads states alone. */
static void read_states(const sample *t, fp3_ref *ref) {
    if (ref->at == FP3_AT_VARIABLE && t->variables[ref->index].first.at != FP3_AT_NOWHERE)
        *ref = (fp3_ref){FP3_AT_CONSTANT, 0};
}

static void random_variables(sample *t) {
    chance *c = &t->c;
    const int has_first = t->s.first_count && below(c, 2);
    for (uint32_t x = 0; x < t->s.variable_count; x++) {
        fp3_variable *v = &t->variables[x];
        *v = (fp3_variable){.next = {FP3_AT_VARIABLE, x}};
        if (below(c, 8))
            v->next = (fp3_ref){FP3_AT_OP, t->s.step_count - 1 - below(c, t->s.step_count)};
        else if (below(c, 4))
            v->next = any_ref(t, FP3_AT_OP, FP3_AT_VARIABLE, t->s.step_count, 10);
        if (has_first && x % 3 == 2)
            v->first = below(c, 4) ? (fp3_ref){FP3_AT_FIRST, below(c, t->s.first_count)}
                                   : any_ref(t, FP3_AT_FIRST, FP3_AT_VARIABLE, 1, 1);
        else if (t->s.last_count && !below(c, 4))
            v->last = (fp3_ref){FP3_AT_LAST, below(c, t->s.last_count)};
    }
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        read_states(t, &t->variables[x].first);
    for (uint32_t i = 0; i < t->s.first_count; i++) {
        read_states(t, &t->first[i].a);
        read_states(t, &t->first[i].b);
        read_states(t, &t->first[i].c);
    }
}

static void random_sample(sample *t, const fp3_config *config, uint64_t seed, uint32_t limit) {
    memset(t, 0, sizeof *t);
    t->c = (chance){.state = seed};
    chance *c = &t->c;
    fp3_step *s = &t->s;
    *s = (fp3_step){.first = t->first, .step = t->step, .last = t->last, .variables = t->variables};
    const uint32_t most = below(c, 2) ? 12 : limit;
    s->step_count = 1 + below(c, most);
    s->variable_count = below(c, 2) ? below(c, 6) : below(c, config->registers * 5 / 8 + 1);
    s->param_count = below(c, PARAMS_MAX + 1);
    s->constant_count = 1 + below(c, CONSTANTS_MAX);
    s->first_count = below(c, 2) ? 0 : below(c, 12);
    s->last_count = below(c, 2) ? 0 : below(c, 12);
    s->minus_zero = below(c, 2) ? 0 : FP3_NONE_INDEX;
    s->allow_ahead = below(c, 4) != 0;
    for (uint32_t i = 0; i < VARIABLES_MAX; i++)
        t->start[i] = number(c);
    for (uint32_t i = 0; i < PARAMS_MAX; i++)
        t->params[i] = number(c);
    for (uint32_t i = 0; i <= CONSTANTS_MAX; i++)
        t->constants[i] = i == 0 && s->minus_zero == 0 ? MINUS_ZERO : number(c);
    t->constants[s->constant_count] = s->minus_zero ? MINUS_ZERO : t->constants[s->constant_count];
    random_ops(t, config, t->first, s->first_count, FP3_AT_FIRST, FP3_AT_VARIABLE);
    random_ops(t, config, t->step, s->step_count, FP3_AT_OP, FP3_AT_VARIABLE);
    random_ops(t, config, t->last, s->last_count, FP3_AT_LAST, FP3_AT_NEXT);
    random_variables(t);
}

/* ---- steps as an integrator makes them ---- */

static fp3_ref add_op(sample *t, uint32_t op, fp3_ref a, fp3_ref b, fp3_ref c) {
    if (t->s.step_count == OPS_MAX)
        abort();
    t->step[t->s.step_count] = (fp3_op){op, a, b, c, t->s.step_count};
    return (fp3_ref){FP3_AT_OP, t->s.step_count++};
}

/* y + a * x, chained if that can be. */
static fp3_ref add_multiple(sample *t, const fp3_config *config, fp3_ref y, fp3_ref a, fp3_ref x) {
    if (config->chain)
        return add_op(t, FP3_OP_MADD, a, x, y);
    return add_op(t, FP3_OP_ADD, y, add_op(t, FP3_OP_MUL, a, x, (fp3_ref){0}), (fp3_ref){0});
}

/* A derivative: some operations on states of a stage, params, constants and each other. */
static fp3_ref add_derivative(sample *t, const fp3_config *config, const fp3_ref *states,
                              uint32_t seed, uint32_t length) {
    chance c = {.state = seed}; /* the same formula in each stage */
    fp3_ref value = states[below(&c, t->s.variable_count)];
    for (uint32_t i = 0; i < length; i++) {
        const fp3_ref other = below(&c, 2) ? states[below(&c, t->s.variable_count)]
                                           : (fp3_ref){FP3_AT_PARAM, below(&c, t->s.param_count)};
        const fp3_ref third = states[below(&c, t->s.variable_count)];
        switch (below(&c, 4)) {
        case 0:
            value = add_op(t, FP3_OP_SUB, other, value, (fp3_ref){0});
            break;
        case 1:
            value = add_multiple(t, config, value, other, third);
            break;
        case 2:
            value = add_multiple(t, config, other, value, third);
            break;
        default:
            value = add_op(t, FP3_OP_MUL, value, other, (fp3_ref){0});
        }
    }
    return value;
}

/* y' = y + h (b1 k1 + b2 k2 ..), ki of y + h (a1 k1 ..), with some coefficients 0. */
static void integrator_sample(sample *t, const fp3_config *config, uint64_t seed, uint32_t limit) {
    fp3_ref states[VARIABLES_MAX], k[4][VARIABLES_MAX];
    random_sample(t, config, seed, 1);
    chance *c = &t->c;
    fp3_step *s = &t->s;
    s->first_count = s->last_count = s->step_count = 0;
    s->allow_ahead = 1;
    s->constant_count = CONSTANTS_MAX;
    t->constants[CONSTANTS_MAX] = MINUS_ZERO;
    s->minus_zero = FP3_NONE_INDEX;
    s->param_count = 1 + below(c, PARAMS_MAX);
    s->variable_count = 1 + below(c, below(c, 3) ? 4 : 12);
    const uint32_t stages = 1 + below(c, 4), formula = below(c, 1u << 30);
    uint32_t length = limit / stages / s->variable_count;
    length = 1 + below(c, length > 40 ? 32 : length > 8 ? length - 7 : 1);
    for (uint32_t i = 0; i < stages; i++)
        for (uint32_t x = 0; x < s->variable_count; x++) {
            fp3_ref y = {FP3_AT_VARIABLE, x};
            for (uint32_t j = 0; j < i; j++)
                if (j + 1 == i || below(c, 3) == 0)
                    y = add_multiple(t, config, y, (fp3_ref){FP3_AT_CONSTANT, 1 + j}, k[j][x]);
            states[x] = y;
            if (x + 1 == s->variable_count)
                for (uint32_t z = 0; z <= x; z++)
                    k[i][z] = add_derivative(t, config, states, formula + z, length);
        }
    for (uint32_t x = 0; x < s->variable_count; x++) {
        fp3_ref y = {FP3_AT_VARIABLE, x};
        for (uint32_t j = 0; j < stages; j++)
            y = add_multiple(t, config, y, (fp3_ref){FP3_AT_CONSTANT, 1 + j}, k[j][x]);
        t->variables[x] = (fp3_variable){.next = y};
    }
}

static void one_step(bench *b, sample *t, uint64_t seed, int is_rtl) {
    fp3_schedule *s = NULL;
    fp3_error error;
    (b->is_integrator ? integrator_sample : random_sample)(t, b->config, seed, b->limit);
    fp3_status status = fp3_schedule_make(&t->s, b->config, &s, &error);
    if (status == FP3_E_LIMIT) {
        b->refused++;
        return;
    }
    const char *wrong = status ? error.text : t->is_special ? NULL : check_lines(b, t, s);
    t->is_hashed = 1;
    if (!wrong)
        wrong = check_lines(b, t, s);
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
           " runs measured; cycles over bound: mean %.4f, worst %.4f; copies %u, ahead %u\n",
           b->config->name, b->count, b->refused, b->measured,
           b->scheduled ? b->sum / b->scheduled : 1, b->worst, b->copies, b->ahead);
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

static fp3_ref at(fp3_place place, uint32_t index) { return (fp3_ref){place, index}; }

/* programs/ship_madd.s as operations in the order of the equations. Nothing is ahead, nothing is
 * chained from step to step: that is the scheduler's work. */
static void ship_sample(sample *t) {
    const fp3_ref v = at(FP3_AT_VARIABLE, 0), s = at(FP3_AT_VARIABLE, 1);
    const fp3_ref T = at(FP3_AT_PARAM, 0), C = at(FP3_AT_PARAM, 1), rm = at(FP3_AT_PARAM, 2);
    const fp3_ref h = at(FP3_AT_CONSTANT, 0), half = at(FP3_AT_CONSTANT, 1),
                  two = at(FP3_AT_CONSTANT, 2), sixth = at(FP3_AT_CONSTANT, 3);
    const fp3_op ops[] = {
        {FP3_OP_MSUB, C, v, T, 0},                                   /* 0 F */
        {FP3_OP_MUL, at(FP3_AT_OP, 0), rm, {0}, 0},                  /* 1 a */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 1), {0}, 0},                   /* 2 k1 */
        {FP3_OP_MADD, half, at(FP3_AT_OP, 2), v, 0},                 /* 3 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 3), T, 0},                    /* 4 */
        {FP3_OP_MUL, at(FP3_AT_OP, 4), rm, {0}, 0},                  /* 5 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 5), {0}, 0},                   /* 6 k2 */
        {FP3_OP_MADD, half, at(FP3_AT_OP, 6), v, 0},                 /* 7 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 7), T, 0},                    /* 8 */
        {FP3_OP_MUL, at(FP3_AT_OP, 8), rm, {0}, 0},                  /* 9 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 9), {0}, 0},                   /* 10 k3 */
        {FP3_OP_ADD, v, at(FP3_AT_OP, 10), {0}, 0},                  /* 11 */
        {FP3_OP_MSUB, C, at(FP3_AT_OP, 11), T, 0},                   /* 12 */
        {FP3_OP_MUL, at(FP3_AT_OP, 12), rm, {0}, 0},                 /* 13 */
        {FP3_OP_MUL, h, at(FP3_AT_OP, 13), {0}, 0},                  /* 14 k4 */
        {FP3_OP_MADD, two, at(FP3_AT_OP, 6), at(FP3_AT_OP, 2), 0},   /* 15 */
        {FP3_OP_MADD, two, at(FP3_AT_OP, 10), at(FP3_AT_OP, 15), 0}, /* 16 */
        {FP3_OP_ADD, at(FP3_AT_OP, 16), at(FP3_AT_OP, 14), {0}, 0},  /* 17 */
        {FP3_OP_MADD, sixth, at(FP3_AT_OP, 17), v, 0},               /* 18 v1 */
        {FP3_OP_MADD, h, at(FP3_AT_OP, 18), s, 0},                   /* 19 s1 */
    };
    memset(t, 0, sizeof *t);
    memcpy(t->step, ops, sizeof ops);
    t->s = (fp3_step){.first = t->first, .step = t->step, .last = t->last};
    t->s.variables = t->variables;
    t->s.step_count = sizeof ops / sizeof *ops;
    t->s.variable_count = 2;
    t->s.param_count = 3;
    t->s.constant_count = 4;
    t->s.minus_zero = FP3_NONE_INDEX;
    t->s.allow_ahead = 1;
    t->variables[0].next = at(FP3_AT_OP, 18);
    t->variables[1].next = at(FP3_AT_OP, 19);
    const float params[] = {1.2e6f, 5e4f, 4e-7f}, constants[] = {0.0078125f, 0.5f, 2, 0.16666667f};
    memcpy(t->params, params, sizeof params);
    memcpy(t->constants, constants, sizeof constants);
    t->constants[4] = MINUS_ZERO;
}

/* Without chaining a madd is a mul and an add. */
static void unchain(sample *t) {
    static fp3_op ops[OPS_MAX];
    uint32_t now[OPS_MAX] = {0}, count = 0;
    for (uint32_t i = 0; i < t->s.step_count; i++) {
        fp3_op op = t->step[i];
        fp3_ref *refs[3] = {&op.a, &op.b, &op.c};
        for (int k = 0; k < 3; k++)
            if (refs[k]->at == FP3_AT_OP)
                refs[k]->index = now[refs[k]->index];
        if (op.op == FP3_OP_MADD || op.op == FP3_OP_MSUB) {
            ops[count] = (fp3_op){FP3_OP_MUL, op.a, op.b, {0}, 0};
            op = (fp3_op){op.op == FP3_OP_MADD ? FP3_OP_ADD : FP3_OP_SUB,
                          op.c,
                          at(FP3_AT_OP, count++),
                          {0},
                          0};
        }
        now[i] = count;
        ops[count++] = op;
    }
    memcpy(t->step, ops, count * sizeof *ops);
    t->s.step_count = count;
    for (uint32_t x = 0; x < t->s.variable_count; x++)
        t->variables[x].next.index = now[t->variables[x].next.index];
}

static void ship(bench *b) {
    static sample t;
    fp3_schedule *s = NULL;
    fp3_error error;
    ship_sample(&t);
    if (!b->config->chain)
        unchain(&t);
    fp3_status status = fp3_schedule_make(&t.s, b->config, &s, &error);
    const char *wrong = status ? error.text : check_lines(b, &t, s);
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

static const char *check_objects(bench *b, const sample *t, const fp3_schedule *s, uint32_t rows) {
    static fp3_error error;
    static char text[128];
    fp3_image *image = NULL;
    fp3_engine *engine = NULL;
    fp3_stats stats = {0};
    b->objects = rows * b->config->lanes * fp3_config_schedulers(b->config);
    fp3_status status = make_image(t, s, &image, &error);
    if (!status)
        status = open_with(b, t, image, &engine, &error);
    if (!status)
        status = fp3_engine_run(engine, 3, &stats);
    const uint64_t words =
        s->loads + s->first_count + 3 * s->step_count + s->last_count + s->stores;
    const uint64_t predicted = fp3_cycles_interleaved(b->config, rows, words);
    snprintf(text, sizeof text, "%" PRIu32 " rows: %" PRIu64 " cycles, predicted %" PRIu64, rows,
             stats.counter[FP3_COUNTER_CYCLES], predicted);
    fp3_engine_close(&engine);
    fp3_image_free(&image);
    b->measured++;
    b->objects = 0;
    return status ? error.text : predicted != stats.counter[FP3_COUNTER_CYCLES] ? text : NULL;
}

static void rows(bench *b) {
    static sample t;
    fp3_schedule *s = NULL;
    fp3_error error;
    ship_sample(&t);
    if (fp3_schedule_make(&t.s, b->config, &s, &error))
        fail(b, 0, error.text);
    for (uint32_t n = 1; s && n <= 3 * b->config->contexts && 8 * n <= b->config->store_words;
         n++) {
        const char *wrong = check_objects(b, &t, s, n);
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
    static const struct option options[] = {
        {"config", required_argument, NULL, 'c'},    {"seed", required_argument, NULL, 's'},
        {"count", required_argument, NULL, 'n'},     {"rtl", required_argument, NULL, 'r'},
        {"registers", required_argument, NULL, 'g'}, {"verbose", no_argument, NULL, 'v'},
        {"limit", required_argument, NULL, 'l'},     {0}};
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
