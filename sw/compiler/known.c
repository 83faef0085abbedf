/* known.c - values that the host computes. */
#include "known.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t add(known_table *table, known wanted) {
    for (uint32_t i = 0; i < table->count; i++) {
        const known *k = &table->list[i];
        if (k->op == wanted.op && k->a == wanted.a && k->b == wanted.b &&
            memcmp(&k->number, &wanted.number, sizeof k->number) == 0)
            return i;
    }
    if (table->count == table->room) {
        const uint32_t room = table->room ? 2 * table->room : 64;
        known *list = realloc(table->list, room * sizeof *list);
        if (!list) {
            table->has_failed = 1;
            return 0;
        }
        table->list = list;
        table->room = room;
    }
    table->list[table->count] = wanted;
    return table->count++;
}

/* Whether no param of a single object is in it, for each expression of the model. */
static char *find_shared(const fp3_model *model) {
    char *shared = malloc(model->expr_count + 1);
    for (uint32_t i = 0; shared && i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        shared[i] = e->op != FP3_EXPR_PARAM || model->params[e->index].is_shared;
        for (int j = 0; j < 3; j++)
            if (e->operand[j] != FP3_NONE && !shared[e->operand[j]])
                shared[i] = 0;
    }
    return shared;
}

void fp3_known_open(known_table *table, const fp3_model *model) {
    *table = (known_table){.model = model, .is_shared = find_shared(model)};
    table->has_failed = !table->is_shared;
    if (!table->has_failed)
        fp3_known_number(table, 0.0);
}

void fp3_known_close(known_table *table) {
    free(table->list);
    free(table->is_shared);
    *table = (known_table){0};
}

uint32_t fp3_known_number(known_table *table, double number) {
    return add(table, (known){.op = KNOWN_NUMBER, .number = number, .is_shared = 1});
}

uint32_t fp3_known_step(known_table *table) {
    return add(table, (known){.op = KNOWN_STEP, .is_shared = 1});
}

uint32_t fp3_known_model(known_table *table, uint32_t expr) {
    const fp3_expr *e = &table->model->exprs[expr];
    if (e->op == FP3_EXPR_NUMBER)
        return fp3_known_number(table, e->number);
    if (e->op == FP3_EXPR_NEGATE)
        return fp3_known_make(table, KNOWN_NEGATE, fp3_known_model(table, e->operand[0]), 0);
    return add(table, (known){.op = KNOWN_MODEL, .a = expr, .is_shared = table->is_shared[expr]});
}

static double apply(known_op op, double a, double b) {
    switch (op) {
    case KNOWN_NEGATE:
        return -a;
    case KNOWN_ADD:
        return a + b;
    case KNOWN_SUB:
        return a - b;
    case KNOWN_MUL:
        return a * b;
    default:
        return a / b;
    }
}

uint32_t fp3_known_make(known_table *table, known_op op, uint32_t a, uint32_t b) {
    const known *x = &table->list[a], *y = &table->list[b];
    if (x->op == KNOWN_NUMBER && y->op == KNOWN_NUMBER)
        return fp3_known_number(table, apply(op, x->number, y->number));
    if (op == KNOWN_NEGATE && x->op == KNOWN_NEGATE)
        return x->a;
    if (op == KNOWN_MUL && x->op == KNOWN_NUMBER && x->number == 1)
        return b;
    if ((op == KNOWN_MUL || op == KNOWN_DIV) && y->op == KNOWN_NUMBER && y->number == 1)
        return a;
    return add(table, (known){.op = op, .a = a, .b = b, .is_shared = x->is_shared && y->is_shared});
}

int fp3_known_is(const known_table *table, uint32_t id, double number) {
    const known *k = &table->list[id];
    return k->op == KNOWN_NUMBER && memcmp(&k->number, &number, sizeof number) == 0;
}

fp3_status fp3_known_evaluate(const known_table *table, const double *params, double h,
                              double *values, fp3_error *error) {
    const fp3_model *model = table->model;
    double *exprs = malloc((model->expr_count + 1) * sizeof *exprs);
    double *states = calloc(model->state_count + 1, sizeof *states);
    if (!exprs || !states) {
        free(exprs);
        free(states);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    fp3_model_evaluate(model, &(fp3_point){.states = states, .params = params}, exprs);
    for (uint32_t i = 0; i < table->count; i++) {
        const known *k = &table->list[i];
        if (k->op == KNOWN_NUMBER)
            values[i] = k->number;
        else if (k->op == KNOWN_STEP)
            values[i] = h;
        else if (k->op == KNOWN_MODEL)
            values[i] = exprs[k->a];
        else
            values[i] = apply(k->op, values[k->a], values[k->b]);
    }
    free(exprs);
    free(states);
    return FP3_OK;
}

/* ---- as text ---- */

/* Binding strength of what is written around an operand. */
enum { LOOSE, EITHER, BOTH, COMPARED, SUM, PRODUCT, UNARY, RAISED };

#define DEPTH_LIMIT 24 /* of what is written out; a chain of additions may be thousands deep */
#define TEXT_LIMIT 72  /* bytes, about: a comment stays on its line */

typedef struct {
    const fp3_model *model;
    uint32_t root; /* its own name does not stand for it */
    FILE *out;
    unsigned depth;
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

static const char *function_name(fp3_expr_op op) {
    switch (op) {
#define X(NAME, operands, host)                                                                    \
    case FP3_EXPR_##NAME:                                                                          \
        return #NAME;
        FP3_EXPR_OPS(X)
#undef X
    default:
        return "?";
    }
}

static const char *definition_of(printer *p, uint32_t expr) {
    for (uint32_t i = 0; expr != p->root && i < p->model->definition_count; i++)
        if (p->model->definitions[i].expr == expr)
            return p->model->definitions[i].name;
    return NULL;
}

static int is_long(const printer *p) { return ftell(p->out) > TEXT_LIMIT; }

/* Nothing more, once it is long. */
static void put(printer *p, const char *text) {
    if (!is_long(p))
        fputs(text, p->out);
}

static void put_number(printer *p, double number, int around) {
    char text[32];
    snprintf(text, sizeof text, signbit(number) && around > SUM ? "(%.9g)" : "%.9g", number);
    put(p, text);
}

static void print(printer *p, uint32_t expr, int around);

static void print_call(printer *p, const fp3_expr *e) {
    char name[16] = "";
    for (const char *c = function_name(e->op); *c && strlen(name) + 1 < sizeof name; c++)
        name[strlen(name)] = (char)tolower((unsigned char)*c);
    put(p, name);
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

static void print(printer *p, uint32_t expr, int around) {
    const fp3_expr *e = &p->model->exprs[expr];
    if (is_long(p))
        return;
    if (p->depth == DEPTH_LIMIT) {
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
    else if (e->op == FP3_EXPR_PARAM)
        put(p, p->model->params[e->index].name);
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
    } else {
        put(p, level < around ? "(" : "");
        print_known(table, p, k->a, level);
        put(p, sign[k->op]);
        print_known(table, p, k->b, level + 1);
        put(p, level < around ? ")" : "");
    }
}

static char *text_of(const known_table *table, const fp3_model *model, uint32_t id) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    printer p = {.model = model, .root = table ? FP3_NONE : id, .out = out};
    if (table)
        print_known(table, &p, id, LOOSE);
    else
        print(&p, id, LOOSE);
    if (is_long(&p))
        fputs(" ...", out);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}

char *fp3_known_text(const known_table *table, uint32_t id) {
    return text_of(table, table->model, id);
}

char *fp3_expr_text(const fp3_model *model, uint32_t expr) { return text_of(NULL, model, expr); }
