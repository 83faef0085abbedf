/* fp3/integrator.h - integrators as tables, checked when they are read.
 *
 *     fp3_integrator *rk4 = NULL;
 *     if (fp3_integrator_find("rk4", &rk4, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("%s: order %u\n", rk4->name, rk4->order);
 *     fp3_integrator_free(&rk4);
 *
 * docs/integrators.md describes the tables and lists those that are built in.
 */
#ifndef FP3_INTEGRATOR_H
#define FP3_INTEGRATOR_H

#include <fp3/api.h>
#include <fp3/image.h>
#include <fp3/status.h>
#include <stdint.h>

FP3_API_BEGIN

typedef enum {
    FP3_RUNGE_KUTTA, /* k_i = h f(y + sum_j a_ij k_j), y += sum_i b_i k_i; explicit */
    FP3_SPLITTING,   /* kicks v += coefficient * h * a(x, v), drifts x += coefficient * h * v */
    FP3_STOERMER,    /* x_n+1 = (2 x_n - x_n-1) + h^2 a(x_n), for accelerations without v */
    FP3_ROSENBROCK,  /* k_i = h f(y + sum_j a_ij k_j) + h J sum_j gamma_ij k_j, y += sum_i b_i k_i;
                        linearly implicit: J is the Jacobian of f at y */
    FP3_CHEBYSHEV /* a Runge-Kutta method whose stages are a recurrence of three terms; explicit */
} fp3_integrator_kind;

#define FP3_STAGES_MAX 24

typedef struct {
    int is_kick; /* else a drift */
    double coefficient;
} fp3_substep;

/* With f_0 = f(y), E_1 = V_1 = first h f_0 and f_j = f(y + at[j] E_j): V_j+1 = V_j + bend E_j +
 * slope[j] h (f_j - share[j] f_0), E_j+1 = E_j + V_j+1, for j = 1 .. stages - 1. Then y += at[stages] E_stages. */
typedef struct {
    unsigned stages; /* 0: there is no recurrence */
    double first, bend;
    double at[FP3_STAGES_MAX], share[FP3_STAGES_MAX], slope[FP3_STAGES_MAX];
} fp3_recurrence;

/* The error of its step is taken to be WAY (h (f_0 + f_1)/2 - d), f_1 being the slope at the new state and d what was
 * added: Sommeijer, Shampine and Verwer, 1997. */
#define FP3_CHEBYSHEV_WAY 0.8

typedef struct {
    char name[FP3_NAME_SIZE];
    char *doc;
    char *source; /* of the table: author, year */
    fp3_integrator_kind kind;
    unsigned order;  /* checked: its conditions hold */
    unsigned stages; /* of Runge-Kutta; of a splitting, its substeps; of Chebyshev one more than its
                        recurrence has, the slope at the new state */
    /* Chebyshev: a, b, c are what the recurrence comes to. */
    double a[FP3_STAGES_MAX][FP3_STAGES_MAX], b[FP3_STAGES_MAX], c[FP3_STAGES_MAX];
    double gamma[FP3_STAGES_MAX][FP3_STAGES_MAX]; /* Rosenbrock: one number on the diagonal */
    fp3_recurrence recurrence;
    /* Runge-Kutta: a state whose derivative is another state v is advanced by h times the new v,
     * as in the paper's Equations (1), and has no stages: first order in that state. */
    int is_position_late;
    unsigned position_order; /* order of such a state: 1 if late, else order */
    fp3_substep substeps[FP3_STAGES_MAX];
    /* Runge-Kutta, Chebyshev, Rosenbrock: weights of a second method on the same stages, whose distance from the first is the
     * estimate of the error that adaptive steps need. */
    double embedded[FP3_STAGES_MAX];
    unsigned embedded_order; /* 0: there is none */
    /* The last stage is at the new state, so it is the first one of the next step. */
    int is_first_same_as_last;
} fp3_integrator;

/* text is a table in libconfig's syntax; name is for messages ("name:line: found ..., expected ...").
 * FP3_E_PROGRAM: the table is malformed or not explicit, or its order conditions do not hold for the
 * order that it claims (the message says which one fails, and by how much), or the estimate of its error
 * is 0 on y' = a y or y' = f(t), whatever the step. */
fp3_status fp3_integrator_read(const char *text, const char *name, fp3_integrator **integrator,
                               fp3_error *error);
/* The built-in table of this name, or, if name contains a '/' or ends in ".cfg", the table in that file.
 * FP3_E_ARGUMENT: there is none; the message lists those that there are. */
fp3_status fp3_integrator_find(const char *name, fp3_integrator **integrator, fp3_error *error);
/* Sets *integrator to NULL, which it may be already. */
void fp3_integrator_free(fp3_integrator **integrator);

/* Names of the built-in tables, by number; NULL beyond the last. */
const char *fp3_integrator_name(unsigned number);

/* The order up to which the order conditions hold (at most 8), whatever the table claims. worst is
 * the largest residual up to that order, next the largest of the next order. */
unsigned fp3_integrator_order(const fp3_integrator *integrator, double *worst, double *next);

FP3_API_END

#endif
