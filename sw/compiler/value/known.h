/* SPDX-License-Identifier: Apache-2.0 */
/* known.h - what the host knows before a run: numbers, h, params, and values computed from them.
 *
 * Computed in double and rounded to FP32 once, when written to a register.
 */
#ifndef FP3_KNOWN_H
#define FP3_KNOWN_H

#include <fp3/model.h>

typedef enum {
    KNOWN_NUMBER,
    KNOWN_MODEL, /* an expression of the model that is_known */
    KNOWN_STEP,  /* h */
    KNOWN_NEGATE,
    KNOWN_ADD,
    KNOWN_SUB,
    KNOWN_MUL,
    KNOWN_DIV,
    KNOWN_EXPONENT, /* a as an exponent: 0, or with its sign and clamped to 2^-52 .. 2^40, which
                       changes no power in FP32 */
    KNOWN_SIGN,     /* (-1)^a: 1 or -1; 0 if a is no integer */
    KNOWN_LOW,      /* what rounding to FP32 takes off a, rounded: the second word of a pair */
    KNOWN_HEAD,     /* the upper 12 bits of a as FP32 has it, rounded to nearest ... */
    KNOWN_TAIL      /* ... and the rest of it */
} known_op;

typedef struct {
    known_op op;
    uint32_t a, b; /* operands; of KNOWN_MODEL a is the expression */
    double number;
    double exact;  /* of a KNOWN_NUMBER: what it is where nothing is rounded */
    int is_shared; /* the same for all objects */
} known;

typedef struct {
    const fp3_model *model;
    unsigned words;    /* of which the program makes a param or h: 2 in double-single */
    char *is_shared;   /* of each expression of the model */
    char *is_constant; /* likewise: no param is in it at all */
    uint32_t *same;    /* of each known expression, the first that is written alike */
    known *list;
    uint32_t count, room;
    int has_failed; /* out of memory: what was asked for since is number 0 of the list */
} known_table;

/* The table holds the number 0 at first; has_failed when there was no memory even for that. */
void fp3_known_open(known_table *table, const fp3_model *model, unsigned words);
void fp3_known_close(known_table *table);

/* Each value once. */
uint32_t fp3_known_number(known_table *table, double number);
/* The number is what rounding made of `exact`: see fp3_known_evaluate. */
void fp3_known_stands_for(known_table *table, double number, double exact);
uint32_t fp3_known_step(known_table *table);
uint32_t fp3_known_model(known_table *table, uint32_t expr);
/* An expression that is a param of which neighbours read all words. */
void fp3_known_seen(known_table *table, uint32_t expr);
/* A param of the model that an expression reads. */
uint32_t fp3_known_param(known_table *table, const char *name);
uint32_t fp3_known_make(known_table *table, known_op op, uint32_t a, uint32_t b);

/* Whether no param is in an expression of the model that is_known; then its value. */
int fp3_known_constant(known_table *table, uint32_t expr, double *value);

/* The params that it depends on, a bit each, from bit 0; *has_h: h, too. */
uint64_t fp3_known_params(const known_table *table, uint32_t id, int *has_h);

/* The line of the model that has the value, or its first part; 0: no line has a part of it. */
uint32_t fp3_known_line(const known_table *table, uint32_t id);

/* Whether it is this number. */
int fp3_known_is(const known_table *table, uint32_t id, double number);

/* The second word of a value in double-single: both words together have 48 bits of the value, as
 * far as these are multiples of 2^-149. */
double fp3_known_low(double value);

/* Some values of a table, for block after block of objects without a call for memory. */
typedef struct {
    const known_table *table;
    uint32_t *ids, count;        /* the values, operands first */
    uint32_t *exprs, expr_count; /* the expressions of the model in them, likewise */
    double *expr_values;         /* columns */
    double *param_row, *row;     /* of one object; of its values */
    char *is_expr_lost, *is_lost;
} fp3_known_subset;

/* is_wanted: of each value of the table; NULL: all. most: objects at once. The caller closes, after
 * a failure too. */
fp3_status fp3_known_choose(const known_table *table, const char *is_wanted, size_t most,
                            fp3_known_subset *subset, fp3_error *error);
void fp3_known_release(fp3_known_subset *subset);

/* Params and values are columns of count objects: values[i * count + n] of number i, if it was
 * chosen, and object n. A value below 2.2e-308, which double cannot represent, is NAN. h is a time
 * step. */
void fp3_known_values(const fp3_known_subset *subset, const double *params, double h, size_t count,
                      double *values);

/* All values, once; is_exact: of the exact numbers behind rounded ones. FP3_E_ARGUMENT: h is no
 * time step. */
fp3_status fp3_known_evaluate(const known_table *table, const double *params, double h,
                              int is_exact, double *values, fp3_error *error);

#endif
