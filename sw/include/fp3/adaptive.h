/* fp3/adaptive.h - steps that each object chooses by itself.
 *
 *     fp3_adaptive_def def = fp3_adaptive_default();
 *     fp3_compile_def how = fp3_compile_default();
 *     fp3_adaptive_report report;
 *     def.until = 17.0652;
 *     if (fp3_model_adapt(model, &def, &error) ||
 *         fp3_compile(model, integrator, &how, &compiled, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     // Load compiled->image and write its inputs, which fp3_compiled_inputs computes, then:
 *     if (fp3_engine_advance(engine, FP3_ADAPTIVE_ATTEMPTS, &stats) ||
 *         fp3_adaptive_report_make(engine, 0, fp3_engine_objects(engine), &report))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("%zu objects did not reach the end\n", report.failed);
 *
 * docs/adaptive.md says what a step computes, and how the two words of t keep time.
 */
#ifndef FP3_ADAPTIVE_H
#define FP3_ADAPTIVE_H

#include <fp3/api.h>
#include <fp3/engine.h>
#include <fp3/model.h>

FP3_API_BEGIN

/* Defaults of the params that an adapted model has; all in the model's own units. */
typedef struct {
    double tolerance; /* of a step's error, relative to the size of the state; default 1e-5 */
    double
        absolute; /* what counts as the size of a small state, times tolerance; 0: the same number as tolerance */
    double until;  /* the time at which objects end; 0: the model's span */
    double locate; /* an event is at most this late; 0: tolerance * until */
} fp3_adaptive_def;

fp3_adaptive_def fp3_adaptive_default(void);

/* The integrator of a model where none is named: with fixed steps, and with adaptive ones. */
#define FP3_FIXED_INTEGRATOR "rk4"
#define FP3_ADAPTIVE_INTEGRATOR "cash_karp"

/* Gives the model what adaptive steps need: states t, h_next (the next step to try; it starts as the model's), accepted, rejected, smallest, largest, in this order behind its own; params until, of each object, and tolerance, absolute
 * and, if there are events, locate, which all objects share. fp3_compile then makes a program of
 * adaptive steps. FP3_E_PROGRAM: the model has one of these names, or is too large. */
fp3_status fp3_model_adapt(fp3_model *model, const fp3_adaptive_def *def, fp3_error *error);

/* The index of state t, behind which the others follow; FP3_NONE: the model is not adapted. */
uint32_t fp3_model_adapted(const fp3_model *model);

#define FP3_ADAPTIVE_ATTEMPTS 1000000u /* a limit for who has none */

typedef enum {
    FP3_ADAPTIVE_ENDED,   /* t is until, and all states are finite */
    FP3_ADAPTIVE_STUCK,   /* the tolerance asks for a step that is too short even for two words */
    FP3_ADAPTIVE_LIMITED, /* on its way when no more attempts were left */
    FP3_ADAPTIVE_LOST     /* t is until, and a state is not finite */
} fp3_adaptive_end;

/* Whether a program has adaptive steps: it has states t and h_next, and an `until`. */
int fp3_adaptive_is(const fp3_image *image);

/* Of one object after a run. */
typedef struct {
    fp3_adaptive_end end;
    float t, step, until; /* step: the next one to try */
    uint32_t accepted, rejected;
    float smallest, largest;
    char state[FP3_NAME_SIZE]; /* LOST: the first that is not finite */
    float t_low;               /* the time is t + t_low */
} fp3_adaptive_object;

/* FP3_E_ARGUMENT: no such object, or its program has no adaptive steps. Counts that the program does not keep are 0. */
fp3_status fp3_adaptive_look(fp3_engine *engine, size_t object, fp3_adaptive_object *found);

/* "object 3 at t = 0.5 of 17.0625, after 12 steps and 3 attempts: ..." */
#define FP3_ADAPTIVE_TEXT_SIZE 240
void fp3_adaptive_text(size_t object, const fp3_adaptive_object *found,
                       char text[FP3_ADAPTIVE_TEXT_SIZE]);

/* Runs what is loaded, whatever its steps are. Of fixed ones each object makes `most`. Adaptive ones go on until
 * each object has ended, or has made `most` attempts; beside groups with fixed steps it has FP3_ADAPTIVE_ATTEMPTS at
 * least. *stats (it may be NULL) is the sum of the runs that this takes: one, but where one object cannot sleep as
 * many as it takes not to go far beyond its end, where steps change nothing. Errors as of fp3_engine_run;
 * FP3_E_PROGRAM: the configuration interleaves, and a program of adaptive steps has no sleep. */
fp3_status fp3_engine_advance(fp3_engine *engine, uint64_t most, fp3_stats *stats);

typedef struct {
    uint32_t least, median, most;
} fp3_adaptive_counts;

/* Of objects first .. first+count-1. */
typedef struct {
    fp3_adaptive_counts accepted, rejected;
    float smallest,
        largest; /* accepted steps; the smallest as long as it was before the end cut it off. 0: there was none */
    size_t failed, first;    /* how many did not end, and the first of them */
    fp3_adaptive_object why; /* what is known of that */
} fp3_adaptive_report;

/* FP3_E_ARGUMENT as of fp3_adaptive_look; FP3_E_SYSTEM: out of memory. */
fp3_status fp3_adaptive_report_make(fp3_engine *engine, size_t first, size_t count,
                                    fp3_adaptive_report *report);

FP3_API_END

#endif
