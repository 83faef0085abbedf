/* sundials.c - CVODE and ARKODE of SUNDIALS, each with a sweep of tolerances.
 *
 * Memory is made once and initialised again for each object. CVODE's Newton iteration gets its
 * Jacobian by its own differences.
 */
#include "sundials.h"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#define STEPS_MOST 1000000 /* of one object */
#define SECONDS_MOST 1.0   /* of all objects, per run */

static const struct {
    const char *name;
    int lmm;        /* of CVODE; 0: ARKODE */
    unsigned order; /* of ARKODE */
} methods[] = {
    {"cvode adams", CV_ADAMS, 0}, {"cvode bdf", CV_BDF, 0}, {"arkode erk3", 0, 3},
    {"arkode erk4", 0, 4},        {"arkode erk5", 0, 5},    {"arkode erk8", 0, 8},
};
enum { METHODS = sizeof methods / sizeof *methods };

typedef struct {
    int is_cvode;
    SUNContext context;
    void *memory;
    N_Vector y, tolerances;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver nonlinear;
    fp3_measure_slopes_fn *slopes;
    double *params; /* of the present object; not owned */
} solver;

static int slopes(realtype t, N_Vector y, N_Vector f, void *self) {
    const solver *s = self;
    return s->slopes(t, N_VGetArrayPointer(y), N_VGetArrayPointer(f), s->params);
}

static void quiet(int code, const char *module, const char *function, char *text, void *self) {
    (void)code, (void)module, (void)function, (void)text, (void)self;
}

static int one(solver *s, double end) {
    realtype t;
    int result;
    if (s->is_cvode) {
        result = CVodeReInit(s->memory, 0, s->y);
        if (!result)
            result = CVodeSetStopTime(s->memory, end);
        return result ? result : CVode(s->memory, end, s->y, &t, CV_NORMAL);
    }
    result = ERKStepReInit(s->memory, slopes, 0, s->y);
    if (!result)
        result = ERKStepSetStopTime(s->memory, end);
    return result ? result : ERKStepEvolve(s->memory, end, s->y, &t, ARK_NORMAL);
}

static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    const fp3_measure_problem *p = point->problem;
    solver *s = point->self;
    const size_t states = p->model->state_count;
    const double begin = fp3_measure_now(), spent = fp3_measure_spent();
    for (unsigned v = 0; v < p->variants; v++) {
        s->params = p->params + v * p->model->param_count;
        memcpy(N_VGetArrayPointer(s->y), p->initial + v * states, states * sizeof(double));
        const int result = one(s, p->end);
        memcpy(point->ends + v * states, N_VGetArrayPointer(s->y), states * sizeof(double));
        if (result < 0) {
            char *name =
                s->is_cvode ? CVodeGetReturnFlagName(result) : ERKStepGetReturnFlagName(result);
            fp3_fail(error, FP3_E_LIMIT, "%s", name);
            free(name);
            return FP3_E_LIMIT;
        }
        if (fp3_measure_spent() - spent > SECONDS_MOST)
            return fp3_fail(error, FP3_E_LIMIT, "%u of %u objects took more than %g s", v + 1,
                            p->variants, SECONDS_MOST);
    }
    *seconds = fp3_measure_now() - begin;
    return FP3_OK;
}

static void close_solver(fp3_measure_point *point) {
    solver *s = point->self;
    if (s->memory && s->is_cvode)
        CVodeFree(&s->memory);
    else if (s->memory)
        ERKStepFree(&s->memory);
    if (s->nonlinear)
        SUNNonlinSolFree(s->nonlinear);
    if (s->linear)
        SUNLinSolFree(s->linear);
    if (s->matrix)
        SUNMatDestroy(s->matrix);
    if (s->y)
        N_VDestroy(s->y);
    if (s->tolerances)
        N_VDestroy(s->tolerances);
    if (s->context)
        SUNContext_Free(&s->context);
    free(s);
}

static int open_cvode(solver *s, int lmm, sunindextype states) {
    s->memory = CVodeCreate(lmm, s->context);
    int result = s->memory ? CVodeInit(s->memory, slopes, 0, s->y) : -1;
    if (!result)
        result = CVodeSetErrHandlerFn(s->memory, quiet, NULL);
    if (!result)
        result = CVodeSVtolerances(s->memory, 0, s->tolerances);
    if (!result)
        result = CVodeSetUserData(s->memory, s);
    if (!result)
        result = CVodeSetMaxNumSteps(s->memory, STEPS_MOST);
    if (!result && lmm == CV_ADAMS) {
        s->nonlinear = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
        result = s->nonlinear ? CVodeSetNonlinearSolver(s->memory, s->nonlinear) : -1;
    } else if (!result) {
        s->matrix = SUNDenseMatrix(states, states, s->context);
        s->linear = s->matrix ? SUNLinSol_Dense(s->y, s->matrix, s->context) : NULL;
        result = s->linear ? CVodeSetLinearSolver(s->memory, s->linear, s->matrix) : -1;
    }
    return result;
}

static int open_erk(solver *s, unsigned order) {
    s->memory = ERKStepCreate(slopes, 0, s->y, s->context);
    int result = s->memory ? ERKStepSetErrHandlerFn(s->memory, quiet, NULL) : -1;
    if (!result)
        result = ERKStepSetOrder(s->memory, (int)order);
    if (!result)
        result = ERKStepSVtolerances(s->memory, 0, s->tolerances);
    if (!result)
        result = ERKStepSetUserData(s->memory, s);
    return result ? result : ERKStepSetMaxNumSteps(s->memory, STEPS_MOST);
}

/* Errors are relative to the scale of a state, as they are told. */
static int open_solver(solver *s, int method, const fp3_measure_problem *p, double tolerance) {
    const sunindextype states = p->model->state_count;
    if (SUNContext_Create(NULL, &s->context))
        return -1;
    s->y = N_VNew_Serial(states, s->context);
    s->tolerances = N_VNew_Serial(states, s->context);
    if (!s->y || !s->tolerances)
        return -1;
    for (sunindextype i = 0; i < states; i++)
        N_VGetArrayPointer(s->tolerances)[i] = tolerance * (p->scale[i] > 0 ? p->scale[i] : 1);
    memcpy(N_VGetArrayPointer(s->y), p->initial, (size_t)states * sizeof(double));
    s->is_cvode = methods[method].lmm != 0;
    s->params = p->params;
    return s->is_cvode ? open_cvode(s, methods[method].lmm, states)
                       : open_erk(s, methods[method].order);
}

fp3_status bench_add_sundials(fp3_measure_points *points, const fp3_measure_problem *problem,
                              const fp3_measure_options *options, fp3_measure_slopes_fn *slopes_of,
                              fp3_error *error) {
    for (int m = 0; m < METHODS; m++)
        for (unsigned d = options->fewest_digits; d <= options->most_digits;
             d += options->digits_apart) {
            fp3_measure_point point = {.engine = "sundials",
                                       .method = methods[m].name,
                                       .tolerance = pow(10, -(double)d),
                                       .threads = 1,
                                       .objects = problem->variants,
                                       .run = run,
                                       .close = close_solver,
                                       .problem = problem};
            solver *s = point.self = calloc(1, sizeof *s);
            if (!s)
                return fp3_no_memory(error);
            s->slopes = slopes_of;
            if (open_solver(s, m, problem, point.tolerance) ||
                !fp3_measure_points_add(points, &point)) {
                close_solver(&point);
                return fp3_fail(error, FP3_E_SYSTEM, "SUNDIALS' %s does not start",
                                methods[m].name);
            }
        }
    return FP3_OK;
}
