/* compile.c - a model and an integrator to a program, and what the host must know to run it. */
#include <fp3/compile.h>

#include <fp3/asm.h>
#include <inttypes.h>
#include <isa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "emit.h"
#include "truth/reference.h"

typedef struct {
    build b, reference;
    conversion c;
    emit_names names;
    fp3_schedule *schedule;
    const fp3_config *config;
} compiler;

/* ---- passes ---- */

static const struct {
    const char *name, *doc;
    int changes_bits;
} passes[] = {
#define X(NAME, name, changes, what) {name, what, changes},
    FP3_PASSES(X)
#undef X
};

const char *fp3_pass_name(fp3_pass pass) { return passes[pass].name; }
const char *fp3_pass_doc(fp3_pass pass) { return passes[pass].doc; }
int fp3_pass_changes_bits(fp3_pass pass) { return passes[pass].changes_bits; }

fp3_pass fp3_pass_find(const char *name) {
    int i = 0;
    while (i < FP3_PASS_COUNT && strcmp(passes[i].name, name) != 0)
        i++;
    return (fp3_pass)i;
}

static unsigned passes_that(int change_bits) {
    unsigned set = 0;
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        if (passes[i].changes_bits == change_bits)
            set |= FP3_PASS(i);
    return set;
}

fp3_compile_def fp3_compile_default(void) {
    return (fp3_compile_def){.config = "single_full", .passes = passes_that(0)};
}

/* Those that the configuration can use, and that have what they build on. */
static unsigned usable(unsigned set, const fp3_config *config) {
    if (!config->scale)
        set &= ~FP3_PASS(FP3_PASS_SCALE);
    if (!config->chain)
        set &= ~FP3_PASS(FP3_PASS_CHAIN);
    if (config->interleave)
        set &= ~FP3_PASS(FP3_PASS_AHEAD);
    if (!(set & FP3_PASS(FP3_PASS_COMMON)))
        set &= ~FP3_PASS(FP3_PASS_CARRY);
    return set;
}

/* ---- observed states ---- */

static fp3_status find_observed(const fp3_model *model, const fp3_compile_def *def,
                                uint64_t *observed, fp3_error *error) {
    *observed = model->state_count >= 64 ? UINT64_MAX : (UINT64_C(1) << model->state_count) - 1;
    if (!def->observed)
        return FP3_OK;
    *observed = 0;
    for (size_t i = 0; i < def->observed_count; i++) {
        const uint32_t state = fp3_model_state(model, def->observed[i]);
        if (state == FP3_NONE)
            return fp3_fail(error, FP3_E_ARGUMENT, "the model has no state '%s'", def->observed[i]);
        *observed |= UINT64_C(1) << state;
    }
    return FP3_OK;
}

/* ---- what the configuration has ---- */

static const char *lacks(const fp3_config *config, uint32_t op) {
    switch (op) {
#define X(NAME, key)                                                                               \
    case FP3_OP_##NAME:                                                                            \
        return config->key ? NULL : #key;
        FP3_OP_NEEDS(X)
#undef X
    default:
        return NULL;
    }
}

static fp3_status check_ops(const compiler *k, const fp3_op *ops, uint32_t count,
                            fp3_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        const char *what = lacks(k->config, ops[i].op);
        const char *note = ops[i].note < k->b.note_count ? k->b.notes[ops[i].note] : NULL;
        if (what)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "%s%sneeds `%s`, which configuration '%s' does not have",
                            note ? note : "the model", note ? ": " : " ", what, k->config->name);
    }
    return FP3_OK;
}

/* With what is put around the program where objects have a store. */
static fp3_status check_words(const compiler *k, uint32_t words, fp3_error *error) {
    if (words <= k->config->program_words)
        return FP3_OK;
    return fp3_fail(error, FP3_E_PROGRAM,
                    "the program needs %" PRIu32 " words, configuration '%s' has %" PRIu32, words,
                    k->config->name, k->config->program_words);
}

static fp3_status check_room(const compiler *k, const fp3_step *step, const fp3_schedule *s,
                             fp3_error *error) {
    const uint32_t words = s->first_count + s->step_count + s->last_count + s->loads + s->stores;
    const uint32_t constants = step->constant_count + (s->needs_minus_zero != 0);
    if (constants > k->config->registers)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "the step needs %" PRIu32
                        " shared constants, configuration '%s' has %" PRIu32,
                        constants, k->config->name, k->config->registers);
    return check_words(k, words, error);
}

/* ---- scheduling ---- */

/* Fewer cycles are better, then fewer instructions. */
static int is_better(const fp3_schedule *one, const fp3_schedule *other) {
    if (one->cycles != other->cycles)
        return one->cycles < other->cycles;
    return one->step_count < other->step_count;
}

static fp3_status try_policy(compiler *k, chain_policy policy, fp3_error *error) {
    conversion c;
    fp3_schedule *schedule = NULL;
    fp3_status status = fp3_convert(&k->b, k->config, policy, &c, error);
    if (!status)
        status = check_ops(k, c.step.step, c.step.step_count, error);
    if (!status)
        status = check_ops(k, c.step.last, c.step.last_count, error);
    if (!status) /* before an order of too many is looked for */
        status = check_words(k, c.step.first_count + c.step.step_count + c.step.last_count, error);
    if (!status && k->schedule && c.step.step_count >= k->schedule->cycles) {
        fp3_convert_close(&c); /* no order of so many can be better */
        return FP3_OK;
    }
    if (!status)
        status = fp3_schedule_make(&c.step, k->config, &schedule, error);
    if (!status)
        status = check_room(k, &c.step, schedule, error);
    if (!status && (!k->schedule || is_better(schedule, k->schedule))) {
        fp3_schedule_free(&k->schedule);
        fp3_convert_close(&k->c);
        k->schedule = schedule;
        k->c = c;
        return FP3_OK;
    }
    fp3_schedule_free(&schedule);
    fp3_convert_close(&c);
    return status;
}

/* Where contexts hide latency every product that can be is chained; where one object waits, what is
 * best. */
static fp3_status schedule(compiler *k, fp3_error *error) {
    static const chain_policy order[] = {CHAIN_ALL, CHAIN_EARLY, CHAIN_SLACK, CHAIN_LONG,
                                         CHAIN_NONE};
    const int is_choice = !k->config->interleave && k->b.passes & FP3_PASS(FP3_PASS_CHAIN);
    fp3_status first = FP3_OK;
    if (is_choice) {
        k->b.one = fp3_graph_number(&k->b.g, 1);
        k->b.minus_zero = fp3_graph_number(&k->b.g, -0.0);
    }
    for (int i = 0; i < (is_choice ? 5 : 1); i++) {
        fp3_error why;
        const fp3_status status = try_policy(k, order[i], &why);
        if (status && !first) {
            first = status;
            if (error)
                *error = why;
        }
    }
    return k->schedule ? FP3_OK : first;
}

/* ---- inputs ---- */

static fp3_status add_input(fp3_compiled *made, const char *name, int is_shared, uint32_t state,
                            char *formula, fp3_error *error) {
    fp3_input *input = &made->inputs[made->input_count];
    if (!formula)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    *input = (fp3_input){.is_shared = is_shared, .state = state, .formula = formula};
    snprintf(input->name, sizeof input->name, "%s", name);
    made->input_count++;
    return FP3_OK;
}

static char *variable_formula(const build *b, const variable *v) {
    char *text = NULL;
    const char *name = b->model->states[v->state].name;
    if (asprintf(&text,
                 v->role == ROLE_STATE    ? "%s at the start"
                 : v->role == ROLE_BEFORE ? "%s at -h"
                                          : "0",
                 name) < 0)
        return NULL;
    return text;
}

static fp3_status make_inputs(compiler *k, fp3_compiled *made, fp3_error *error) {
    const build *b = &k->b;
    const fp3_step *step = &k->c.step;
    made->inputs = calloc(b->variable_count + step->param_count + step->constant_count + 1u,
                          sizeof *made->inputs);
    fp3_status status = made->inputs ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; !status && i < b->variable_count; i++)
        if (b->variables[i].role != ROLE_CARRIED)
            status =
                add_input(made, k->names.object[i], 0,
                          b->variables[i].role == ROLE_STATE ? b->variables[i].state : FP3_NONE,
                          variable_formula(b, &b->variables[i]), error);
    for (uint32_t i = 0; !status && i < step->param_count; i++)
        status = add_input(made, k->names.object[b->variable_count + i], 0, FP3_NONE,
                           fp3_known_text(&b->known, k->c.params[i]), error);
    for (uint32_t i = 0; !status && i < step->constant_count; i++)
        if (b->known.list[k->c.constants[i]].op != KNOWN_NUMBER)
            status = add_input(made, k->names.constant[i], 1, FP3_NONE,
                               fp3_known_text(&b->known, k->c.constants[i]), error);
    return status;
}

static double variable_value(const variable *v, const double *initial, const double *before) {
    return v->role == ROLE_STATE    ? initial[v->state]
           : v->role == ROLE_BEFORE ? before[v->state]
                                    : 0;
}

static fp3_status find_before(const build *b, const double *params, const double *initial, double h,
                              double *before, fp3_error *error) {
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == ROLE_BEFORE)
            return fp3_model_truth(b->model, params, initial, -h, before, error);
    return FP3_OK;
}

static fp3_status check_finite(const fp3_compiled *made, const double *wanted, float *values,
                               fp3_error *error) {
    for (uint32_t i = 0; i < made->input_count; i++) {
        values[i] = (float)wanted[i];
        if (!isfinite(values[i]))
            return fp3_fail(error, FP3_E_ARGUMENT, "'%s' = %s is %g: expected a finite FP32 number",
                            made->inputs[i].name, made->inputs[i].formula, wanted[i]);
    }
    return FP3_OK;
}

fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error) {
    const compiler *k = compiled->self;
    const build *b = &k->b;
    const uint32_t states = b->model->state_count;
    double *known = calloc(b->known.count + 1u, sizeof *known);
    double *before = calloc(states + 1u, sizeof *before);
    double *wanted = calloc(compiled->input_count + 1u, sizeof *wanted);
    fp3_status status =
        known && before && wanted ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_known_evaluate(&b->known, params, h, known, error);
    if (!status)
        status = find_before(b, params, initial, h, before, error);
    if (!status) {
        uint32_t at = 0;
        for (uint32_t i = 0; i < b->variable_count; i++)
            if (b->variables[i].role != ROLE_CARRIED)
                wanted[at++] = variable_value(&b->variables[i], initial, before);
        for (uint32_t i = 0; i < k->c.step.param_count; i++)
            wanted[at++] = known[k->c.params[i]];
        for (uint32_t i = 0; i < k->c.step.constant_count; i++)
            if (b->known.list[k->c.constants[i]].op != KNOWN_NUMBER)
                wanted[at++] = known[k->c.constants[i]];
        status = check_finite(compiled, wanted, values, error);
    }
    free(known);
    free(before);
    free(wanted);
    return status;
}

/* ---- text ---- */

static char *head_of(const compiler *k, const fp3_compiled *made) {
    char *text = NULL;
    size_t size = 0;
    const build *b = &k->b;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, "# %s by %s%s, for configuration '%s'. Compiled by fp3.\n", b->model->name,
            b->integrator->name, b->is_compensated ? ", compensated" : "", k->config->name);
    if (*b->model->doc)
        fprintf(out, "# %s\n", b->model->doc);
    fprintf(out, "#\n# Order %u. %" PRIu32 " operations in %" PRIu32 " instructions", made->order,
            made->operations, made->instructions);
    if (made->cycles > 0)
        fprintf(out, ", %.6g cycles per object-step (bound %.6g)", made->cycles, made->bound);
    fprintf(out, ".\n# Passes:");
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        if (made->passes & FP3_PASS(i))
            fprintf(out, " %s", passes[i].name);
    fprintf(out, "\n");
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}

/* The assembler has given each name the register that the schedule means. */
static fp3_status check_registers(const compiler *k, const fp3_image *image, fp3_error *error) {
    for (uint32_t i = 0; i < k->names.object_count; i++) {
        const fp3_symbol *s = fp3_image_find(image, k->names.object[i], FP3_CLASSES_OBJECT);
        if (!s || s->index != i)
            return fp3_fail(error, FP3_E_MISMATCH, "'%s' is not in register %" PRIu32,
                            k->names.object[i], i);
    }
    return FP3_OK;
}

static fp3_status write_program(compiler *k, fp3_compiled *made, fp3_error *error) {
    fp3_status status = fp3_emit_names(&k->b, &k->c, k->schedule, &k->names, error);
    char *head = head_of(k, made);
    if (!status && !head)
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_emit(&k->b, &k->c, k->schedule, &k->names, head, &made->assembly, error);
    free(head);
    if (status)
        return status;
    fp3_assembly *assembly = NULL;
    status = fp3_assemble(made->assembly, strlen(made->assembly), "compiled", &assembly, error);
    if (!status) {
        made->image = assembly->image;
        assembly->image = NULL;
    }
    fp3_assembly_free(&assembly);
    return status ? status : check_registers(k, made->image, error);
}

static void fill(const compiler *k, fp3_compiled *made) {
    const fp3_schedule *s = k->schedule;
    made->operations = k->c.operations;
    made->instructions = s->step_count;
    made->registers = s->registers;
    made->constants = k->c.step.constant_count + (s->needs_minus_zero != 0);
    made->ahead = s->ahead;
    made->copies = s->copies;
    made->cycles = s->cycles;
    made->bound = s->bound;
    made->bound_issue = s->bound_issue;
    made->bound_path = s->bound_path;
    made->passes = k->b.passes;
    made->order = k->b.order;
}

/* ---- all of it ---- */

static fp3_status build_and_schedule(compiler *k, const fp3_model *model,
                                     const fp3_integrator *integrator, unsigned set,
                                     int is_compensated, int has_notes, uint64_t observed,
                                     fp3_error *error) {
    fp3_status status = fp3_build(&k->b, model, integrator, usable(set, k->config), is_compensated,
                                  has_notes, observed, error);
    if (!status && k->b.passes & FP3_PASS(FP3_PASS_CARRY))
        fp3_build_carry(&k->b);
    return status ? status : schedule(k, error);
}

static void close_compiler(compiler *k) {
    fp3_build_close(&k->b);
    fp3_build_close(&k->reference);
    fp3_convert_close(&k->c);
    fp3_emit_names_close(&k->names);
    fp3_schedule_free(&k->schedule);
}

/* Uses of the multiplier. */
static uint32_t products(const fp3_step *step) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < step->step_count; i++)
        found += step->step[i].op == FP3_OP_MUL || step->step[i].op == FP3_OP_MADD ||
                 step->step[i].op == FP3_OP_MSUB;
    return found;
}

/* What a step costs without one pass, less what it costs. */
static uint32_t saving(const compiler *k, const fp3_compiled *made, const compiler *without,
                       int pass) {
    const uint32_t operations = without->c.operations, instructions = without->schedule->step_count;
    if (pass == FP3_PASS_AHEAD)
        return without->schedule->cycles > made->cycles
                   ? (uint32_t)(without->schedule->cycles - made->cycles + 0.5)
                   : 0;
    if (pass == FP3_PASS_SCALE) {
        const uint32_t with = products(&k->c.step), others = products(&without->c.step);
        return others > with ? others - with : 0;
    }
    if (pass == FP3_PASS_CHAIN)
        return instructions > made->instructions ? instructions - made->instructions : 0;
    return operations > made->operations ? operations - made->operations : 0;
}

static void find_savings(const compiler *k, const fp3_compile_def *def, uint64_t observed,
                         fp3_compiled *made) {
    for (int pass = 0; pass < FP3_PASS_COUNT; pass++) {
        if (!(made->passes & FP3_PASS(pass)))
            continue;
        compiler without = {.config = k->config};
        if (!build_and_schedule(&without, k->b.model, k->b.integrator,
                                made->passes & ~FP3_PASS(pass), def->is_compensated, 0, observed,
                                NULL))
            made->saved[pass] = saving(k, made, &without, pass);
        close_compiler(&without);
    }
}

static fp3_status compile(compiler *k, const fp3_model *model, const fp3_integrator *integrator,
                          const fp3_compile_def *def, fp3_compiled *made, fp3_error *error) {
    uint64_t observed = 0;
    fp3_status status = find_observed(model, def, &observed, error);
    if (!status)
        status = build_and_schedule(k, model, integrator, def->passes, def->is_compensated, 1,
                                    observed, error);
    if (!status)
        status = fp3_build(&k->reference, model, integrator,
                           def->passes & (passes_that(1) | FP3_PASS(FP3_PASS_DEAD)),
                           def->is_compensated, 0, observed, error);
    if (status)
        return status;
    fill(k, made);
    status = write_program(k, made, error);
    if (!status)
        status = make_inputs(k, made, error);
    if (!status && def->finds_savings)
        find_savings(k, def, observed, made);
    return status;
}

fp3_status fp3_compile(const fp3_model *model, const fp3_integrator *integrator,
                       const fp3_compile_def *def, fp3_compiled **compiled, fp3_error *error) {
    *compiled = NULL;
    const fp3_config *config = fp3_config_find(def->config);
    if (!config)
        return fp3_fail(error, FP3_E_ARGUMENT, "no configuration '%s'",
                        def->config ? def->config : "");
    fp3_compiled *made = calloc(1, sizeof *made);
    compiler *k = calloc(1, sizeof *k);
    if (!made || !k) {
        free(made);
        free(k);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    k->config = config;
    made->self = k;
    fp3_status status = compile(k, model, integrator, def, made, error);
    if (status == FP3_E_LIMIT)
        status = FP3_E_PROGRAM; /* what is too large for a machine is a wrong program for it */
    if (status)
        fp3_compiled_free(&made);
    *compiled = made;
    return status;
}

void fp3_compiled_free(fp3_compiled **compiled) {
    fp3_compiled *made = *compiled;
    if (!made)
        return;
    close_compiler(made->self);
    free(made->self);
    fp3_image_free(&made->image);
    free(made->assembly);
    for (uint32_t i = 0; i < made->input_count; i++)
        free(made->inputs[i].formula);
    free(made->inputs);
    free(made);
    *compiled = NULL;
}

static fp3_status run_reference(const build *b, const double *params, const double *initial,
                                double h, int is_exact, const uint64_t *steps, size_t count,
                                double *states, fp3_error *error) {
    double *before = calloc(b->model->state_count + 1u, sizeof *before);
    double *start = calloc(b->variable_count + 1u, sizeof *start);
    fp3_status status = before && start ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = find_before(b, params, initial, h, before, error);
    for (uint32_t i = 0; !status && i < b->variable_count; i++) {
        start[i] = variable_value(&b->variables[i], initial, before);
        if (!is_exact)
            start[i] = (float)start[i];
    }
    if (!status)
        status = fp3_reference_run(b, params, h, is_exact, start, steps, count, states, error);
    free(before);
    free(start);
    return status;
}

static float canonical(double x) {
    const uint32_t bits = 0x7fc00000u;
    float f = (float)x;
    if (isnan(f))
        memcpy(&f, &bits, sizeof f);
    return f;
}

fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error) {
    const compiler *k = compiled->self;
    const size_t cells = count * k->reference.model->state_count;
    double *wide = calloc(cells + 1u, sizeof *wide);
    if (!wide)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < cells; i++)
        wide[i] = states[i];
    const fp3_status status =
        run_reference(&k->reference, params, initial, h, 0, steps, count, wide, error);
    for (size_t i = 0; !status && i < cells; i++)
        states[i] = canonical(wide[i]);
    free(wide);
    return status;
}

fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error) {
    const compiler *k = compiled->self;
    return run_reference(&k->reference, params, initial, h, 1, steps, count, states, error);
}

uint64_t fp3_compiled_cycles(const fp3_compiled *compiled, uint64_t steps) {
    const compiler *k = compiled->self;
    return fp3_schedule_cycles(k->schedule, k->config, steps);
}
