/* two_streams.c - what a loop over neighbours would take of a lane that adds and multiplies at
 * once.
 *
 *     two_streams MODEL.ode INTEGRATOR
 *
 * No configuration has both `dual` and `neighbours`. The turns of the program for `world`, with
 * their sums and products apart, are scheduled for `dual_full` by the compiler's own passes, with
 * 64 registers. All that is not known of such a lane is in its favour: a neighbour's word may be an
 * operand of a sum or of a product, like a constant, and no load waits for the store.
 *
 * Prints a line for each loop: loop N: world W, sums N, products N, and with moves of operands the
 * operations of the unit that has most of them, and the cycles of a context's turn:
 *   banks N C       as `dual` is: an operation reads at most one register of each bank
 *   squares N C     ... but a product may take one register as both operands
 *   free N C        ... but an operation may read any two registers
 * A turn ends with `next`, which takes both units as a load does.
 */
#include "compiler/code/banks.h"
#include "compiler/schedule/schedule.h"
#include "machine/cycles.h"
#include "machine/neighbours.h"
#include "machine/phased.h"

#include <fp3/compile.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REGISTERS FP3_BANK_OBJECT_COUNT
#define WORDS                                                                                      \
    FP3_BANK_SHARED_COUNT          /* constants from here on stand for words of a neighbour, ...   \
                                    */
#define FIELDS (WORDS + REGISTERS) /* ... and fields of its entry */
#define ONE (FIELDS + FP3_FIELDS_MAX)
#define MINUS_ZERO (ONE + 1)

typedef enum { BANKS, SQUARES, FREE, RULES } rule;

static fp3_error error;

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

static void *some(size_t count, size_t size) {
    void *made = calloc(count + 1, size);
    if (!made)
        exit(1);
    return made;
}

/* ---- a turn as a step ---- */

typedef struct {
    fp3_ref now[REGISTERS]; /* the value of each register */
    uint64_t written;       /* registers that the turn writes */
    fp3_step_code *code;
} turn;

/* What a register holds when the turn begins: what the turn before has left, or what stays. */
static fp3_ref begins_with(turn *t, uint32_t reg) {
    if (t->now[reg].at != FP3_AT_NOWHERE)
        return t->now[reg];
    if (!(t->written >> reg & 1))
        return t->now[reg] = (fp3_ref){FP3_AT_PARAM, t->code->param_count++};
    t->code->variables[t->code->variable_count].next.index = reg;
    return t->now[reg] = (fp3_ref){FP3_AT_VARIABLE, t->code->variable_count++};
}

static fp3_ref value_of(turn *t, uint32_t number) {
    return number < FP3_BANK_SHARED_BASE
               ? begins_with(t, number)
               : (fp3_ref){FP3_AT_CONSTANT, number - FP3_BANK_SHARED_BASE};
}

static void add(turn *t, const fp3_decoded *word, rule rule) {
    const fp3_operation *of = word->of;
    fp3_op *op = &t->code->step[t->code->step_count];
    *op = (fp3_op){.op = word->in.op, .note = FP3_NONE_INDEX};
    if (of->computes) {
        const fp3_ref given = {FP3_AT_CONSTANT,
                               (of->gives == FP3_GIVES_WORD ? WORDS : FIELDS) + word->in.b};
        const fp3_ref own = value_of(t, word->in.a);
        op->op = of->computes;
        op->a = of->is_first ? given : own;
        op->b = of->is_first ? own : given;
    } else {
        op->a = value_of(t, word->in.a);
        if (of->sources > 1)
            op->b = value_of(t, word->in.b);
    }
    /* It takes the multiplier, and one operand of the bank of sums: as an estimate does. */
    if (rule == SQUARES && op->op == FP3_OP_MUL && op->a.at == op->b.at &&
        op->a.index == op->b.index && op->a.at != FP3_AT_CONSTANT) {
        op->op = FP3_OP_RSQRT;
        op->b = (fp3_ref){FP3_AT_NOWHERE, 0};
    }
    t->now[word->in.d] = (fp3_ref){FP3_AT_OP, t->code->step_count++};
}

/* The words between `each` and `next`. */
static void read_turn(const fp3_decoded *words, uint32_t count, rule rule, fp3_step_code *code) {
    turn t = {.code = code};
    *code = (fp3_step_code){.constant_count = MINUS_ZERO + 1, .minus_zero = MINUS_ZERO};
    code->step = some(count, sizeof *code->step);
    code->first = some(0, sizeof *code->first);
    code->last = some(0, sizeof *code->last);
    code->variables = some(REGISTERS, sizeof *code->variables);
    for (uint32_t i = 0; i < count; i++)
        t.written |= UINT64_C(1) << words[i].in.d;
    for (uint32_t i = 0; i < count; i++)
        add(&t, &words[i], rule);
    for (uint32_t x = 0; x < code->variable_count; x++)
        code->variables[x].next = t.now[code->variables[x].next.index];
}

static void free_code(fp3_step_code *code) {
    free(code->step);
    free(code->first);
    free(code->last);
    free(code->variables);
    free(code->param_registers);
}

/* ---- its cycles ---- */

/* With `next` at its end. */
static double cycles_of(const fp3_config *config, const fp3_schedule *made) {
    const uint32_t count = made->step_count + 1;
    fp3_decoded *code = some(count, sizeof *code);
    for (uint32_t i = 0; i < made->step_count; i++)
        code[i].of = fp3_operation_find(made->step[i].op);
    code[count - 1].of = fp3_operation_find(FP3_OP_NEXT);
    const double cycles = fp3_cycles_swept_step(config, &(fp3_swept){code, count, 0, count, 1});
    free(code);
    return cycles;
}

static uint32_t most_of_a_unit(const fp3_step_code *code) {
    uint32_t products = 0;
    for (uint32_t i = 0; i < code->step_count; i++)
        products += (uint32_t)fp3_operation_multiplies(fp3_operation_find(code->step[i].op));
    const uint32_t sums = code->step_count - products;
    return sums > products ? sums : products;
}

static void print_rule(const fp3_decoded *words, uint32_t count, rule rule) {
    static const char *const names[] = {"banks", "squares", "free"};
    fp3_config config = *fp3_config_find("dual_full");
    fp3_step_code code;
    fp3_schedule *made;
    config.registers = REGISTERS;
    config.lanes = 1;
    read_turn(words, count, rule, &code);
    if (rule != FREE)
        told(fp3_banks_split(&code, ONE, MINUS_ZERO, &error));
    told(fp3_schedule_make(&code, &config, &made, &error));
    printf(", %s %" PRIu32 " %.2f", names[rule], most_of_a_unit(&code), cycles_of(&config, made));
    fp3_schedule_free(&made);
    free_code(&code);
}

/* ---- the program ---- */

static fp3_compiled *compile(const fp3_model *model, const char *integrator, unsigned without) {
    fp3_compile_def def = fp3_compile_default();
    fp3_compiled *made;
    fp3_integrator *method;
    def.config = "world";
    def.passes &= ~without;
    told(fp3_integrator_find(integrator, &method, &error));
    told(fp3_compile(model, method, &def, &made, &error));
    fp3_integrator_free(&method);
    return made;
}

/* Whether `dual_full` has all operations of a loop; a load is none. */
static void check(const fp3_decoded *words, uint32_t count) {
    const fp3_config *config = fp3_config_find("dual_full");
    for (uint32_t i = 0; i < count; i++) {
        const fp3_operation *of = words[i].of;
        const fp3_operation *is = of->computes ? fp3_operation_find(of->computes) : of;
        if (!fp3_operation_is_arithmetic(is) ||
            fp3_operation_lacks(config, is->code) != FP3_KEY_NONE) {
            printf("FAIL: a loop has '%s'\n", of->name);
            exit(1);
        }
    }
}

/* The loop that begins at this word or behind it; `count`: there is none. */
static uint32_t loop_from(const fp3_decoded *code, uint32_t count, uint32_t at) {
    while (at < count && code[at].in.op != FP3_OP_EACH)
        at++;
    return at;
}

int main(int argc, char **argv) {
    fp3_model *model;
    char *report;
    if (argc != 3)
        return 2;
    told(fp3_model_load(argv[1], &model, &report, &error));
    free(report);
    fp3_compiled *world = compile(model, argv[2], 0);
    fp3_compiled *apart = compile(model, argv[2], FP3_PASS(FP3_PASS_CHAIN));
    const uint32_t count = world->image->code_count, words = apart->image->code_count;
    fp3_decoded *chained = fp3_decode_all(world->image->code, count);
    fp3_decoded *code = fp3_decode_all(apart->image->code, words);
    if (!chained || !code)
        return 1;
    uint32_t loop = loop_from(chained, count, 0), at = loop_from(code, words, 0);
    for (uint32_t n = 1; at < words; n++) {
        const uint32_t end = fp3_neighbourhood_end(code, at);
        uint32_t products = 0;
        check(&code[at + 1], end - at - 1);
        for (uint32_t i = at + 1; i < end; i++)
            products += (uint32_t)fp3_operation_multiplies(code[i].of);
        printf("loop %" PRIu32 ": world %" PRIu32 ", sums %" PRIu32 ", products %" PRIu32, n,
               fp3_turn_cost_of(&(fp3_phased){chained, count}, loop), end - at - 1 - products,
               products);
        for (rule rule = BANKS; rule < RULES; rule++)
            print_rule(&code[at + 1], end - at - 1, rule);
        printf("\n");
        loop = loop_from(chained, count, loop + 1);
        at = loop_from(code, words, end);
    }
    free(chained);
    free(code);
    fp3_compiled_free(&world);
    fp3_compiled_free(&apart);
    fp3_model_free(&model);
    return 0;
}
