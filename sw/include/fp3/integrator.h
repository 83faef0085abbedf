/* fp3/integrator.h - integrators as tables, checked when they are read.
 *
 *     fp3_integrator *rk4 = NULL;
 *     if (fp3_integrator_find("rk4", &rk4, &error)) ...
 *     printf("%s: order %u\n", rk4->name, rk4->order);
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
    FP3_ROSENBROCK   /* k_i = h f(y + sum_j a_ij k_j) + h J sum_j gamma_ij k_j, y += sum_i b_i k_i;
                        linearly implicit: J is the Jacobian of f at y */
} fp3_integrator_kind;

#define FP3_STAGES_MAX 16

typedef struct {
    int is_kick; /* else a drift */
    double coefficient;
} fp3_substep;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *doc;
    char *source; /* of the table: author, year */
    fp3_integrator_kind kind;
    unsigned order;  /* checked: its conditions hold */
    unsigned stages; /* of Runge-Kutta; of a splitting, its substeps */
    double a[FP3_STAGES_MAX][FP3_STAGES_MAX], b[FP3_STAGES_MAX], c[FP3_STAGES_MAX];
    double gamma[FP3_STAGES_MAX][FP3_STAGES_MAX]; /* Rosenbrock: one number on the diagonal */
    /* Runge-Kutta: a state whose derivative is another state v is advanced by h times the new v,
     * as in the paper's Equations (1), and has no stages: first order in that state. */
    int is_position_late;
    unsigned position_order; /* order of such a state: 1 if late, else order */
    fp3_substep substeps[FP3_STAGES_MAX];
    /* Runge-Kutta: weights of a second method on the same stages, whose distance from the first is the
     * estimate of the error that adaptive steps need. */
    double embedded[FP3_STAGES_MAX];
    unsigned embedded_order; /* 0: there is none */
    /* The last stage is at the new state, so it is the first one of the next step. */
    int is_first_same_as_last;
} fp3_integrator;

/* text is a table in libconfig's syntax; name is for messages ("name:line: found ..., expected ...").
 * FP3_E_PROGRAM: the table is malformed or not explicit, or its order conditions do not hold for the
 * order that it claims (the message says which one fails, and by how much). */
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
