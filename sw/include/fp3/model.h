/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/model.h - a model: the equations of motion of an object, read from a .ode text.
 *
 *     fp3_model *model = NULL;
 *     char *report = NULL;
 *     if (fp3_model_read(text, size, "ship.ode", &model, &report, &error))
 *         fputs(report ? report : error.text, stderr);
 *     free(report);
 *     fp3_model_free(&model);
 *
 * docs/models.md describes the language. A model that the library returns has passed every check
 * described there and never changes (except by fp3_model_adapt). A model has only scalars: a vector
 * r of two components has become r_x and r_y, a vector of five r_1 to r_5.
 *
 * Threads: any number of threads may read a model or an integrator at the same time.
 */
#ifndef FP3_MODEL_H
#define FP3_MODEL_H

#include <fp3/image.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

FP3_API_BEGIN

#define FP3_NONE UINT32_MAX /* no expression, no quantity */

/* X(NAME, operands, allowed only in `exact`). Comparisons give 1 or 0; any number but 0 is true. */
#define FP3_EXPR_OPS(X)                                                                            \
    X(NUMBER, 0, 0)                                                                                \
    X(STATE, 0, 0)   /* index: of states */                                                        \
    X(PARAM, 0, 0)   /* index: of params */                                                        \
    X(TIME, 0, 0)    /* t, 0 at the start */                                                       \
    X(INITIAL, 0, 1) /* v(0): state index at the start */                                          \
    X(NEGATE, 1, 0)                                                                                \
    X(ADD, 2, 0)                                                                                   \
    X(SUB, 2, 0)                                                                                   \
    X(MUL, 2, 0)                                                                                   \
    X(DIV, 2, 0)                                                                                   \
    X(POWER, 2, 0) /* of a state: b is_known */                                                    \
    X(SQRT, 1, 0)                                                                                  \
    X(SIN, 1, 0)                                                                                   \
    X(COS, 1, 0)                                                                                   \
    X(MIN, 2, 0)                                                                                   \
    X(MAX, 2, 0)                                                                                   \
    X(ABS, 1, 0)                                                                                   \
    X(LESS, 2, 0)       /* a < b */                                                                \
    X(LESS_EQUAL, 2, 0) /* a <= b */                                                               \
    X(EQUAL, 2, 0)                                                                                 \
    X(AND, 2, 0)                                                                                   \
    X(OR, 2, 0)                                                                                    \
    X(NOT, 1, 0)                                                                                   \
    X(SELECT, 3, 0) /* a ? b : c */                                                                \
    X(EXP, 1, 0)                                                                                   \
    X(LOG, 1, 0)                                                                                   \
    X(TAN, 1, 0)                                                                                   \
    X(ATAN, 1, 0)                                                                                  \
    X(ASIN, 1, 0)                                                                                  \
    X(ACOS, 1, 0)                                                                                  \
    X(ATAN2, 2, 0)                                                                                 \
    X(SINH, 1, 0)                                                                                  \
    X(COSH, 1, 0)                                                                                  \
    X(TANH, 1, 0)                                                                                  \
    X(LOG2, 1, 0)                                                                                  \
    X(EXPM1, 1, 0)                                                                                 \
    X(LOG1P, 1, 0)                                                                                 \
    X(LOGISTIC, 1, 0)                                                                              \
    X(OTHER_STATE, 0, 0) /* of a neighbour; index: of states */                                    \
    X(OTHER_PARAM, 0, 0) /* likewise; index: of params */                                          \
    X(FIELD, 0, 0)       /* of the link to it; index: of fields */                                 \
    X(TOTAL, 2, 0)       /* b, and a for each neighbour added to it; index: of relations */        \
    X(LEAST, 2, 0)       /* the least of b and of a for each neighbour, likewise */                \
    X(MOST, 2, 0)        /* the most of these */                                                   \
    X(STEP, 0, 0)        /* h, the length of the step; of projections and `remember` */            \
    X(BEFORE, 0,                                                                                   \
      0) /* a state when the step began; index: of states; of projections and `remember` */        \
    X(OBJECTS, 1, 0) /* a of each object, added up; of group_invariants alone */                   \
    X(PAIRS, 1, 0)   /* a of each pair, once, likewise; index: of relations */

typedef enum {
#define X(NAME, operands, host) FP3_EXPR_##NAME,
    FP3_EXPR_OPS(X)
#undef X
        FP3_EXPR_OP_COUNT
} fp3_expr_op;

/* Whether a value is made of all neighbours of an object. */
static inline int fp3_expr_is_fold(fp3_expr_op op) {
    return op == FP3_EXPR_TOTAL || op == FP3_EXPR_LEAST || op == FP3_EXPR_MOST;
}

/* One operation. Its operands come earlier in fp3_model.exprs; unused operands are FP3_NONE. A long
 * sum is as deep as it is long (up to 4096), so walk the array instead of recursing into the
 * operands. */
typedef struct {
    fp3_expr_op op;
    uint32_t operand[3];
    uint32_t index;        /* of STATE, PARAM and INITIAL */
    double number;         /* of NUMBER */
    uint32_t line, column; /* its place in the text, from 1 */
    int is_known; /* depends only on params and numbers, which the host knows before a run */
} fp3_expr;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *dimension;     /* unit as written, without brackets and blanks, or "" */
    char *doc;           /* or "" */
    double value;        /* default of a param, start of a state */
    int is_shared;       /* param: the same for all objects */
    uint32_t derivative; /* state: expression of its derivative */
    uint32_t velocity;   /* state: the other state that is its derivative, or FP3_NONE */
    uint32_t exact;      /* state: its closed form in t, or FP3_NONE */
    uint32_t start;      /* state: expression of params that gives its start, or FP3_NONE */
    uint32_t line;
} fp3_quantity;

#define FP3_UNIT_SIZE 80

/* An intermediate definition, or an invariant, in the order of the text. */
typedef struct {
    char name[FP3_NAME_SIZE];
    char unit[FP3_UNIT_SIZE]; /* in base units, truncated if long; "": no unit */
    uint32_t expr;
    uint32_t line;
} fp3_definition;

/* Part of an event: sets a state to the value of an expression. */
typedef struct {
    uint32_t state, expr;
} fp3_assignment;

/* At the end of a step, if the condition is not 0, each state is set to the value that its
 * expression had before any state changed. Events are handled in the order of the text, and each
 * sees the results of earlier events. An event assigns no state twice. */
typedef struct {
    uint32_t condition;    /* expression; of a projection FP3_NONE */
    uint32_t first, count; /* its part of fp3_model.assignments */
    uint32_t line;
    /* The event happens only if this expression was not 0 at the beginning of the step; FP3_NONE:
     * whenever its condition is not 0. Of a root or a time, `condition` and `armed` compare the
     * same two numbers, the other way round. */
    uint32_t armed;
    /* FP3_STOPS: from then on the object keeps its states and its time. FP3_REMOVES: its life ends;
     * the event sets the state FP3_NAME_REMOVED (fp3/image.h) to 1. 0: neither. */
    int stops;
} fp3_event;
#define FP3_STOPS 1
#define FP3_REMOVES 2

/* These projections happen `times` times, one after the other. */
typedef struct {
    uint32_t first, count; /* of fp3_model.projections; at least one */
    uint32_t times;        /* 1 .. FP3_REPEAT_MAX */
    uint32_t line;
} fp3_repeat;
#define FP3_REPEAT_MAX 63

#define FP3_RELATIONS_MAX 8
#define FP3_KINDS_MAX 8

/* What the model reads of objects of another group. Each word is a param of the model, KIND_WORD,
 * which no object has for itself: it stands for the neighbour's value. */
typedef struct {
    char name[FP3_NAME_SIZE];
    uint32_t first, count; /* of fp3_model.params */
    uint32_t line;
} fp3_kind;

/* Which other objects an object sees. */
typedef enum {
    FP3_LINKS, /* linked objects */
    FP3_NEAR,  /* objects nearer than `reach` */
    FP3_ALL    /* all others */
} fp3_relation_kind;

typedef struct {
    char name[FP3_NAME_SIZE];
    fp3_relation_kind kind;
    uint32_t first_field, field_count; /* of fp3_model.fields */
    /* near: the first state of the position, its number of components, and the reach, an expression
     * of shared params. */
    uint32_t position, dimensions, reach;
    /* near: params that are added to the reach, one of the object and one of the neighbour; of the
     * own group both are the same. FP3_NONE: none. */
    uint32_t radius, their_radius;
    uint32_t line;
    uint32_t of_kind; /* index of fp3_model.kinds; FP3_NONE: it sees objects of its own group */
    uint32_t theirs;  /* near of another kind: the first param of their position */
} fp3_relation;

/* What each entry remembers: after each step, its projections and events, the field gets the value
 * of the expression, for each neighbour. All fields get their values at once. */
typedef struct {
    uint32_t relation, field; /* of fp3_model.fields */
    uint32_t expr, line;
} fp3_memory;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *doc;
    char time_unit[FP3_UNIT_SIZE]; /* of `step`, likewise */
    /* The default time step, and how long benchmarks integrate (default: 1000 steps). */
    double step, span;
    uint32_t state_count, param_count, definition_count, invariant_count, expr_count;
    uint32_t event_count, projection_count, assignment_count;
    fp3_quantity *states, *params;
    fp3_definition *definitions, *invariants;
    fp3_event *events;
    /* Projections have no condition: they happen after every step, before events. The truth solver
     * ignores projections. */
    fp3_event *projections;
    uint32_t repeat_count;
    fp3_repeat *repeats; /* in the order of the text; none overlaps another */
    fp3_assignment *assignments;
    fp3_expr *exprs;
    /* How objects see others; the fields of links have a value (default), a unit and no
     * equation. */
    uint32_t relation_count, field_count, memory_count;
    fp3_relation *relations;
    fp3_quantity *fields;
    fp3_memory *memories; /* each field once; all fields of near objects are among these */
    uint32_t kind_count;
    fp3_kind *kinds;
    /* Of all objects of the group together: made of OBJECTS and PAIRS, which have no value of one
     * object (fp3_model_evaluate: NaN). */
    uint32_t group_invariant_count;
    fp3_definition *group_invariants;
} fp3_model;

/* source has size bytes, needs no NUL and may hold any bytes. name appears in the report.
 * FP3_E_PROGRAM: the source has errors, and *model is NULL. *report then holds, for each error (at
 * most 20), "name:line:column: error: found 'x', expected y", the line and a caret; error holds its
 * first line. The caller frees *report, which is NULL after success and after any other failure. */
fp3_status fp3_model_read(const char *source, size_t size, const char *name, fp3_model **model,
                          char **report, fp3_error *error);
/* The same with a file. */
fp3_status fp3_model_load(const char *path, fp3_model **model, char **report, fp3_error *error);
/* A copy, which the caller frees. For fp3_model_adapt, which changes its model. */
fp3_status fp3_model_copy(const fp3_model *model, fp3_model **copy, fp3_error *error);
/* Frees *model and sets it to NULL. *model may be NULL already. */
void fp3_model_free(fp3_model **model);

/* The point at which expressions are evaluated, in double. */
typedef struct {
    const double *states, *params, *initial; /* as many as the model has; initial may be NULL */
    double t;
} fp3_point;
/* Sets values[i] to the value of expression i, for all expr_count expressions. If initial is NULL,
 * expressions that need the start are NaN. */
void fp3_model_evaluate(const fp3_model *model, const fp3_point *point, double *values);

/* Finds a state that stands still: in plain FP32 arithmetic a step of h is too small to change it.
 * Returns 1 for the first such state at this point that would change by more than `share` of its
 * size during `span`, if its derivative still has the same sign then (at an equilibrium nothing is
 * lost); text says what a step adds. Otherwise returns 0 and text "". room: 2 expr_count +
 * state_count numbers. */
#define FP3_STANDSTILL_TEXT_SIZE 192
int fp3_model_standstill(const fp3_model *model, const fp3_point *point, double h, double span,
                         double share, double *room, char text[FP3_STANDSTILL_TEXT_SIZE]);

/* Applies the events of the model, in order, to these states at time t. `before` is the point at
 * the beginning of the step; NULL: there was no step, and events with `armed` do not happen. values
 * has room for expr_count numbers. Returns whether a state has changed, where a change from 0 to -0
 * or from NaN to NaN does not count, and FP3_FIRE_STOPPED if an event stops the object. */
#define FP3_FIRE_CHANGED 1
#define FP3_FIRE_STOPPED 2
int fp3_model_fire(const fp3_model *model, const fp3_point *before, const double *params, double t,
                   double *states, double *values);

/* FP3_E_PROGRAM: objects of this model see each other, so an object cannot be computed alone: in
 * fp3_model_evaluate expressions of neighbours are NaN; or an event removes an object, which then
 * makes no steps. The message names the relation and its line, or that of the event. */
fp3_status fp3_model_check_alone(const fp3_model *model, fp3_error *error);

/* Whether projections alone move the states: steps have no length then
 * (docs/models.md#projections). */
static inline int fp3_model_is_map(const fp3_model *model) {
    int moves = !model->projection_count;
    for (uint32_t i = 0; i < model->state_count; i++) {
        const fp3_expr *rate = &model->exprs[model->states[i].derivative];
        moves |= rate->op != FP3_EXPR_NUMBER || rate->number != 0;
    }
    return !moves;
}

/* The line of the model's first event that removes an object, or 0. */
static inline uint32_t fp3_model_removes(const fp3_model *model) {
    for (uint32_t i = 0; i < model->event_count; i++)
        if (model->events[i].stops == FP3_REMOVES)
            return model->events[i].line;
    return 0;
}

/* The line of the model's first `remember`, or 0. */
static inline uint32_t fp3_model_remembers(const fp3_model *model) {
    return model->memory_count ? model->memories[0].line : 0;
}

/* Whether the param is a word of a kind, which stands for a neighbour's value: nobody gives it. */
static inline int fp3_model_is_foreign(const fp3_model *model, uint32_t param) {
    for (uint32_t i = 0; i < model->kind_count; i++)
        if (param - model->kinds[i].first < model->kinds[i].count)
            return 1;
    return 0;
}

/* The index of the state or param of this name, or FP3_NONE. */
uint32_t fp3_model_state(const fp3_model *model, const char *name);
uint32_t fp3_model_param(const fp3_model *model, const char *name);

/* Reads a constant expression like "1/6" or "1/(2 - 2^(1/3))": numbers, + - * / ^, parentheses and
 * the functions of the language. FP3_E_PROGRAM: error says what was found and expected, and in
 * which column; *value is unchanged. */
fp3_status fp3_constant_read(const char *text, double *value, fp3_error *error);

/* Gives the value of a name in a formula, or refuses the name. */
typedef fp3_status fp3_name_fn(void *user, const char *name, double *value, fp3_error *error);
/* A constant expression with names, such as "0.5*h". FP3_E_PROGRAM: as above; *formula is NULL. */
typedef struct fp3_formula fp3_formula;
fp3_status fp3_formula_read(const char *text, fp3_formula **formula, fp3_error *error);
/* The formula's value in double. FP3_E_PROGRAM: the formula has no value, as 0/0. Other errors come
 * from value_of. */
fp3_status fp3_formula_value(const fp3_formula *formula, fp3_name_fn *value_of, void *user,
                             double *value, fp3_error *error);
/* Frees *formula and sets it to NULL. *formula may be NULL already. */
void fp3_formula_free(fp3_formula **formula);

/* ---- integrators: tables, checked when they are read ----
 *
 *     fp3_integrator *rk4 = NULL;
 *     if (fp3_integrator_find("rk4", &rk4, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("%s: order %u\n", rk4->name, rk4->order);
 *     fp3_integrator_free(&rk4);
 *
 * docs/integrators.md describes the tables and lists the built-in ones.
 */

typedef enum {
    FP3_RUNGE_KUTTA, /* k_i = h f(y + sum_j a_ij k_j), y += sum_i b_i k_i; explicit */
    FP3_SPLITTING,   /* kicks v += coefficient * h * a(x, v), drifts x += coefficient * h * v */
    FP3_STOERMER,    /* x_n+1 = (2 x_n - x_n-1) + h^2 a(x_n), for accelerations without v */
    FP3_ROSENBROCK,  /* k_i = h f(y + sum_j a_ij k_j) + h J sum_j gamma_ij k_j, y += sum_i b_i k_i;
                        linearly implicit: J is the Jacobian of f at y */
    FP3_CHEBYSHEV    /* Runge-Kutta, explicit, whose stages follow a three-term recurrence */
} fp3_integrator_kind;

#define FP3_STAGES_MAX 24

typedef struct {
    int is_kick; /* 1: kick; 0: drift */
    double coefficient;
} fp3_substep;

/* With f_0 = f(y), E_1 = V_1 = first h f_0 and f_j = f(y + at[j] E_j), for j = 1 .. stages - 1:
 * V_j+1 = V_j + bend E_j + slope[j] h (f_j - share[j] f_0) and E_j+1 = E_j + V_j+1.
 * Then y += at[stages] E_stages. */
typedef struct {
    unsigned stages; /* 0: no recurrence */
    double first, bend;
    double at[FP3_STAGES_MAX], share[FP3_STAGES_MAX], slope[FP3_STAGES_MAX];
} fp3_recurrence;

/* The error of a Chebyshev step is estimated as FP3_CHEBYSHEV_WAY (h (f_0 + f_1)/2 - d), where f_1
 * is the slope at the new state and d the increment of the state: Sommeijer, Shampine and Verwer,
 * 1997. */
#define FP3_CHEBYSHEV_WAY 0.8

typedef struct {
    char name[FP3_NAME_SIZE];
    char *doc;
    char *source; /* of the table: author, year */
    fp3_integrator_kind kind;
    unsigned order;  /* its order conditions have been checked */
    unsigned stages; /* splitting: the number of substeps; Chebyshev: one more than those of its
                        recurrence, for the slope at the new state */
    /* Chebyshev: a, b, c are equivalent to the recurrence. */
    double a[FP3_STAGES_MAX][FP3_STAGES_MAX], b[FP3_STAGES_MAX], c[FP3_STAGES_MAX];
    double gamma[FP3_STAGES_MAX][FP3_STAGES_MAX]; /* Rosenbrock: all diagonal elements are equal */
    fp3_recurrence recurrence;
    /* Runge-Kutta: a state whose derivative is another state v is advanced by h times the new v, as
     * in the paper's Equations (1). It has no stages, and is of first order. */
    int is_position_late;
    unsigned position_order; /* order of such a state: 1 if late, else order */
    fp3_substep substeps[FP3_STAGES_MAX];
    /* Runge-Kutta, Chebyshev, Rosenbrock: weights of a second method with the same stages. Its
     * difference from the first is the error estimate that adaptive steps need. */
    double embedded[FP3_STAGES_MAX];
    unsigned embedded_order; /* 0: no second method */
    /* The last stage is at the new state, so it is also the first stage of the next step. */
    int is_first_same_as_last;
} fp3_integrator;

/* text is a table in libconfig's syntax; name appears in messages ("name:line: found ..., expected
 * ..."). FP3_E_PROGRAM: the table is malformed or not explicit; or a condition of the claimed order
 * fails (the message says which, and by how much); or the error estimate is 0 on y' = a y or
 * y' = f(t), whatever the step. */
fp3_status fp3_integrator_read(const char *text, const char *name, fp3_integrator **integrator,
                               fp3_error *error);
/* The built-in table of this name; or, if name contains a '/' or ends in ".cfg", the table in that
 * file. FP3_E_ARGUMENT: no such table; the message lists the built-in tables. */
fp3_status fp3_integrator_find(const char *name, fp3_integrator **integrator, fp3_error *error);
/* Frees *integrator and sets it to NULL. *integrator may be NULL already. */
void fp3_integrator_free(fp3_integrator **integrator);

/* The name of a built-in table, by number from 0; NULL beyond the last. */
const char *fp3_integrator_name(unsigned number);

/* The order up to which the order conditions hold (at most 8), whatever the table claims. *worst is
 * the largest residual up to that order, *next the largest residual of the next order. */
unsigned fp3_integrator_order(const fp3_integrator *integrator, double *worst, double *next);

FP3_API_END

#endif
