/* before.c - states at the start, and one step before it. */
#include "before.h"

#include <fp3/tune.h>
#include <stdlib.h>

static int needs_truth(const fp3_step *step) {
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (step->variables[i].role == ROLE_BEFORE)
            return 1;
    return 0;
}

/* So that (x - x_before) + lost_before in FP32 is what it is in double: else h v would be off by half a unit of x
 * for the whole run, and v by that over h. */
static double lost_before(double x, double before) {
    return (double)(float)((x - before) - ((double)(float)x - (double)(float)before));
}

fp3_status fp3_before_start(const fp3_step *step, const double *params, const double *initial,
                            double h, double *start, fp3_error *error) {
    double *before = calloc(step->model->state_count + 1u, sizeof *before);
    fp3_status status = before ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status && needs_truth(step))
        status = fp3_model_truth(step->model, params, initial, -h, before, error);
    for (uint32_t i = 0; !status && i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        const double value = v->role == ROLE_STATE || v->role == ROLE_LOW ? initial[v->state]
                             : v->role == ROLE_BEFORE || v->role == ROLE_LOW_BEFORE
                                 ? before[v->state]
                                 : 0;
        const int is_low = v->role == ROLE_LOW || v->role == ROLE_LOW_BEFORE;
        start[i] = is_low ? fp3_known_low(value) : value;
        if (v->role == ROLE_LOST_BEFORE)
            start[i] = lost_before(initial[v->state], before[v->state]);
    }
    free(before);
    return status;
}
