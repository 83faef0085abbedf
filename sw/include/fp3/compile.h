/* fp3/compile.h - a model and an integrator to a program.
 *
 *     fp3_compile_def def = fp3_compile_default();
 *     def.config = "many_full";
 *     fp3_compiled *program = NULL;
 *     if (fp3_compile(model, integrator, &def, &program, &error)) ...
 *     puts(program->assembly);
 *     fp3_engine_load(engine, program->image);
 *     float values[...];   program->input_count of them
 *     fp3_compiled_inputs(program, params, initial, h, values, &error);
 *     ... write each: program->inputs[i].name ...
 *     fp3_compiled_free(&program);
 *
 * docs/compiler.md says what each pass does and in which order everything is rounded.
 */
#ifndef FP3_COMPILE_H
#define FP3_COMPILE_H

#include <fp3/image.h>
#include <fp3/integrator.h>
#include <fp3/model.h>
#include <fp3/status.h>
#include <stdint.h>

/* X(NAME, name, changes bits, what it does) */
#define FP3_PASSES(X)                                                                              \
    X(COMMON, "common", 0, "a value that is computed twice is computed once")                      \
    X(UNIT, "unit", 0, "x + -0, x - 0 and x * 1 cost nothing")                                     \
    X(DEAD, "dead", 0, "what no observed state needs is left out")                                 \
    X(CARRY, "carry", 0, "what the step before has computed already is kept")                      \
    X(SCALE, "scale", 0, "half and twice ride on an addition, where the configuration can")        \
    X(CHAIN, "chain", 0, "a product goes straight into the addition that needs it")                \
    X(AHEAD, "ahead", 0, "operations of the next step fill the gaps of this one")                  \
    X(FOLD_STEP, "fold-step", 1, "h times a coefficient is one number: y + (h a_ij) f")            \
    X(FOLD_PRODUCT, "fold-product", 1, "known factors of a product are one number: x (h/m)")

typedef enum {
#define X(NAME, name, changes, what) FP3_PASS_##NAME,
    FP3_PASSES(X)
#undef X
        FP3_PASS_COUNT
} fp3_pass;
#define FP3_PASS(pass) (1u << (pass))

const char *fp3_pass_name(fp3_pass pass);
const char *fp3_pass_doc(fp3_pass pass);
int fp3_pass_changes_bits(fp3_pass pass);
/* FP3_PASS_COUNT: no such name. */
fp3_pass fp3_pass_find(const char *name);

typedef struct {
    const char *config;          /* the configuration that it is scheduled for */
    unsigned passes;             /* a set of FP3_PASS(...) */
    int is_compensated;          /* what an update loses is added to the next one (Kahan) */
    const char *const *observed; /* names of the states that somebody reads; NULL: all */
    size_t observed_count;
    int finds_savings; /* fills fp3_compiled.saved, which takes as long again for each pass */
} fp3_compile_def;

/* "single_full", every pass that keeps the bits, plain, all states observed. */
fp3_compile_def fp3_compile_default(void);

/* What the host writes before a run. */
typedef struct {
    char name[FP3_NAME_SIZE];
    int is_shared;  /* a .shared; else a .state or .param of each object */
    uint32_t state; /* start of this state of the model; FP3_NONE: another value */
    char *formula;  /* as a reader sees it, "1/m" */
} fp3_input;

typedef struct {
    char *assembly;
    fp3_image *image;
    fp3_input *inputs;
    uint32_t input_count;
    /* Of a step. */
    uint32_t operations; /* additions, products, ... with chained ones counted as two */
    uint32_t instructions;
    uint32_t registers, constants;
    uint32_t ahead, copies;
    double cycles; /* per object-step, predicted; 0: not known beforehand */
    double bound, bound_issue, bound_path;
    uint32_t saved
        [FP3_PASS_COUNT]; /* because of it: operations less; of chain instructions, of scale products, of ahead cycles */
    unsigned passes; /* that were on and that the configuration can use */
    unsigned order;  /* theoretical, of the worst observed state: see docs/integrators.md */
    void *self;
} fp3_compiled;

/* FP3_E_ARGUMENT: no such configuration or state; FP3_E_PROGRAM: the integrator does not fit the
 * model (a splitting of what has no velocities), a number is beyond FP32, or the configuration lacks
 * an operation, registers, constants or words: how many are needed. Messages about the model begin
 * with its line. */
fp3_status fp3_compile(const fp3_model *model, const fp3_integrator *integrator,
                       const fp3_compile_def *def, fp3_compiled **compiled, fp3_error *error);
/* Sets *compiled to NULL; that it was NULL before does no harm. */
void fp3_compiled_free(fp3_compiled **compiled);

/* values[i] of inputs[i] for an object with these params and start (model->param_count and state_count
 * numbers) and time step h: computed in double, rounded once. FP3_E_ARGUMENT: a value is not finite. */
fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error);

/* The same steps straight from the equations, without any pass that keeps the bits, in FP32: what every engine
 * must equal bit for bit. params, initial and h as above. states has count rows of model->state_count floats: in
 * row i, after steps[i] steps (none less than the one before), those that are computed (observed, or needed by
 * what is), a NaN as 7FC00000; others are unchanged. */
fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error);

/* The same steps in double, with quotients and roots in double: the integrator without FP32. Sines and cosines
 * are the same polynomials. */
fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error);

/* Predicted cycles of a run, see sw/schedule/code.h; 0: not predictable. */
uint64_t fp3_compiled_cycles(const fp3_compiled *compiled, uint64_t steps);

/* Where the object is at time t (negative, too), in double: GSL's rk8pd at tight tolerance, and the closed forms of
 * the model if it has them, with which it must agree: FP3_E_MISMATCH. states has model->state_count numbers. */
fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error);

#endif
