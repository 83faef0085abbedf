/* skip_cases.c - which ways of skipping are measured, and on what. */
#include "skip.h"

#include <stddef.h>

#define OFF(PASS) FP3_PASS(FP3_PASS_##PASS)

#define BY_PASS(NAME, PASS, MODEL, INTEGRATOR)                                                     \
    {                                                                                              \
        .way = NAME, .program = "programs/" MODEL ".ode", .integrator = INTEGRATOR,                \
        .configs = {"many_full", "single_full"}, .side = {                                         \
            {.what = "done", .without = OFF(PASS)},                                                \
            {.what = "left out"}                                                                   \
        }                                                                                          \
    }

#define OBSERVED(MODEL, INTEGRATOR, WHAT, ...)                                                     \
    {                                                                                              \
        .way = "unobserved outputs", .program = "programs/" MODEL ".ode",                          \
        .integrator = INTEGRATOR, .configs = {"many_full", "single_full"}, .side = {               \
            {.what = "all", .without = OFF(DEAD), .observed = {__VA_ARGS__}},                      \
            {.what = WHAT, .observed = {__VA_ARGS__}}                                              \
        }                                                                                          \
    }

/* Constants are loaded once for a visit, so visits are short here. */
#define SHARED(MODEL)                                                                              \
    {                                                                                              \
        .way = "shared constants", .program = "programs/" MODEL ".ode", .integrator = "rk4",       \
        .visit = 1, .configs = {"many_full", "single_full"}, .side = {                             \
            {.what = "in each object", .without = OFF(SHARE)},                                     \
            {.what = "shared"}                                                                     \
        }                                                                                          \
    }

#define IDLE(NAME, KIND, PROGRAM, WHAT)                                                            \
    {                                                                                              \
        .way = NAME, .program = PROGRAM, .integrator = "rk4", .idle = KIND,                        \
        .configs = {"many_full"}, .side = {                                                        \
            {"100 % " WHAT, .percent = 100},                                                       \
            {"50 % " WHAT, .percent = 50},                                                         \
            {"10 % " WHAT, .percent = 10},                                                         \
            {"1 % " WHAT, .percent = 1},                                                           \
            {"0 % " WHAT, .percent = 0}                                                            \
        }                                                                                          \
    }

/* `lanes` keeps no status of its objects. */
#define FLAGS(PROGRAM)                                                                             \
    {                                                                                              \
        .way = "flags", .program = PROGRAM, .integrator = "rk4", .side = {                         \
            {.what = "of each object, with the first failing step", .config = "many"},             \
            {.what = "of the run", .config = "lanes"}                                              \
        }                                                                                          \
    }

static const skip_case cases[] = {
    OBSERVED("ship", "rk4", "the speed alone", "v"),
    OBSERVED("rigid_body", "rk4", "the angular velocity alone", "w_x", "w_y", "w_z"),
    OBSERVED("sir", "dopri5", "not those who are well again", "S", "I"),
    BY_PASS("coefficients 0", ZERO, "ship", "rk4"),
    BY_PASS("coefficients 0", ZERO, "lorenz", "dopri5"),
    BY_PASS("coefficients 0", ZERO, "kepler", "rk6"),
    BY_PASS("coefficients 1", IDENTITY, "ship", "rk4"),
    BY_PASS("coefficients 1", IDENTITY, "lorenz", "rk4"),
    BY_PASS("coefficients 1", IDENTITY, "kepler", "rk4"),
    SHARED("fitzhugh_nagumo"),
    SHARED("lorenz"),
    SHARED("rigid_body"),
    IDLE("sleep", SKIP_SLEEP, "programs/ship_sleep.s", "awake"),
    IDLE("lifetimes", SKIP_LIFE, "programs/lorenz.ode", "alive"),
    IDLE("lifetimes", SKIP_LIFE, "programs/kepler.ode", "alive"),
    FLAGS("programs/ship.s"),
    FLAGS("programs/lotka_volterra.ode"),
    FLAGS("programs/fitzhugh_nagumo.ode"),
};

const skip_case *skip_case_at(unsigned number) {
    return number < sizeof cases / sizeof *cases ? &cases[number] : NULL;
}
