/* SPDX-License-Identifier: Apache-2.0 */
/* formula.c - infix notation, with as few parentheses as the rounding allows. */
#include "formula.h"

#include "language/function_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Binding strength of what is written around an operand. */
enum { LOOSE, EITHER, BOTH, COMPARED, SUM, PRODUCT, UNARY, RAISED };

#define DEPTH_LIMIT 24 /* of what is written out; a chain of additions may be thousands deep */
#define TEXT_LIMIT 72  /* bytes, about: a comment stays on its line */
#define RULE_DEPTH 150 /* fp3_formula_read has a limit, too */
#define RULE_LIMIT 4000

typedef struct {
    const fp3_model *model;
    uint32_t root; /* its own name does not stand for it */
    FILE *out;
    unsigned depth;
    int is_rule;   /* for fp3_formula_read, and not for a reader */
    int is_beyond; /* a limit of rules */
} printer;

static const struct {
    const char *text;
    int level;
} infix[FP3_EXPR_OP_COUNT] = {
    [FP3_EXPR_ADD] = {" + ", SUM},
    [FP3_EXPR_SUB] = {" - ", SUM},
    [FP3_EXPR_MUL] = {"*", PRODUCT},
    [FP3_EXPR_DIV] = {"/", PRODUCT},
    [FP3_EXPR_POWER] = {"^", RAISED},
    [FP3_EXPR_LESS] = {" < ", COMPARED},
    [FP3_EXPR_LESS_EQUAL] = {" <= ", COMPARED},
    [FP3_EXPR_EQUAL] = {" == ", COMPARED},
    [FP3_EXPR_AND] = {" and ", BOTH},
    [FP3_EXPR_OR] = {" or ", EITHER},
};

static const char *const functions[FP3_EXPR_OP_COUNT] = {
#define X(OP, name, ...) [FP3_EXPR_##OP] = #name,
    FP3_FUNCTION_ROWS(X)
#undef X
        [FP3_EXPR_NOT] = "not",
};

static const char *definition_of(printer *p, uint32_t expr) {
    for (uint32_t i = 0; !p->is_rule && expr != p->root && i < p->model->definition_count; i++)
        if (p->model->definitions[i].expr == expr)
            return p->model->definitions[i].name;
    return NULL;
}

static int is_long(const printer *p) {
    return p->is_beyond || ftell(p->out) > (p->is_rule ? RULE_LIMIT : TEXT_LIMIT);
}

/* Nothing more, once it is long. */
static void put(printer *p, const char *text) {
    if (!is_long(p))
        fputs(text, p->out);
}

static void put_number(printer *p, double number, int around) {
    char text[32];
    snprintf(text, sizeof text, signbit(number) && around > SUM ? "(%.*g)" : "%.*g",
             p->is_rule ? 17 : 9, number);
    put(p, text);
}

static void print(printer *p, uint32_t expr, int around);

static void print_call(printer *p, const fp3_expr *e) {
    put(p, functions[e->op]);
    for (int i = 0; i < 3 && e->operand[i] != FP3_NONE; i++) {
        put(p, i ? ", " : "(");
        print(p, e->operand[i], LOOSE);
    }
    put(p, ")");
}

/* As it is rounded: a + (b + c) is not a + b + c. */
static void print_infix(printer *p, const fp3_expr *e, int around) {
    const int level = infix[e->op].level;
    const int is_chain = level != COMPARED && level != RAISED; /* a op b op c is (a op b) op c */
    put(p, level < around ? "(" : "");
    print(p, e->operand[0], is_chain ? level : level + 1);
    put(p, infix[e->op].text);
    print(p, e->operand[1], level == RAISED ? level : level + 1);
    put(p, level < around ? ")" : "");
}

/* A word of another kind, as the model writes it, without the name of the kind. */
static const char *word_of(const fp3_model *m, uint32_t param) {
    const char *name = m->params[param].name;
    for (uint32_t i = 0; i < m->kind_count; i++)
        if (param - m->kinds[i].first < m->kinds[i].count)
            return name + strlen(m->kinds[i].name) + 1;
    return name;
}

/* What belongs to a neighbour; what is made of all neighbours, without their name. */
static void print_neighbours(printer *p, const fp3_expr *e) {
    const fp3_model *m = p->model;
    if (fp3_expr_is_fold(e->op)) {
        put(p, e->op == FP3_EXPR_TOTAL ? "sum(" : e->op == FP3_EXPR_LEAST ? "min(" : "max(");
        put(p, m->relations[e->index].name);
        put(p, ": ");
        print(p, e->operand[0], LOOSE);
        if (e->op != FP3_EXPR_TOTAL) {
            put(p, ", ");
            print(p, e->operand[1], LOOSE);
        }
        put(p, ")");
        return;
    }
    put(p, "other.");
    put(p, e->op == FP3_EXPR_OTHER_STATE   ? m->states[e->index].name
           : e->op == FP3_EXPR_OTHER_PARAM ? word_of(m, e->index)
                                           : m->fields[e->index].name);
}

static int is_of_neighbours(fp3_expr_op op) {
    return fp3_expr_is_fold(op) || op == FP3_EXPR_OTHER_STATE || op == FP3_EXPR_OTHER_PARAM ||
           op == FP3_EXPR_FIELD;
}

static void print(printer *p, uint32_t expr, int around) {
    const fp3_expr *e = &p->model->exprs[expr];
    if (is_long(p))
        return;
    if (p->depth == (p->is_rule ? RULE_DEPTH : DEPTH_LIMIT)) {
        p->is_beyond = p->is_rule;
        put(p, "..");
        return;
    }
    p->depth++;
    const char *name = definition_of(p, expr);
    if (name)
        put(p, name);
    else if (e->op == FP3_EXPR_NUMBER)
        put_number(p, e->number, around);
    else if (e->op == FP3_EXPR_STATE)
        put(p, p->model->states[e->index].name);
    else if (e->op == FP3_EXPR_TIME)
        put(p, "t");
    else if (e->op == FP3_EXPR_STEP)
        put(p, FP3_NAME_STEP);
    else if (e->op == FP3_EXPR_BEFORE) {
        put(p, "prev(");
        put(p, p->model->states[e->index].name);
        put(p, ")");
    } else if (e->op == FP3_EXPR_PARAM)
        put(p, p->model->params[e->index].name);
    else if (is_of_neighbours(e->op))
        print_neighbours(p, e);
    else if (e->op == FP3_EXPR_NEGATE) {
        put(p, around > SUM ? "(-" : "-");
        print(p, e->operand[0], UNARY);
        put(p, around > SUM ? ")" : "");
    } else if (infix[e->op].text)
        print_infix(p, e, around);
    else
        print_call(p, e);
    p->depth--;
}

static void print_known(const known_table *table, printer *p, uint32_t id, int around) {
    static const char *const sign[] = {
        [KNOWN_ADD] = " + ", [KNOWN_SUB] = " - ", [KNOWN_MUL] = "*", [KNOWN_DIV] = "/"};
    const known *k = &table->list[id];
    const int level = k->op == KNOWN_ADD || k->op == KNOWN_SUB ? SUM : PRODUCT;
    if (is_long(p))
        return;
    /* Functions of one value are no formulas of the model's language: (-1)^a is 0 if a is no
     * integer. */
    if (p->depth == RULE_DEPTH || (p->is_rule && k->op >= KNOWN_EXPONENT)) {
        p->is_beyond = 1;
        return;
    }
    p->depth++;
    if (k->op == KNOWN_NUMBER)
        put_number(p, k->number, around);
    else if (k->op == KNOWN_STEP)
        put(p, "h");
    else if (k->op == KNOWN_MODEL)
        print(p, k->a, around);
    else if (k->op == KNOWN_NEGATE) {
        put(p, around > SUM ? "(-" : "-");
        print_known(table, p, k->a, UNARY);
        put(p, around > SUM ? ")" : "");
    } else if (k->op == KNOWN_EXPONENT)
        print_known(table, p, k->a, around);
    else if (k->op == KNOWN_SIGN) {
        put(p, "(-1)^");
        print_known(table, p, k->a, RAISED);
    } else if (k->op >= KNOWN_LOW) {
        put(p, k->op == KNOWN_LOW ? "low(" : k->op == KNOWN_HEAD ? "head(" : "tail(");
        print_known(table, p, k->a, LOOSE);
        put(p, ")");
    } else {
        put(p, level < around ? "(" : "");
        print_known(table, p, k->a, level);
        put(p, sign[k->op]);
        print_known(table, p, k->b, level + 1);
        put(p, level < around ? ")" : "");
    }
    p->depth--;
}

/* NULL: out of memory, or a rule beyond its limits. */
static char *text_of(const known_table *table, const fp3_model *model, uint32_t id, int is_rule) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    printer p = {.model = model, .root = table ? FP3_NONE : id, .out = out, .is_rule = is_rule};
    if (table)
        print_known(table, &p, id, LOOSE);
    else
        print(&p, id, LOOSE);
    const int is_cut = is_long(&p);
    if (is_cut)
        fputs(" ...", out);
    if (fclose(out) || (is_rule && is_cut)) {
        free(text);
        return NULL;
    }
    return text;
}

char *fp3_formula_known(const known_table *table, uint32_t id) {
    return text_of(table, table->model, id, 0);
}

char *fp3_formula_rule(const known_table *table, uint32_t id) {
    return text_of(table, table->model, id, 1);
}

char *fp3_formula_expr(const fp3_model *model, uint32_t expr) {
    return text_of(NULL, model, expr, 0);
}
