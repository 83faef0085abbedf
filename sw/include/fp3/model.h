/* fp3/model.h - a model: the equations of motion of one kind of object, read from a .ode text.
 *
 *     fp3_model *model = NULL;
 *     char *report = NULL;
 *     if (fp3_model_read(text, size, "ship.ode", &model, &report, &error))
 *         fputs(report ? report : error.text, stderr);
 *     ...
 *     free(report);
 *     fp3_model_free(&model);
 *
 * docs/models.md describes the language. A model that the library hands out has passed every check
 * there and is never changed again. Vectors are scalars by now: a state r of two is r_x and r_y.
 */
#ifndef FP3_MODEL_H
#define FP3_MODEL_H

#include <fp3/image.h>
#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

#define FP3_NONE UINT32_MAX /* no expression, no quantity */

/* X(NAME, operands, is for the host only): a host-only operation may stand where no state is
 * involved, or in `exact` and `invariant`. Truth values are 1 and 0; any other number than 0 is
 * true. */
#define FP3_EXPR_OPS(X)                                                                            \
    X(NUMBER, 0, 0)                                                                                \
    X(STATE, 0, 0)   /* index: of states */                                                        \
    X(PARAM, 0, 0)   /* index: of params */                                                        \
    X(TIME, 0, 1)    /* t, 0 at the start */                                                       \
    X(INITIAL, 0, 1) /* v(0): state index at the start */                                          \
    X(NEGATE, 1, 0)                                                                                \
    X(ADD, 2, 0)                                                                                   \
    X(SUB, 2, 0)                                                                                   \
    X(MUL, 2, 0)                                                                                   \
    X(DIV, 2, 0)                                                                                   \
    X(POWER, 2, 0) /* of a state: b is a NUMBER, an integer from -8 to 8 */                        \
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
    X(EXP, 1, 1)                                                                                   \
    X(LOG, 1, 1)                                                                                   \
    X(TAN, 1, 1)                                                                                   \
    X(ASIN, 1, 1)                                                                                  \
    X(ACOS, 1, 1)                                                                                  \
    X(ATAN2, 2, 1)                                                                                 \
    X(SINH, 1, 1)                                                                                  \
    X(COSH, 1, 1)                                                                                  \
    X(TANH, 1, 1)

typedef enum {
#define X(NAME, operands, host) FP3_EXPR_##NAME,
    FP3_EXPR_OPS(X)
#undef X
        FP3_EXPR_OP_COUNT
} fp3_expr_op;

/* One operation. Operands stand before the operation in fp3_model.exprs; those that it does not
 * have are FP3_NONE. A long sum is as deep as it is long (4096 at most): better to go through the
 * array than down the operands. */
typedef struct {
    fp3_expr_op op;
    uint32_t operand[3];
    uint32_t index;        /* of STATE, PARAM and INITIAL */
    double number;         /* of NUMBER */
    uint32_t line, column; /* where it is written, from 1 */
    int is_known;          /* made of params and numbers alone: the host knows it before a run */
} fp3_expr;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *unit;          /* as written, without brackets and blanks; "" without one */
    char *doc;           /* "" without one */
    double value;        /* default of a param, start of a state */
    int is_shared;       /* param: the same for all objects */
    uint32_t derivative; /* state: expression of its derivative */
    uint32_t velocity;   /* state: the other state that alone is its derivative, or FP3_NONE */
    uint32_t exact;      /* state: closed form of t, or FP3_NONE */
    uint32_t line;
} fp3_quantity;

/* An intermediate definition, or an invariant, in the order of the text. */
typedef struct {
    char name[FP3_NAME_SIZE];
    uint32_t expr;
    uint32_t line;
} fp3_definition;

typedef struct {
    char name[FP3_NAME_SIZE];
    char *doc;
    double step, span; /* the default time step, and the time that benchmarks integrate (1000 steps
                          where the text has none) */
    uint32_t state_count, param_count, definition_count, invariant_count, expr_count;
    fp3_quantity *states, *params;
    fp3_definition *definitions, *invariants;
    fp3_expr *exprs;
} fp3_model;

/* source is size bytes, needs no NUL and may be anything at all; name is for the report.
 * FP3_E_PROGRAM: the source is wrong, *model is NULL, *report holds "name:line:column: error: found
 * 'x', expected y", the line and a caret, of each error (20 at most), and error the first line of
 * it. The caller frees *report, which is NULL after success and after any other failure. */
fp3_status fp3_model_read(const char *source, size_t size, const char *name, fp3_model **model,
                          char **report, fp3_error *error);
/* The same with a file. */
fp3_status fp3_model_load(const char *path, fp3_model **model, char **report, fp3_error *error);
/* Sets *model to NULL; that it was NULL before does no harm. */
void fp3_model_free(fp3_model **model);

/* What an expression is evaluated at, in double. */
typedef struct {
    const double *states, *params, *initial; /* as many as the model has; initial may be NULL, */
    double t;                                /* if nothing asks for it */
} fp3_point;
/* values[i] of expression i for all expressions 0 .. expr_count-1. Those that need initial are NaN
 * where it is NULL. */
void fp3_model_evaluate(const fp3_model *model, const fp3_point *point, double *values);

/* Index by name, or FP3_NONE. */
uint32_t fp3_model_state(const fp3_model *model, const char *name);
uint32_t fp3_model_param(const fp3_model *model, const char *name);

/* A constant expression like "1/6" or "1/(2 - 2^(1/3))": numbers, + - * / ^, parentheses and the
 * functions of the language. FP3_E_PROGRAM: error says what was found and expected, and where (the
 * column); *value is as before. */
fp3_status fp3_constant_read(const char *text, double *value, fp3_error *error);

#endif
