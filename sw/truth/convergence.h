/* convergence.h - how the error of a program falls with its time step. */
#ifndef FP3_CONVERGENCE_H
#define FP3_CONVERGENCE_H

#include <fp3/compile.h>

#define LADDER_MAX 40
#define LADDER_LOOKS 8 /* times that a run is looked at, evenly, the last one at its end */

/* Runs of one model over the same span with ever more steps, and where the object then really is. */
typedef struct {
    const fp3_model *model;
    double *params, *initial; /* as FP32 has them */
    double *scale;            /* of each state: how large it gets */
    unsigned count;
    uint64_t steps[LADDER_MAX];
    float h[LADDER_MAX];
    double *truth[LADDER_MAX]; /* at each look, of each state */
} ladder;

/* span: 0 for the model's. The caller closes, after a failure too. */
fp3_status fp3_ladder_open(ladder *l, const fp3_model *model, double span, uint64_t most_steps,
                           fp3_error *error);
void fp3_ladder_close(ladder *l);

typedef struct {
    /* At each rung, relative, root of the mean square over states and looks; NaN or infinite where
     * it went wrong. */
    double error[LADDER_MAX];  /* of FP32 */
    double method[LADDER_MAX]; /* of the same in double: the integrator's own */
    double noise[LADDER_MAX];  /* between the two */
    /* Slopes of error and method where the noise is small beside the method's error; NaN: there is
     * no such place. */
    double order, method_order;
    unsigned from, to;   /* between which rungs */
    double finest_order; /* slope of method as far down as double sees it */
    double floor;        /* the smallest error */
    unsigned best;       /* its rung */
} convergence;

/* Runs the program's reference, which is bit for bit what the engines compute. */
fp3_status fp3_converge(const ladder *l, const fp3_compiled *compiled, unsigned order,
                        convergence *c, fp3_error *error);

#endif
