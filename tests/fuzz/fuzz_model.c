/* fuzz_model.c - any bytes as a model: either it is refused with a report, or it keeps what
 * fp3/model.h promises and every stage behind the reader takes it.
 *
 *     fuzz_model FILE...       each file once (tests/fuzz/test_corpus.py)
 *
 * With -DFP3_LIBFUZZER it is the target of clang's libFuzzer (`make fuzz`). */
#include <fp3/compile.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REQUIRE(condition)                                                                         \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "fuzz_model.c:%d: not true: %s\n", __LINE__, #condition);              \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

static const unsigned char operand_count[] = {
#define X(NAME, operands, host) operands,
    FP3_EXPR_OPS(X)
#undef X
};

static const unsigned char is_host_only[] = {
#define X(NAME, operands, host) host,
    FP3_EXPR_OPS(X)
#undef X
};

/* What an expression depends on, one bit each. */
enum {
    HAS_STATE = 1,
    HAS_TIME = 2,
    HAS_INITIAL = 4,
    HAS_HOST_OF_STATE = 8,
    HAS_POWER_OF_STATE = 16
};

static void check_expressions(const fp3_model *m, unsigned char *has) {
    for (uint32_t i = 0; i < m->expr_count; i++) {
        const fp3_expr *e = &m->exprs[i];
        REQUIRE(e->op < FP3_EXPR_OP_COUNT && e->line > 0 && e->column > 0);
        unsigned of = 0;
        int is_known = e->op == FP3_EXPR_NUMBER || e->op == FP3_EXPR_PARAM || operand_count[e->op];
        for (unsigned j = 0; j < 3; j++) {
            if (j >= operand_count[e->op]) {
                REQUIRE(e->operand[j] == FP3_NONE);
                continue;
            }
            REQUIRE(e->operand[j] < i);
            of |= has[e->operand[j]];
            is_known &= m->exprs[e->operand[j]].is_known;
        }
        if (e->op == FP3_EXPR_STATE || e->op == FP3_EXPR_INITIAL)
            REQUIRE(e->index < m->state_count);
        if (e->op == FP3_EXPR_PARAM)
            REQUIRE(e->index < m->param_count);
        if (e->op == FP3_EXPR_NUMBER)
            REQUIRE(isfinite(e->number));
        REQUIRE(!e->is_known == !is_known);
        if (of & HAS_STATE && is_host_only[e->op])
            of |= HAS_HOST_OF_STATE;
        if (of & HAS_STATE && e->op == FP3_EXPR_POWER && !m->exprs[e->operand[1]].is_known)
            of |= HAS_POWER_OF_STATE;
        if (e->op == FP3_EXPR_STATE)
            of |= HAS_STATE;
        if (e->op == FP3_EXPR_TIME)
            of |= HAS_TIME;
        if (e->op == FP3_EXPR_INITIAL)
            of |= HAS_INITIAL;
        has[i] = (unsigned char)of;
    }
}

static void check_quantities(const fp3_quantity *q, uint32_t count) {
    REQUIRE(count <= 64);
    for (; count-- > 0; q++)
        REQUIRE(fp3_name_valid(q->name) && q->dimension && q->doc && isfinite(q->value) &&
                q->line > 0);
}

static void check_states(const fp3_model *m, const unsigned char *has) {
    check_quantities(m->states, m->state_count);
    REQUIRE(m->state_count > 0);
    for (uint32_t i = 0; i < m->state_count; i++) {
        const fp3_quantity *s = &m->states[i];
        REQUIRE(fp3_model_state(m, s->name) == i && fp3_model_param(m, s->name) == FP3_NONE);
        REQUIRE(s->derivative < m->expr_count);
        REQUIRE(!(has[s->derivative] & ~(HAS_STATE | HAS_TIME)));
        const fp3_expr *d = &m->exprs[s->derivative];
        int has_velocity = d->op == FP3_EXPR_STATE && d->index != i;
        REQUIRE(s->velocity == (has_velocity ? d->index : FP3_NONE));
        REQUIRE(s->exact == FP3_NONE || s->exact < m->expr_count);
        REQUIRE(s->exact == FP3_NONE || !(has[s->exact] & HAS_STATE));
    }
}

static void check_definitions(const fp3_model *m, const fp3_definition *d, uint32_t count,
                              const unsigned char *has, unsigned may_have) {
    for (; count-- > 0; d++) {
        REQUIRE(fp3_name_valid(d->name) && d->expr < m->expr_count && d->line > 0);
        REQUIRE(!(has[d->expr] & ~may_have));
    }
}

static void check_events(const fp3_model *m, const unsigned char *has) {
    uint32_t next = 0;
    for (uint32_t i = 0; i < m->event_count; i++) {
        const fp3_event *e = &m->events[i];
        uint64_t set = 0;
        REQUIRE(e->condition < m->expr_count && !(has[e->condition] & ~(HAS_STATE | HAS_TIME)));
        REQUIRE(e->first == next && (e->count > 0 || e->stops) && e->line > 0);
        next += e->count;
        REQUIRE(next <= m->assignment_count);
        for (uint32_t j = e->first; j < next; j++) {
            const fp3_assignment *a = &m->assignments[j];
            REQUIRE(a->state < m->state_count && !(set >> a->state & 1));
            REQUIRE(a->expr < m->expr_count && !(has[a->expr] & ~(HAS_STATE | HAS_TIME)));
            set |= UINT64_C(1) << a->state;
        }
    }
    REQUIRE(next == m->assignment_count);
}

static void check_model(const fp3_model *m) {
    unsigned char *has = calloc((size_t)m->expr_count + 1, 1);
    REQUIRE(has && m->expr_count <= 4096);
    REQUIRE(fp3_name_valid(m->name) && m->doc && m->step > 0 && m->span > 0);
    REQUIRE(isfinite(m->step) && isfinite(m->span));
    check_expressions(m, has);
    check_states(m, has);
    check_quantities(m->params, m->param_count);
    check_definitions(m, m->definitions, m->definition_count, has, HAS_STATE | HAS_TIME);
    check_definitions(m, m->invariants, m->invariant_count, has,
                      HAS_STATE | HAS_TIME | HAS_HOST_OF_STATE);
    check_events(m, has);
    free(has);
}

static void evaluate(const fp3_model *m) {
    double start[64], params[64], *values = calloc((size_t)m->expr_count + 1, sizeof *values);
    REQUIRE(values);
    for (uint32_t i = 0; i < m->state_count; i++)
        start[i] = m->states[i].value;
    for (uint32_t i = 0; i < m->param_count; i++)
        params[i] = m->params[i].value;
    double fired[64];
    memcpy(fired, start, sizeof start);
    const fp3_point points[] = {{start, params, start, 0}, {start, params, NULL, m->step}};
    fp3_model_fire(m, &points[0], params, m->step, fired, values);
    for (unsigned i = 0; i < 2; i++)
        fp3_model_evaluate(m, &points[i], values);
    free(values);
}

/* By an integrator, for a configuration and with passes that depend on the model. */
static void compile(const fp3_model *m) {
    static const char *const integrators[] = {"rk4",       "verlet", "heun", "stoermer_verlet",
                                              "rk4_paper", "rk6",    "euler"};
    static const char *const configs[] = {"many_full", "sixteen",     "many_full", "lanes",
                                          "many_full", "shared_full", "many",      "single_full"};
    const unsigned choice = m->expr_count * 2654435761u + m->state_count * 40503u + m->param_count;
    fp3_compile_def def = fp3_compile_default();
    fp3_integrator *integrator = NULL;
    fp3_compiled *compiled = NULL;
    fp3_error error;
    REQUIRE(!fp3_integrator_find(integrators[choice % 7], &integrator, &error));
    def.config = configs[choice / 7 % 8];
    if (m->expr_count > 100 && !strcmp(def.config, "single_full"))
        def.config = "many_full"; /* whose schedule takes a tenth of the time */
    def.arithmetic = choice / 56 & 1 ? FP3_COMPENSATED : FP3_PLAIN;
    def.passes ^= choice / 112 & 0x1ff & (choice >> 16);
    const fp3_status status = fp3_compile(m, integrator, &def, &compiled, &error);
    REQUIRE(status == (compiled ? FP3_OK : FP3_E_PROGRAM) || status == FP3_E_ARGUMENT);
    if (compiled) {
        REQUIRE(compiled->image && compiled->assembly && compiled->instructions > 0);
        REQUIRE(compiled->image->registers <= 64 && compiled->order > 0);
    }
    fp3_compiled_free(&compiled);
    fp3_integrator_free(&integrator);
}

/* The stages that a model goes through once it is read. */
static void (*const stages[])(const fp3_model *) = {check_model, evaluate, compile};

#ifdef FP3_LIBFUZZER
#include "mutate.h"
static mutate_models accepted;
#endif

static void read_model(const char *data, size_t size) {
    static const char name[] = "fuzz.ode";
    fp3_model *model = NULL;
    char *report = NULL;
    fp3_error error;
    fp3_status status = fp3_model_read(data, size, name, &model, &report, &error);
    if (status) {
        REQUIRE(status == FP3_E_PROGRAM && !model && report);
        REQUIRE(!strncmp(report, name, sizeof name - 1));
        REQUIRE(!strncmp(report, error.text, strlen(error.text)));
        char place[64];
        snprintf(place, sizeof place, "%s:%u:%u: error: ", name, error.line, error.column);
        REQUIRE(error.line > 0 && error.column > 0 && error.path_size == strlen(name));
        REQUIRE(error.message == strlen(place) && !strncmp(error.text, place, strlen(place)));
        REQUIRE(!strchr(error.text, '\n') && report[strlen(report) - 1] == '\n');
        for (const char *c = report; *c; c++)
            REQUIRE((*c >= ' ' && *c < 0x7f) || *c == '\n');
    } else {
        REQUIRE(model && !report);
#ifdef FP3_LIBFUZZER
        mutate_remember(&accepted, data, size);
#endif
        for (unsigned i = 0; i < sizeof stages / sizeof *stages; i++)
            stages[i](model);
    }
    free(report);
    fp3_model_free(&model);
    REQUIRE(!model);
}

static void read_constant(const char *text) {
    fp3_error error;
    double value = NAN;
    fp3_status status = fp3_constant_read(text, &value, &error);
    if (status)
        REQUIRE(status == FP3_E_PROGRAM && !strncmp(error.text, "column ", 7) && isnan(value));
    else
        REQUIRE(isfinite(value));
}

/* A copy of exactly this size, so that the sanitizer sees a read beyond its end. */
static void run(const unsigned char *data, size_t size) {
    char *copy = malloc(size + 1);
    REQUIRE(copy);
    memcpy(copy, data, size);
    copy[size] = 0;
    if (size < 200)
        read_constant(copy);
    char *exact = realloc(copy, size ? size : 1);
    REQUIRE(exact);
    read_model(exact, size);
    free(exact);
}

#ifdef FP3_LIBFUZZER

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);
size_t LLVMFuzzerMutate(unsigned char *data, size_t size, size_t room);
size_t LLVMFuzzerCustomMutator(unsigned char *data, size_t size, size_t room, unsigned seed);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    run(data, size);
    return 0;
}

/* Half of the time changes a word of a model that was accepted; else a word or bytes of this input.
 */
size_t LLVMFuzzerCustomMutator(unsigned char *data, size_t size, size_t room, unsigned seed) {
    unsigned count = accepted.count < MUTATE_MODELS ? accepted.count : MUTATE_MODELS;
    unsigned state = seed, how = mutate_random(&state, 8);
    const char *from = (const char *)data;
    if (how < 4 && count) {
        unsigned i = mutate_random(&state, count);
        from = accepted.text[i];
        size = accepted.size[i];
    } else if (how < 6) {
        return LLVMFuzzerMutate(data, size, room);
    }
    char *copy = malloc(size + 1);
    if (!copy || size > room) {
        free(copy);
        return size < room ? size : room;
    }
    memcpy(copy, from, size);
    memcpy(data, copy, size);
    size = mutate_model(data, copy, size, room, state);
    free(copy);
    return size;
}

#else

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        static unsigned char data[1 << 21];
        if (!file) {
            perror(argv[i]);
            return 2;
        }
        size_t size = fread(data, 1, sizeof data, file);
        fclose(file);
        fprintf(stderr, "%s\n", argv[i]); /* after a crash the last line names the input */
        run(data, size);
    }
    printf("%d files\n", argc - 1);
    return 0;
}

#endif
