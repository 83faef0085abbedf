/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/tune.h - finds the cheapest way to integrate a model to a tolerance, by measuring.
 *
 *     fp3_tune_def def = fp3_tune_default();
 *     def.program = program;     // a model, opened for a configuration
 *     def.params = params;       // spread values are the ranges
 *     def.tolerance = 1e-4;
 *     fp3_tuning *found = NULL;
 *     if (fp3_tune(&def, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else if (found->is_met)
 *         printf("%s\n", found->rows[found->best].integrator);
 *     fp3_tuning_free(&found);
 *
 * docs/tuner.md describes the search, and how safe the choice is.
 *
 * This header belongs to the library libfp3_lab, which needs GSL.
 *
 * Threads: a call works in the calling thread. Calls in different threads do not affect each other.
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

/* An error is the largest distance of any state, after any step, from the truth at that time,
 * relative to the largest magnitude of that state along the object's truth. The error of several
 * objects is that of the worst. An infinite error means that a run failed. Of n steps or attempts,
 * where n is above FP3_TUNE_LOOKS, one in n / FP3_TUNE_LOOKS (rounded down) counts, and the last.
 * After the last step the truth is that of the end of the span. Around an event the object may be
 * on the other side of the event: docs/tuner.md. */
#define FP3_TUNE_LOOKS 1024
#define FP3_TUNE_LEAST                                                                             \
    1e-7 /* the smallest tolerance: FP32 rounds by 6e-8. Fewer bits need a larger tolerance */

typedef void fp3_tune_say_fn(void *user, const char *what);

/* What to search. Always start from fp3_tune_default(). */
typedef struct {
    uint32_t cookie;            /* as in fp3_compile_def */
    const fp3_program *program; /* a model for one of the known configurations, not adapted */
    const char *config;         /* that configuration: costs are its cycles */
    const fp3_params *params;   /* a spread value may have any value of its range */
    double tolerance;
    double span;    /* how long to integrate; 0: the model's span */
    double maxstep; /* of adaptive steps (fp3_adaptive_def); 0: none */
    double safety;  /* at least 1: in round n the sample must meet tolerance / safety^n */
    uint32_t sample, held_out; /* objects; without ranges one, and none */
    uint32_t rounds;           /* at most this number of held-out samples */
    fp3_tune_say_fn *say;      /* called before each part of the work, or NULL */
    void *user;
} fp3_tune_def;

/* For fp3_tune_default() only. size is that of fp3_tune_def in the calling program. */
void fp3_tune_set_default(fp3_tune_def *def, size_t size);
/* No tolerance; safety 1.25, a sample of 32 objects, 64 held out, 4 rounds. */
static inline fp3_tune_def fp3_tune_default(void) {
    fp3_tune_def def;
    fp3_tune_set_default(&def, sizeof def);
    return def;
}

/* A run of the sample: its cost per object, and its error. */
typedef struct {
    double cycles, error;
} fp3_tune_look;
#define FP3_TUNE_LOOKS_MOST 80 /* of one combination */

/* One combination that was tried: an integrator, an arithmetic, and fixed or adaptive steps. Fixed
 * steps of a model with events are tried twice: as they are, and cut at events (fp3_adaptive_def
 * with tolerance 0). */
typedef struct {
    char integrator[FP3_NAME_SIZE];
    fp3_arithmetic arithmetic;
    int is_adaptive; /* with a tolerance (fp3/compile.h) and no number of steps */
    int is_cut;      /* fixed steps that end at events and exactly with the span */
    uint64_t steps;  /* the fewest that met the target, else of the last look; 0: none */
    float h;
    /* With adaptive steps, likewise: tolerance and absolute of a step; and, also of steps that are
     * cut, the mean number of attempts that an object of the sample makes; 0: none. */
    double tolerance, absolute, attempts;
    double error;   /* of the sample with these steps */
    double lowest;  /* the lowest error, over all numbers of steps or tolerances tried */
    double cycles;  /* per object over the span, with all contexts full; 0: not compiled */
    uint32_t looks; /* runs of the sample in the last round, and the result of each */
    fp3_tune_look look[FP3_TUNE_LOOKS_MOST];
    int is_met;    /* the sample met the target */
    char why[160]; /* how it ended */
} fp3_tune_row;

/* Never change the result. */
typedef struct {
    fp3_tune_row *rows;
    size_t row_count, best; /* best: row_count if no row met the target */
    int is_met; /* there is a best row, and the last held-out sample meets the tolerance */
    double span;
    uint32_t ranges, sample, held_out; /* ranges; objects the choice has seen, and not seen */
    uint32_t rounds;
    double target;         /* error that the sample had to meet in the last round */
    double error_held_out; /* of the best row; NaN: there is none, or there are no ranges */
    double baseline_cycles, baseline_error; /* rk4, plain, at the model's default step */
    uint64_t baseline_steps;
    /* How far one unit in the last place of one number moves the truth of the first object, as an
     * error, and which param or start that is; "": none moves it. No arithmetic gives less. */
    double sensitivity;
    char sensitive[FP3_NAME_SIZE];
} fp3_tuning;

/* Searches. The caller frees *tuning, which is NULL on failure. It is not an error if no integrator
 * meets the tolerance: see is_met. FP3_E_PROGRAM: words of fewer bits cannot keep the tolerance.
 * FP3_E_ARGUMENT: the tolerance is below FP3_TUNE_LEAST, or not below 1; the span is not above 0,
 * or shorter than the model's step; the cycles of the configuration cannot be predicted; the
 * program is not a model, or has adaptive steps; a definition from another version of the library.
 * FP3_E_FAILED: an object of the sample has no truth; the message says why. */
fp3_status fp3_tune(const fp3_tune_def *def, fp3_tuning **tuning, fp3_error *error);
/* Frees *tuning and sets it to NULL. *tuning may be NULL already. */
void fp3_tuning_free(fp3_tuning **tuning);

/* The best row as a scene file (docs/scenes.md). program is the name of the model in the scene. The
 * caller frees *text. FP3_E_ARGUMENT: there is no best row. */
fp3_status fp3_tuning_scene(const fp3_tune_def *def, const fp3_tuning *tuning, const char *program,
                            uint32_t objects, char **text, fp3_error *error);

FP3_API_END

#endif
