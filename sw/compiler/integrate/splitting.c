/* SPDX-License-Identifier: Apache-2.0 */
/* splitting.c - substeps, each of which moves all positions or all velocities. */
#include "splitting.h"

#include "weights.h"

static term state_now(lowering *l, uint32_t state) {
    const fp3_advance *a = l->user;
    return a->now[state];
}

static int is_moved(const fp3_advance *a, const fp3_substep *substep, uint32_t state) {
    return fp3_fit_is_live(a->fit, state) &&
           fp3_fit_is_position(a->fit, state) != (substep->is_kick != 0);
}

/* All increments come from the states before the substep. */
static void advance(const fp3_advance *a, unsigned i, const fp3_substep *substep,
                    double coefficient) {
    const fp3_model *model = a->step->model;
    dag *g = &a->step->values;
    fp3_notes *notes = &a->step->notes;
    term d[FP3_STATES_MAX];
    for (uint32_t s = 0; s < model->state_count; s++) {
        if (!is_moved(a, substep, s))
            continue;
        const term f = substep->is_kick ? fp3_lower(&a->places[i], model->states[s].derivative)
                                        : a->now[model->states[s].velocity];
        g->note =
            fp3_note(notes, "%u: %s of %s by %.6g h", i + 1, substep->is_kick ? "kick" : "drift",
                     fp3_advance_name(a, s), substep->coefficient);
        d[s] = fp3_term_mul(g, fp3_advance_scaled_step(a, coefficient, 1), f);
    }
    for (uint32_t s = 0; s < model->state_count; s++)
        if (is_moved(a, substep, s)) {
            g->note = fp3_note(notes, "%u: new %s", i + 1, fp3_advance_name(a, s));
            a->now[s] = fp3_advance_update(a, s, a->now[s], d[s]);
        }
}

/* The coefficients of all kicks, or of all drifts, add up to 1. */
static void fit(const fp3_advance *a, int is_kick, double *coefficient) {
    double list[FP3_STAGES_MAX];
    unsigned count = 0;
    for (unsigned i = 0; i < a->integrator->stages; i++)
        if (a->integrator->substeps[i].is_kick == is_kick)
            list[count++] = a->integrator->substeps[i].coefficient;
    fp3_weights(a, list, NULL, count, 1);
    for (unsigned i = a->integrator->stages; i-- > 0;)
        if (a->integrator->substeps[i].is_kick == is_kick)
            coefficient[i] = list[--count];
}

fp3_status fp3_splitting(fp3_advance *a, fp3_error *error) {
    const fp3_status status = fp3_advance_places(a, a->integrator->stages, "", state_now, a, error);
    double coefficient[FP3_STAGES_MAX];
    fit(a, 0, coefficient);
    fit(a, 1, coefficient);
    double drifted = 0; /* time moves with the positions */
    for (unsigned i = 0; !status && i < a->integrator->stages; i++) {
        const fp3_substep *substep = &a->integrator->substeps[i];
        if (a->fit->has_time)
            a->places[i].time = fp3_advance_time(a, &a->step->values, drifted);
        drifted += substep->is_kick ? 0 : substep->coefficient;
        fp3_advance_show(a, &a->places[i]);
        advance(a, i, substep, coefficient[i]);
    }
    return status;
}
