/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/compile.h - compiles a model and an integrator to a program.
 *
 *     fp3_compile_def def = fp3_compile_default();
 *     def.config = "many_full";
 *     fp3_compiled *program = NULL;
 *     if (fp3_compile(model, integrator, &def, &program, &error) ||
 *         fp3_engine_load(engine, program->image))
 *         fprintf(stderr, "%s\n", error.text);
 *     // Write the values of program->inputs, which fp3_compiled_inputs computes.
 *     fp3_compiled_free(&program);
 *
 * docs/compiler.md describes each pass, and the order in which everything is rounded.
 *
 * Threads: any number of threads may read a compiled program at the same time.
 */
#ifndef FP3_COMPILE_H
#define FP3_COMPILE_H

#include <fp3/image.h>
#include <fp3/model.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* ---- passes that can be turned on and off (docs/compiler.md) ---- */

/* X(NAME, name, changes bits, what it does) */
#define FP3_PASSES(X)                                                                              \
    X(COMMON, "common", 0, "a value that is computed twice is computed once")                      \
    X(IDENTITY, "identity", 0, "x + -0, x - 0 and x * 1 cost nothing")                             \
    X(DEAD, "dead", 0, "values that no observed state needs are left out")                         \
    X(CARRY, "carry", 0, "values that the previous step has computed are kept")                    \
    X(SCALE, "scale", 0, "half and twice are part of an addition, if the configuration can")       \
    X(CHAIN, "chain", 0, "a product goes straight into the addition that needs it")                \
    X(FUSE, "fuse", 0, "the error of a product takes one fused multiply-add")                      \
    X(AHEAD, "ahead", 0, "operations of the next step fill gaps of this step")                     \
    X(SHARE, "share", 0, "values that all objects share are constants, not registers")             \
    X(ZERO, "zero", 0, "a coefficient 0 of an integrator's table has no term")                     \
    X(FOLD_STEP, "fold-step", 1, "h times a coefficient is one number: y + (h a_ij) f")            \
    X(FOLD_PRODUCT, "fold-product", 1, "known factors of a product are one number: x (h/m)")       \
    X(OWN_WEIGHTS, "own-weights", 1, "each slope goes to the state by itself: y + b1 k1 + b2 k2")  \
    X(SMALL_ANGLES, "small-angles", 1, "sine and cosine of |x| <= pi/2 alone, NaN beyond")         \
    X(EXACT_DIVISION, "exact-division", 1, "quotients and roots, not powers, are correctly rounded")

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
/* The pass of this name, or FP3_PASS_COUNT if there is none. */
fp3_pass fp3_pass_find(const char *name);
/* The set of all passes that change bits (1), or of all passes that keep the bits (0). */
unsigned fp3_passes_that(int change_bits);

/* ---- a program ---- */

/* How the values of a step are computed. */
typedef enum {
    FP3_PLAIN,
    FP3_COMPENSATED, /* the rounding error of an update is added to the next update (Kahan) */
    FP3_FOLDED,      /* h times a coefficient, or the known factors of a product, are one number */
    FP3_DOUBLE_SINGLE, /* states and all arithmetic are sums of two floats */
    FP3_ARITHMETICS
} fp3_arithmetic;

typedef struct {
    const char *name; /* in results and scenes, and after --arithmetic */
    const char *text; /* in a sentence, and as an option */
    unsigned passes;  /* set of the passes that this arithmetic implies */
} fp3_arithmetic_facts;

const fp3_arithmetic_facts *fp3_arithmetic_of(fp3_arithmetic arithmetic);
/* The arithmetic of this name, or FP3_ARITHMETICS if there is none. */
fp3_arithmetic fp3_arithmetic_find(const char *name);
/* Whether the integrator, with fixed or adaptive steps, has a program of its own in this
 * arithmetic. */
int fp3_arithmetic_applies(fp3_arithmetic arithmetic, const fp3_integrator *integrator,
                           int is_adaptive);

/* Objects of several kinds make a step together, phase by phase: in round r each kind makes its
 * phase r, and a kind with fewer phases rests (docs/relations.md#kinds). A place is a stage or
 * substep of the integrator, then before the step, then each projection; from FP3_PLACE_EVENTS on
 * each event; the last place is that of `remember`. fp3_programs_join (fp3/program.h) finds what
 * kinds ask of each other. */
#define FP3_PLACES 64
#define FP3_PLACE_EVENTS 44

/* What all objects compare in an adaptive step that they make together (docs/adaptive.md): where it
 * ends at the latest, its error, and what each sees of an event. */
typedef enum {
    FP3_COMPARED_LIMIT,
    FP3_COMPARED_ERROR,
    FP3_COMPARED_AHEAD,
    FP3_COMPARED_LATE,
    FP3_COMPARED_BEGINS,
    FP3_COMPARED_FROM,
    FP3_COMPARED_TO,
    FP3_COMPARISONS
} fp3_compared;

typedef struct {
    uint64_t seen;   /* states of this model that objects of other kinds read: bit s for state s */
    uint64_t params; /* params of this model that they read, which stay words of the program */
    uint64_t looked; /* places of a step at which they read the states: bit i */
    /* Of each place, the earliest phase in which sums over other kinds there are computed. */
    uint8_t phase[FP3_PLACES];
    int is_one_by_one; /* 1: each repetition is a place, as others that move look at it */
    int is_common;     /* 1: adaptive steps are those of all kinds, even if this one sees nobody */
    unsigned compared; /* what objects of other kinds compare: bit c for comparison c */
    /* Of each comparison, the earliest phase behind which it is made. */
    uint8_t behind[FP3_COMPARISONS];
} fp3_coupling;

/* How to compile. Always start from fp3_compile_default(). */
typedef struct {
    /* Set by fp3_compile_default(): detects a missing default, and a program that was compiled with
     * headers of another version. */
    uint32_t cookie;
    const char *config; /* the configuration to schedule for */
    unsigned passes;    /* a set of FP3_PASS(...), besides the passes that arithmetic implies */
    fp3_arithmetic arithmetic;
    const char *const *observed; /* names of the states that will be read; NULL: all */
    size_t observed_count;
    int finds_savings; /* 1: also fill fp3_compiled.saved: compiles again for each pass */
    /* 1: the program may have more words than the configuration's instruction memory. Engines
     * isa and fast run it, with the same bits as a program that fits; hardware refuses to load
     * it. */
    int is_for_host;
    const fp3_coupling *coupling; /* what objects of other kinds read of these; NULL: nothing */
} fp3_compile_def;

/* For fp3_compile_default() only. size is that of fp3_compile_def in the calling program. */
void fp3_compile_set_default(fp3_compile_def *def, size_t size);
/* "single_full", every pass that keeps the bits, plain, all states observed. */
static inline fp3_compile_def fp3_compile_default(void) {
    fp3_compile_def def;
    fp3_compile_set_default(&def, sizeof def);
    return def;
}

/* What the host writes before a run. */
typedef struct {
    char name[FP3_NAME_SIZE];
    int is_shared;   /* 1: a .shared; 0: a .state or .param of each object */
    uint32_t state;  /* the input is the start of this state of the model; else FP3_NONE */
    uint32_t low_of; /* double-single: the second word of this state's start; else FP3_NONE */
    char *formula;   /* for readers, as "1/m"; truncated if long */
    /* The same for fp3_formula_read, in h, params of the model and numbers. NULL: the input is a
     * state's start, or its formula is missing or very long. */
    char *rule;
    /* What the value depends on: params of the model, one bit each, from bit 0; h; the states'
     * starts and the starting time (`steps`). */
    uint64_t params;
    int has_h, has_start;
} fp3_input;

typedef struct {
    char *assembly;
    /* One line that begins with a line number of the model, if the integrator loses order on the
     * model: a splitting is only of first order if a kicked derivative depends on more than
     * positions. Or a line on wrong results of a configuration that flushes subnormal numbers. Else
     * NULL. */
    char *warning;
    fp3_image *image;
    fp3_input *inputs;
    uint32_t input_count;
    /* Of one step. */
    uint32_t operations; /* additions, products, ...; a chained pair counts as two */
    uint32_t instructions;
    uint32_t registers, constants;
    uint32_t ahead, copies;
    uint32_t spills; /* loads and stores within the step, of values without a register */
    double cycles;   /* per object-step, predicted; 0: cannot be predicted */
    double bound, bound_issue, bound_path;
    /* What each pass saves, if def->finds_savings is set: operations; `chain` saves instructions,
     * `scale` products, `ahead` cycles, `share` registers. */
    uint32_t saved[FP3_PASS_COUNT];
    unsigned passes; /* the passes that were on and that the configuration can use */
    unsigned order;  /* theoretical, of the worst observed state: docs/integrators.md */
    fp3_arithmetic arithmetic;
    uint64_t looks;            /* places with a sum over another kind */
    uint64_t shows;            /* places of coupling->looked whose seen states others can read */
    uint8_t phase[FP3_PLACES]; /* of each of these places */
    unsigned compares;         /* what its objects compare: bit c for comparison c, ... */
    uint8_t behind[FP3_COMPARISONS]; /* ... behind this phase */
    uint32_t phases;                 /* of a step */
    void *self;
} fp3_compiled;

/* FP3_E_ARGUMENT: no such configuration or state, or a definition from another version of the
 * library. FP3_E_PROGRAM: the integrator does not suit the model (a splitting, but no velocities),
 * a number is outside the range of FP32, or the configuration lacks an operation, registers,
 * constants or words; the message says how many are needed. Messages about a place in the model
 * begin "line:column: error: ". */
fp3_status fp3_compile(const fp3_model *model, const fp3_integrator *integrator,
                       const fp3_compile_def *def, fp3_compiled **compiled, fp3_error *error);
/* Frees *compiled and sets it to NULL. *compiled may be NULL already. */
void fp3_compiled_free(fp3_compiled **compiled);

/* In double-single, the register that holds the second word of a state of the model; -1: none. The
 * state is the sum of its two registers, which a double holds exactly. */
int fp3_compiled_low(const fp3_compiled *compiled, uint32_t state);

/* The exact cycles of a run of `steps` steps, for one object, or for all contexts full and one
 * visit, including loads and stores. 0: no steps, or schedulers share an arithmetic unit. */
uint64_t fp3_compiled_cycles(const fp3_compiled *compiled, uint64_t steps);

/* Sets values[i] to the value of inputs[i], for an object with these params and this start
 * (model->param_count and state_count numbers) at time 0, and time step h. `steps`, if it is an
 * input, is 0. Values are computed in double and rounded once. FP3_E_ARGUMENT: h is not above 0, a
 * value is not finite or rounds to an infinity, or a value that is computed from other values
 * rounds to 0 although none of those is below 2^-50 and below 2^-20 of its default. */
fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error);

/* ---- adaptive steps: each object chooses its own ----
 *
 *     fp3_adaptive_def def = fp3_adaptive_default();
 *     fp3_compile_def how = fp3_compile_default();
 *     fp3_adaptive_report report;
 *     def.until = 17.0652;
 *     if (fp3_model_adapt(model, &def, &error) ||
 *         fp3_compile(model, integrator, &how, &compiled, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     // Load compiled->image and write its inputs, which fp3_compiled_inputs computes, then:
 *     if (fp3_adaptive_run(engine, FP3_ADAPTIVE_ATTEMPTS, &stats) ||
 *         fp3_adaptive_report_make(engine, 0, fp3_engine_objects(engine), &report))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("%zu objects did not reach the end\n", report.failed);
 *
 * docs/adaptive.md describes what a step computes, and how the two words of t keep time.
 */

/* Defaults of the params that adaptive steps add to a model, in the model's own units. Always start
 * from fp3_adaptive_default(). */
typedef struct {
    uint32_t cookie; /* as in fp3_compile_def */
    /* A step of a state y may be wrong by absolute + tolerance |y|. 0: fixed steps of h, which end
     * earlier at `until`, at events and where a condition in t changes; the next step then ends
     * where the whole step would have ended. */
    double tolerance; /* default 1e-5 */
    double absolute;  /* 0: the same number as tolerance */
    double until;     /* the time at which objects end; 0: the model's span */
    /* An event is found at most this late. 0: 2^-24 until, at most step / 1024; a condition that is
     * no root: at least tolerance * until, or step / 64 without a tolerance. */
    double locate;
    /* The longest step; 0: no limit. A model whose conditions change with t at unknown times needs
     * a limit (docs/adaptive.md). */
    double maxstep;
} fp3_adaptive_def;

/* For fp3_adaptive_default() only. size is that of fp3_adaptive_def in the calling program. */
void fp3_adaptive_set_default(fp3_adaptive_def *def, size_t size);
static inline fp3_adaptive_def fp3_adaptive_default(void) {
    fp3_adaptive_def def;
    fp3_adaptive_set_default(&def, sizeof def);
    return def;
}

/* The default integrators, with fixed and with adaptive steps. */
#define FP3_FIXED_INTEGRATOR "rk4"
#define FP3_ADAPTIVE_INTEGRATOR "cash_karp"

/* Adds to the model what adaptive steps need: after its own states, in this order, t, h_next (the
 * next step to try, at first the model's step), accepted, rejected, smallest and largest, and h_cut
 * if there are events; the param until of each object; and the shared params tolerance, absolute,
 * locate if there are events, and maxstep if a limit is given or needed. Without a tolerance
 * smallest, largest, h_cut, absolute and maxstep are left out, and h_next is the longest step up to
 * an event. Events that are located also need h_before and h_behind, and roots with a tolerance
 * root_before and root_behind (docs/adaptive.md). fp3_compile then makes a program with adaptive
 * steps. FP3_E_PROGRAM: the model already has one of these names, is too large, or has no
 * equations. FP3_E_ARGUMENT: a definition from another version of the library. */
fp3_status fp3_model_adapt(fp3_model *model, const fp3_adaptive_def *def, fp3_error *error);

/* The index of state t, or FP3_NONE if the model is not adapted. The other added states follow
 * t. */
uint32_t fp3_model_adapted(const fp3_model *model);
/* Whether the model is adapted with a tolerance. */
int fp3_model_chooses_steps(const fp3_model *model);

FP3_API_END

#endif
