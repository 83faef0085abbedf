/* fp3/tune.h - the cheapest way to integrate a model to a tolerance, found by measuring.
 *
 *     fp3_tune_def def = fp3_tune_default();
 *     def.program = program;     // a model, opened for a configuration
 *     def.params = params;       // with what is spread: the ranges
 *     def.tolerance = 1e-4;
 *     fp3_tuning *found = NULL;
 *     if (fp3_tune(&def, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else if (found->is_met)
 *         printf("%s\n", found->rows[found->best].integrator);
 *     fp3_tuning_free(&found);
 *
 * docs/tuner.md says how it searches, and how safe the choice is.
 *
 * Threads: one call tunes in the thread that makes it; calls in different threads do not disturb each other.
 * Experimental.
 */
#ifndef FP3_TUNE_H
#define FP3_TUNE_H

#include <fp3/compile.h>
#include <fp3/model.h>
#include <fp3/program.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

/* Errors are the largest distance of any state, at any of so many times of the span (evenly, the last
 * at its end), from the truth, relative to the largest magnitude of that state along the truth of its
 * object; of several objects the worst. Infinite: a run went wrong. */
#define FP3_TUNE_LOOKS 4
#define FP3_TUNE_LEAST 1e-7 /* no smaller tolerance: FP32 itself rounds by 6e-8 */

typedef void fp3_tune_say_fn(void *user, const char *what);

typedef struct {
    const fp3_program *program; /* a model for one of the known configurations, not adapted */
    const char *config;         /* that configuration: costs are its cycles */
    const fp3_params *params;   /* each value that is spread has any value of its range */
    double tolerance;
    double span; /* how long it is integrated; 0: the model's span */
    double
        safety; /* the sample has to meet tolerance / safety, in round n / safety^n; at least 1 */
    uint32_t sample, held_out; /* objects; of a model without ranges one, and none */
    uint32_t rounds;           /* held-out samples, at most */
    fp3_tune_say_fn *say;      /* called before each part of the work, or NULL */
    void *user;
} fp3_tune_def;

/* No tolerance; safety 1.25, 32 objects, 64 held out, 4 rounds. */
fp3_tune_def fp3_tune_default(void);

/* What was tried, an integrator with an arithmetic, and fixed or adaptive steps. */
typedef struct {
    char integrator[FP3_NAME_SIZE];
    fp3_arithmetic arithmetic;
    int is_adaptive; /* fp3/compile.h: it has a tolerance and no number of steps */
    uint64_t steps;  /* the fewest that met the target, or those of the last look; 0: none */
    float h;
    /* Of adaptive steps, likewise: tolerance and absolute of a step, and how many attempts an object of the
     * sample makes, the mean; 0: none. */
    double tolerance, absolute, attempts;
    double error;   /* of the sample with these steps */
    double lowest;  /* of all numbers of steps, or tolerances, that were looked at */
    double cycles;  /* for an object over the span, all contexts full; 0: not compiled */
    uint32_t looks; /* runs of the sample */
    int is_met;     /* the sample met the target */
    char why[160];  /* what became of it */
} fp3_tune_row;

/* Read it, never change it. */
typedef struct {
    fp3_tune_row *rows;
    size_t row_count, best; /* best: row_count if no row met the target */
    int is_met;             /* best is there, and the last held-out sample meets the tolerance */
    double span;
    uint32_t ranges, sample, held_out; /* how many objects the choice has seen, and not seen */
    uint32_t rounds;
    double target;         /* that the sample has to meet in the last round */
    double error_held_out; /* of the best; NaN: there is no best, or there are no ranges */
    double baseline_cycles, baseline_error; /* rk4, plain, at the model's default step */
    uint64_t baseline_steps;
} fp3_tuning;

/* FP3_E_ARGUMENT: a tolerance that is not from FP3_TUNE_LEAST to below 1, a span that is not above 0 or
 * shorter than FP3_TUNE_LOOKS steps, a configuration with other roundings than IEEE 754's or whose cycles
 * are not known beforehand, a program that is no model, or of adaptive steps. FP3_E_FAILED: there is no truth for an object of the sample, and why.
 * That no integrator meets the tolerance is no error: see is_met. The caller frees *tuning, which is NULL on failure. */
fp3_status fp3_tune(const fp3_tune_def *def, fp3_tuning **tuning, fp3_error *error);
/* Sets *tuning to NULL; that it was NULL before does no harm. */
void fp3_tuning_free(fp3_tuning **tuning);

/* The best row as a scene file (docs/scenes.md). program: the model as the scene is to name it. The
 * caller frees *text. FP3_E_ARGUMENT: there is no best row. */
fp3_status fp3_tuning_scene(const fp3_tune_def *def, const fp3_tuning *tuning, const char *program,
                            uint32_t objects, char **text, fp3_error *error);

/* ---- truth: where an object really is, and how the error falls with the time step ----
 * how the error falls with the time step. Experimental: it may change from version to version.
 *
 *     fp3_ladder *ladder = NULL;
 *     fp3_convergence found;
 *     if (fp3_ladder_open(model, 0, 100000, &ladder, &error) ||
 *         fp3_converge(ladder, compiled, compiled->order, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("order %.2f, error %.1e at best\n", found.order, found.floor);
 *     fp3_ladder_close(&ladder);
 */

/* At time t (negative, too): GSL's rk8pd at tight tolerance, and the closed forms of the model if it
 * has them, with which it must agree: FP3_E_MISMATCH. states has model->state_count numbers. */
fp3_status fp3_model_truth(const fp3_model *model, const double *params, const double *initial,
                           double t, double *states, fp3_error *error);
/* At several times above 0, upwards, in one go: states has a row of model->state_count numbers for each
 * of count times. sizes (may be NULL) gets the largest magnitude of each state up to the last; with it
 * two truths are compared at each time. FP3_E_ARGUMENT: also for other times. */
fp3_status fp3_model_truths(const fp3_model *model, const double *params, const double *initial,
                            const double *times, size_t count, double *states, double *sizes,
                            fp3_error *error);

/* ---- the steps of a compiled program, straight from the equations ---- */

/* Without any pass that keeps the bits, in FP32: what every engine must equal bit for bit. params,
 * initial and h as of fp3_compiled_inputs. states has count rows of model->state_count floats. Row i gets,
 * after steps[i] steps (none less than the one before), the states that are computed (observed, or
 * needed by what is), a NaN as 7FC00000; others are unchanged. */
fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error);

/* The same with the second words of double-single, which are 0 in any other arithmetic. low has as many
 * floats as states; a state is the sum of its two. */
fp3_status fp3_compiled_reference_pairs(const fp3_compiled *compiled, const double *params,
                                        const double *initial, double h, const uint64_t *steps,
                                        size_t count, float *states, float *low, fp3_error *error);

/* The same steps in double, with quotients and roots in double: the integrator without FP32. All other
 * functions are the same polynomials. */
fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error);

/* The same steps in double again, by the numbers that the host gives the program, rounded as the program has them
 * (h, params, coefficients and what is made of them): what FP32 does to the method before a step is made. Of
 * double-single nothing is rounded. The start is not, either. */
fp3_status fp3_compiled_exact_given(const fp3_compiled *compiled, const double *params,
                                    const double *initial, double h, const uint64_t *steps,
                                    size_t count, double *states, fp3_error *error);

/* ---- how the error of a program falls with its time step ---- */

#define FP3_RUNGS_MOST 40
#define FP3_STEPS_MOST 8388608 /* of the last of so many rungs */
#define FP3_LOOKS                                                                                  \
    8 /* times at which a run is compared with the truth, evenly, the last at its end */

/* Runs of one model over the same span, each with about 1.4 times the steps of the one before, and
 * where the object then really is. Read it, never change it. */
typedef struct {
    const fp3_model *model;   /* the caller's; it must outlive the ladder */
    double *params, *initial; /* the model's defaults, as FP32 has them */
    double *scale;            /* of each state: the largest magnitude along the truth */
    unsigned count;           /* rungs */
    uint64_t steps[FP3_RUNGS_MOST];
    float h[FP3_RUNGS_MOST];
    double *truth[FP3_RUNGS_MOST]; /* FP3_LOOKS rows of a number for each state */
} fp3_ladder;

/* span: how long the model is integrated, in its unit of time; 0: the model's own span. most_steps:
 * of the last rung, at least FP3_LOOKS. The caller closes *ladder, which is NULL on failure.
 * FP3_E_MISMATCH as of fp3_model_truth. */
fp3_status fp3_ladder_open(const fp3_model *model, double span, uint64_t most_steps,
                           fp3_ladder **ladder, fp3_error *error);
/* Sets *ladder to NULL; that it was NULL before does no harm. */
void fp3_ladder_close(fp3_ladder **ladder);

typedef struct {
    /* By rung, relative to the scale, root of the mean square over states and looks. NaN or infinite
     * where a run went wrong; NaN also beyond the rung from which only noise is left. */
    double error[FP3_RUNGS_MOST];  /* of FP32 */
    double method[FP3_RUNGS_MOST]; /* of the same steps in double: the integrator's own */
    double noise[FP3_RUNGS_MOST];  /* between the two */
    /* Slopes of error and method over rungs from .. to, where the noise is small beside the method's
     * error; NaN: there are no such rungs. */
    double order, method_order;
    unsigned from, to;
    double finest_order; /* slope of method as far down as double sees it; NaN likewise */
    double floor;        /* the smallest error ... */
    unsigned best;       /* ... and its rung */
} fp3_convergence;

/* Runs the program's reference, which has the bits of every engine. compiled: from the ladder's
 * model; order: the theoretical one, which says over how many rungs slopes are taken. */
fp3_status fp3_converge(const fp3_ladder *ladder, const fp3_compiled *compiled, unsigned order,
                        fp3_convergence *convergence, fp3_error *error);

FP3_API_END

#endif
