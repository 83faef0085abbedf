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
 */
#ifndef FP3_TUNE_H
#define FP3_TUNE_H

#include <fp3/api.h>
#include <fp3/program.h>
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
    int is_adaptive; /* fp3/adaptive.h: it has a tolerance and no number of steps */
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

FP3_API_END

#endif
