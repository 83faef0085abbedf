/* SPDX-License-Identifier: Apache-2.0 */
/* parser.h - one model while it is read. Each file below fills in its part and stands on those
 * above it.
 *
 *     cursor             the source, token by token, and errors
 *     vector             operations on numbers and vectors, which become scalar expressions
 *     function           the table of functions, which are made of those operations
 *     symbol             what names stand for
 *     meaning            what they stand for in an expression
 *     word               what a kind has, the words of objects of another group
 *     neighbour          what an expression says of neighbours
 *     range              names for whole numbers, and what is read again for each of them
 *     expression         from tokens to operations
 *     dimension_read     units of measurement in brackets
 *     dimension_check    whether the units of operands fit each other
 *     constant           values that are known before a run
 *     quantity           params and states
 *     kind               what a model reads of objects of another group
 *     relation           how objects see others
 *     event              `when`, what happens at the end of a step
 *     remember           `remember`, what entries of neighbours keep
 *     statement          what each statement says
 *     finish             what only the end of the source can tell
 *     read               the source from statement to statement, and the calls of fp3/model.h
 */
#ifndef FP3_ODE_PARSER_H
#define FP3_ODE_PARSER_H

#include <fp3/model.h>

#include "cursor.h"
#include "dimension.h"

enum {
    ODE_SOURCE_MAX = 1 << 20,
    ODE_QUANTITIES = 64, /* states, and as many params */
    ODE_EXPRS = 4096,
    ODE_DEFINITIONS = 1024, /* and as many invariants */
    ODE_INDICES = 8,        /* one within the other */
    ODE_SYMBOLS = 2 * ODE_QUANTITIES + 2 * ODE_DEFINITIONS + ODE_INDICES + FP3_RELATIONS_MAX +
                  FP3_KINDS_MAX + 1,
    ODE_REPEATED = 1 << 22, /* bytes of text that are read again for an index */
    ODE_EVENTS = 64,
    ODE_ASSIGNMENTS = 256,
    ODE_DEPTH = 200,
    ODE_VECTOR = ODE_QUANTITIES,
    ODE_LETTERS = 3 /* vectors up to this length have components .x, .y and .z */
};

typedef struct {
    unsigned size;             /* 1: a number, more: a vector, 0: wrong and reported, or skipped */
    uint16_t expr[ODE_VECTOR]; /* small, since values lie on the stack of a deep recursion */
} ode_value;

/* What an expression may be made of. */
typedef enum {
    ODE_IN_INDEX,     /* numbers, also those that are defined */
    ODE_IN_CONSTANT,  /* numbers */
    ODE_IN_START,     /* numbers and params */
    ODE_IN_EQUATION,  /* what the hardware can compute from states and t, and anything of params */
    ODE_IN_EXACT,     /* numbers, params, t and v(0) */
    ODE_IN_INVARIANT, /* numbers, params, states and t */
} ode_context;

/* An index stands for a whole number while the text of its range is read. */
typedef enum {
    ODE_STATE,
    ODE_PARAM,
    ODE_DEFINITION,
    ODE_INVARIANT,
    ODE_INDEX,
    ODE_RELATION,
    ODE_KIND,
    ODE_WORD,     /* of a kind, by the name of its param */
    ODE_NEIGHBOUR /* while the term of a sum over a relation is read */
} ode_class;

typedef struct {
    fp3_token at;
    ode_class class;
    uint32_t first;  /* of a state or param: its first component; of a relation, a neighbour: which
                        relation; of a kind: which kind */
    ode_value value; /* of a definition or invariant; of any other only the size */
    long number;     /* of an index: what it stands for now */
} ode_symbol;

typedef struct {
    fp3_token at;  /* if the equation exists */
    uint32_t expr; /* FP3_NONE: its right side is wrong, and reported */
    char note[FP3_NOTE_SIZE];
} ode_equation;

typedef struct {
    fp3_quantity quantity;
    fp3_token at;
    ode_dimension dimension;
    ode_equation first, second, exact; /* of a state: its derivatives, its closed form */
    unsigned size; /* of a field or a word of a kind: of the vector that it begins; else 0 */
} ode_quantity;

typedef struct {
    double value;
    ode_dimension dimension;
    fp3_token at; /* if the source says it */
} ode_time;

typedef struct {
    uint32_t condition, first, count, armed; /* as of fp3_event */
    int stops;                               /* likewise */
    fp3_token at;
} ode_event;

typedef struct {
    uint32_t state;
    ode_equation to;
} ode_assignment;

typedef struct {
    uint32_t relation, field;
    ode_equation to;
} ode_memory;

typedef struct {
    ode_cursor in;
    ode_context context; /* of the expression that is read */
    unsigned depth;      /* of that expression */
    /* In how many choices that are not taken: what is read there must be written well, but nothing
     * is made of it, and no index is out of range. */
    unsigned skipping;
    int is_in_projection;
    unsigned index_count; /* of the ranges around */
    int takes_names;      /* in a formula: a name that is not defined is a param */
    size_t repeated;
    int out_of_memory;

    fp3_token model_at; /* if the source names the model */
    char model_name[FP3_NAME_SIZE];
    char *model_doc;
    uint32_t removed; /* the state FP3_NAME_REMOVED, if it is there */
    int has_removed;
    ode_time step, span, rest;
    char time_unit[FP3_UNIT_SIZE];
    ode_dimension_names dimension_names;
    ode_quantity states[ODE_QUANTITIES], params[ODE_QUANTITIES];
    uint32_t state_count, param_count;

    ode_event events[ODE_EVENTS], projections[ODE_EVENTS];
    fp3_repeat repeats[ODE_EVENTS]; /* line: of those that have ended */
    uint32_t repeat_count;
    fp3_token repeat_at; /* the `repeat` without its `end` so far, if there is one */
    ode_assignment assignments[ODE_ASSIGNMENTS];
    uint32_t event_count, projection_count, assignment_count;

    fp3_kind kinds[FP3_KINDS_MAX];
    char word_names[ODE_QUANTITIES][FP3_NAME_SIZE]; /* of params: KIND_WORD */
    uint32_t kind_count;
    fp3_relation relations[FP3_RELATIONS_MAX];
    ode_quantity fields[ODE_QUANTITIES]; /* of links, and what near objects remember */
    ode_memory memories[ODE_QUANTITIES];
    uint32_t relation_count, field_count, memory_count;
    int is_in_sum;      /* over neighbours */
    int is_in_remember; /* of a `remember`: the right side */

    fp3_token undefined[FP3_REPORT_LIMIT]; /* each is reported once */
    unsigned undefined_count;

    uint32_t definition_count, invariant_count, group_invariant_count, symbol_count, expr_count;
    /* From here on fp3_ode_make clears nothing: an entry is written as a whole when it is counted.
     */
    fp3_definition definitions[ODE_DEFINITIONS], invariants[ODE_DEFINITIONS];
    fp3_definition group_invariants[ODE_DEFINITIONS]; /* from the end of the source on */
    ode_symbol symbols[ODE_SYMBOLS];
    fp3_expr exprs[ODE_EXPRS];
    /* Of each expression: where it is written, for which indices, its dimension once checked,
     * whether it depends on a state, and on t; whether it is made of numbers alone, which have
     * values at once. */
    fp3_token expr_at[ODE_EXPRS];
    char expr_note[ODE_EXPRS][FP3_NOTE_SIZE];
    ode_dimension dimensions[ODE_EXPRS];
    char has_state[ODE_EXPRS], has_time[ODE_EXPRS], is_number[ODE_EXPRS];
    double values[ODE_EXPRS]; /* of numbers; of all, while a constant is read */
    char is_lost[ODE_EXPRS];  /* of values: language/loss.h */
} ode_parser;

/* In front of a source, for free(). NULL: no memory. */
ode_parser *fp3_ode_make(void);

#endif
