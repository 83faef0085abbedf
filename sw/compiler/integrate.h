/* integrate.h - what build.c and integrate.c share: states and their variables, notes, and a step by
 * each kind of integrator.
 */
#ifndef FP3_INTEGRATE_H
#define FP3_INTEGRATE_H

#include "build.h"

#define BIT(state) (UINT64_C(1) << (state))

/* Of build.c. A note is for those who read the assembly. */
__attribute__((format(printf, 2, 3))) uint32_t fp3_note(build *b, const char *format, ...);
uint32_t fp3_note_expr(lowering *l, uint32_t expr);
uint32_t fp3_variable_of(const build *b, role role, uint32_t state);
/* A variable as it was when the step began. */
term fp3_held(build *b, role role, uint32_t state);

/* The first position that this state is the velocity of, or FP3_NONE. */
uint32_t fp3_position_of(const build *b, uint32_t velocity);

/* Of integrate.c. What a state is where an expression of a place is evaluated. */
term fp3_integrate_state(lowering *l, uint32_t state);
/* now and lost become those after the step. */
fp3_status fp3_integrate(build *b, fp3_error *error);

static inline const fp3_quantity *state_of(const build *b, uint32_t state) {
    return &b->model->states[state];
}

static inline const char *name_of(const build *b, uint32_t state) {
    return state_of(b, state)->name;
}

static inline int is_live(const build *b, uint32_t state) { return (b->live & BIT(state)) != 0; }

/* A position is a state whose derivative is another state, alone, that is no position itself. */
static inline int is_position(const build *b, uint32_t state) {
    const uint32_t velocity = state_of(b, state)->velocity;
    return velocity != FP3_NONE && state_of(b, velocity)->velocity == FP3_NONE;
}

#endif
