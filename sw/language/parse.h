/* parse.h - one model while it is read.
 *
 *     parse_model.c       the file, from statement to statement
 *     parse_statement.c   what each statement says
 *     parse_constant.c    values and units
 *     parse_name.c        names
 *     parse_expression.c  expressions
 *     parse_call.c        functions
 *     vector.c            operations on numbers and vectors, which become scalar ones
 *     units_check.c       units of all expressions
 *     read.c              the calls of fp3/model.h around all that
 */
#ifndef FP3_ODE_PARSE_H
#define FP3_ODE_PARSE_H

#include <fp3/model.h>

#include "lex.h"
#include "text/report.h"
#include "units.h"

enum {
    ODE_SOURCE_MAX = 1 << 20,
    ODE_QUANTITIES = 64, /* states, and as many params */
    ODE_EXPRS = 4096,
    ODE_DEFINITIONS = 1024, /* and as many invariants */
    ODE_SYMBOLS = 2 * ODE_QUANTITIES + 2 * ODE_DEFINITIONS,
    ODE_DEPTH = 200,
    ODE_VECTOR = 3
};

typedef struct {
    unsigned size; /* 1: a number, 2 or 3: a vector, 0: wrong, and reported */
    uint32_t expr[ODE_VECTOR];
} ode_value;

/* What an expression may be made of. */
typedef enum {
    ODE_IN_CONSTANT,  /* numbers */
    ODE_IN_START,     /* numbers and params */
    ODE_IN_EQUATION,  /* what the hardware can compute, from states, and whatever params need */
    ODE_IN_EXACT,     /* numbers, params, t and v(0) */
    ODE_IN_INVARIANT, /* numbers, params and states */
} ode_context;

typedef enum { ODE_STATE, ODE_PARAM, ODE_DEFINITION, ODE_INVARIANT } ode_kind;

typedef struct {
    token at;
    ode_kind kind;
    uint32_t first;  /* state or param */
    ode_value value; /* of a definition; of the others the size alone */
} ode_symbol;

typedef struct {
    token at; /* line 0: there is none */
    uint32_t expr;
} ode_equation;

typedef struct {
    fp3_quantity quantity;
    token at;
    ode_unit unit;
    ode_equation first, second, exact; /* of a state: its derivatives, its closed form */
} ode_quantity;

typedef struct {
    double value;
    ode_unit unit;
    token at; /* line 0: it is not said */
} ode_time;

typedef struct {
    ode_lexer lexer;
    token next;
    report report;
    int is_lost;   /* since a syntax error: up to where reading starts again, nothing is reported */
    token lost_at; /* that error */
    int is_over;   /* a limit is reached: nothing more is read */
    int out_of_memory;
    unsigned depth;
    ode_context context;

    token model_at; /* line 0: the model has no name of its own */
    char model_name[FP3_NAME_SIZE];
    char *model_doc;
    ode_time step, span;
    ode_unit_names unit_names;
    ode_quantity states[ODE_QUANTITIES], params[ODE_QUANTITIES];
    fp3_definition definitions[ODE_DEFINITIONS], invariants[ODE_DEFINITIONS];
    ode_symbol symbols[ODE_SYMBOLS];
    uint32_t state_count, param_count, definition_count, invariant_count, symbol_count;
    token undefined[REPORT_LIMIT]; /* each is reported once */
    unsigned undefined_count;

    uint32_t expr_count;
    fp3_expr exprs[ODE_EXPRS];
    /* Of each expression: where it is written, its unit once checked, whether a state is in it. */
    token expr_at[ODE_EXPRS];
    ode_unit units[ODE_EXPRS];
    char has_state[ODE_EXPRS];
    double values[ODE_EXPRS]; /* of the constant expression being read */
} ode_parser;

/* parse_model.c: all of a source; then what only shows at its end. */
void fp3_ode_parse(ode_parser *p);
void fp3_ode_advance(ode_parser *p);
int fp3_ode_at(const ode_parser *p, const char *symbol_or_word);
/* Steps over it if it is next. */
int fp3_ode_accept(ode_parser *p, const char *symbol_or_word);
/* A syntax error at the next token: nothing more of this statement is read. */
__attribute__((format(printf, 2, 3))) void fp3_ode_lost(ode_parser *p, const char *format, ...);
/* Nothing more of this statement is read: there is an error at this token, which is reported. */
void fp3_ode_give_up(ode_parser *p, token at);
/* Where a limit is reached: nothing more of the source is read. */
__attribute__((format(printf, 3, 4))) void fp3_ode_over(ode_parser *p, token at, const char *format,
                                                        ...);
/* Any other error: reading goes on. */
#define fp3_ode_wrong(p, at, ...)                                                                  \
    ((p)->is_lost ? (void)0 : fp3_report_expected(&(p)->report, at, __VA_ARGS__))
/* The first token of a source. */
void fp3_ode_start(ode_parser *p, const char *source, size_t size, const char *name);
void fp3_ode_expect_end(ode_parser *p);

/* parse_statement.c. */
void fp3_ode_statement(ode_parser *p);

/* parse_name.c: a name may stand for itself (a keyword), or for what the model declares. It may
 * carry a component, r.x; base is the name alone, *component 0 to 2, or -1. */
token fp3_ode_base(token name, int *component);
int fp3_ode_is_keyword(token name);
int fp3_ode_begins_statement(token name); /* a keyword that does */
/* Keeps in *best the keyword at a statement's beginning that name is most likely a slip of. */
void fp3_ode_nearest_statement(token name, const char **best);
ode_symbol *fp3_ode_find(ode_parser *p, token base);
/* Whether the token can be a new name, of a vector of so many; reports if not. */
int fp3_ode_is_new_name(ode_parser *p, token name, unsigned size);
/* "r" or "r_x". */
void fp3_ode_scalar_name(token base, unsigned size, unsigned i, char name[FP3_NAME_SIZE]);
/* What a name, or a component of it, stands for: *start is its first component. NULL after a
 * report. */
ode_symbol *fp3_ode_resolve(ode_parser *p, token name, unsigned *start, unsigned *size);

/* parse_constant.c: a value and its unit. */
enum { ODE_UNIT_SIZE = 64 };
typedef struct {
    double value[ODE_VECTOR];
    ode_unit unit;
    char unit_text[ODE_UNIT_SIZE];
} ode_constant;
typedef enum { ODE_WITHOUT_UNIT, ODE_WITH_UNIT } ode_unit_place;
/* 0 after a report. */
int fp3_ode_constant(ode_parser *p, ode_context context, unsigned size, ode_unit_place place,
                     ode_constant *constant);

/* parse_expression.c. */
ode_value fp3_ode_expression(ode_parser *p, ode_context context);
/* One within another. */
ode_value fp3_ode_subexpression(ode_parser *p);

/* parse_call.c: what follows the name of a function, which has been read. */
int fp3_ode_is_function(token name);
ode_value fp3_ode_call(ode_parser *p, token name);
/* Reports that the name should be one of a function. */
void fp3_ode_no_function(ode_parser *p, token name);

/* vector.c: the operation at that token; a value of size 0 after a report, or if an operand is
 * one. */
ode_value fp3_ode_leaf(ode_parser *p, token at, fp3_expr_op op, uint32_t index, double number);
ode_value fp3_ode_unary(ode_parser *p, token at, fp3_expr_op op, ode_value a);
ode_value fp3_ode_binary(ode_parser *p, token at, fp3_expr_op op, ode_value a, ode_value b);
ode_value fp3_ode_select(ode_parser *p, token at, ode_value c, ode_value a, ode_value b);
ode_value fp3_ode_dot(ode_parser *p, token at, ode_value a, ode_value b);
ode_value fp3_ode_cross(ode_parser *p, token at, ode_value a, ode_value b);
/* "a number", "a vector of 2". */
const char *fp3_ode_shape(unsigned size);

/* units_check.c: gives units to expressions from .. expr_count-1 and reports those that do not
 * fit. */
void fp3_ode_check_units(ode_parser *p, uint32_t from);
/* Of equations, once the time's unit is known. */
void fp3_ode_check_equations(ode_parser *p);

/* evaluate.c. */
double fp3_ode_compute(const fp3_expr *expr, const fp3_point *point, const double *values);
unsigned fp3_ode_operands(fp3_expr_op op);
int fp3_ode_is_host_only(fp3_expr_op op);

#endif
