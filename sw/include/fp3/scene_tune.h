/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/scene_tune.h - finds the cheapest way to integrate a scene whose objects see each other to a
 * tolerance, by measuring.
 *
 *     fp3_scene_tune_def def = fp3_scene_tune_default();
 *     def.path = "stars.scene";
 *     def.tolerance = 1e-3;
 *     fp3_scene_tuning *found = NULL;
 *     if (fp3_scene_tune(&def, &found, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else if (found->is_met)
 *         printf("%s\n", found->rows[found->best].integrator);
 *     fp3_scene_tuning_free(&found);
 *
 * docs/tuner.md describes the search, and how safe the choice is.
 *
 * This header belongs to the library libfp3_lab, which needs GSL.
 *
 * Threads: a call works in the calling thread. Calls in different threads do not affect each other.
 * Experimental.
 */
#ifndef FP3_SCENE_TUNE_H
#define FP3_SCENE_TUNE_H

#include <fp3/compile.h>
#include <fp3/model.h>
#include <fp3/scene.h>
#include <fp3/scene_truth.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

typedef enum {
    FP3_SCENE_COST_CYCLES, /* of hardware, predicted: the same in each search */
    FP3_SCENE_COST_TIME    /* of engine fast with one thread, measured */
} fp3_scene_cost;

/* What to search. Always start from fp3_scene_tune_default(). */
typedef struct {
    uint32_t cookie;    /* as in fp3_compile_def */
    const char *path;   /* of the scene */
    const char *config; /* replaces the scene's unless it is NULL */
    /* An error is the largest distance of any state of any object from the solution, as a share of
     * the size of that state (fp3_scene_sizes), at any of the times that are looked at. */
    double tolerance;
    uint64_t steps; /* how many of the scene's steps to integrate; 0: all */
    double safety;  /* at least 1: the sample must meet tolerance / safety */
    /* Scenes that the choice sees, the first of them as it is, and that judge it. The others have
     * other seeds, where objects are placed at random. */
    uint32_t sample, held_out;
    double around; /* where they are not, starts differ by up to this share of the state's size */
    fp3_scene_cost cost;
    /* Of each solution: fp3_scene_truth_def. within 0: 1e-5, or a tenth of a smaller tolerance. */
    double within, work;
    /* NULL, or called before each part of the work. */
    void (*say)(void *user, const char *what);
    /* NULL, or asked often: 1 ends the search, which has what it found so far. */
    int (*stop)(void *user);
    void *user;
} fp3_scene_tune_def;

/* For fp3_scene_tune_default() only. size is that of fp3_scene_tune_def in the calling program. */
void fp3_scene_tune_set_default(fp3_scene_tune_def *def, size_t size);
/* No tolerance; safety 2, a sample of 2 scenes, 4 held out in each of 4 rounds at most, starts
 * around 1e-3, cost in cycles, within 0, work as of fp3_scene_truth_default. */
static inline fp3_scene_tune_def fp3_scene_tune_default(void) {
    fp3_scene_tune_def def;
    fp3_scene_tune_set_default(&def, sizeof def);
    return def;
}

/* A combination that was tried: an integrator and an arithmetic of all groups that move, and a
 * length of step. */
typedef struct {
    char integrator[FP3_NAME_SIZE];
    fp3_arithmetic arithmetic;
    uint64_t parts, joined; /* its steps: so many steps make so many of the scene's */
    double h;               /* of the first group */
    double error;           /* the largest so far where it was given up; infinite: it failed */
    uint64_t kept; /* up to this step of the scene it met the target in each scene that it saw */
    double cycles; /* per object over the steps; 0: it cannot be compiled */
    double ns;     /* likewise; 0: not measured */
    int is_met;    /* the sample met the target */
} fp3_scene_tune_row;

/* An integrator and an arithmetic that the scene cannot have. */
typedef struct {
    char integrator[FP3_NAME_SIZE];
    fp3_arithmetic arithmetic;
    char why[160];
} fp3_scene_tune_refusal;

/* Never change the result. */
typedef struct {
    fp3_scene_tune_row *rows; /* in the order in which they were tried */
    size_t row_count, best;   /* best: row_count if no row met the target */
    fp3_scene_tune_refusal *refusals;
    size_t refusal_count;
    fp3_scene_tune_row own;    /* the scene as it is */
    double skin;               /* of the lists of near objects, with which it was fastest; below 0:
                                  not asked, or no such lists */
    int is_met;                /* there is a best row, and the held-out scenes meet the tolerance */
    int is_stopped;            /* before it was done */
    uint64_t steps;            /* that were asked for */
    uint64_t known;            /* up to this step each of the scenes has a solution */
    double target;             /* error that the sample had to meet */
    uint32_t sample, held_out; /* scenes that the choice saw, and that judged it */
    uint32_t rounds;           /* of held-out scenes: those of all but the last were seen later */
    double error_held_out;     /* of the best row; NaN: there is none */
    char differ[160];          /* in what the scenes of the sample and those held out do so */
    double within;             /* of each solution */
    fp3_scene_solved solved;   /* of the scene as it is */
    size_t objects;
    char config[FP3_NAME_SIZE];
} fp3_scene_tuning;

/* Searches. The caller frees *tuning, which is NULL on failure. It is not an error if nothing meets
 * the tolerance: see is_met. FP3_E_ARGUMENT: the tolerance is not below 1, or too near to `within`;
 * a scene whose objects do not see each other, or whose groups have steps of different lengths; a
 * definition from another version of the library; as of fp3_scene_open. FP3_E_PROGRAM: as of
 * fp3_scene_solution. FP3_E_FAILED: a scene has no solution; the message says why. */
fp3_status fp3_scene_tune(const fp3_scene_tune_def *def, fp3_scene_tuning **tuning,
                          fp3_error *error);
/* Frees *tuning and sets it to NULL. *tuning may be NULL already. */
void fp3_scene_tuning_free(fp3_scene_tuning **tuning);

/* The scene with the best row's settings. The text is that of a file in `folder`, from where the
 * scene's files are named; NULL: in the scene's own. The caller frees *text. FP3_E_ARGUMENT: there
 * is no best row. */
fp3_status fp3_scene_tuning_text(const fp3_scene_tune_def *def, const fp3_scene_tuning *tuning,
                                 const char *folder, char **text, fp3_error *error);

FP3_API_END

#endif
