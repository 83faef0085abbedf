/* SPDX-License-Identifier: Apache-2.0 */
/* write_words.c - see write_words.h. */
#include "write_words.h"

#include <fp3/isa.h>
#include <inttypes.h>

typedef fp3_writer writer;

void fp3_write_operand(const writer *w, uint32_t number, unsigned vector) {
    if (number == FP3_FAST_GIVEN)
        fprintf(w->to, "given_%u", vector);
    else if (number >= FP3_BANK_SHARED_BASE)
        fprintf(w->to, "k%" PRIu32, number - FP3_BANK_SHARED_BASE);
    else
        fprintf(w->to, "r%" PRIu32 "_%u", number, vector);
}

/* ---- an instruction ---- */

static int compares(uint32_t op) {
    return op == FP3_OP_MIN || op == FP3_OP_MAX || op == FP3_OP_LT || op == FP3_OP_LE;
}

static int is_estimate(uint32_t op) { return op == FP3_OP_RCP || op == FP3_OP_RSQRT; }

/* With what is_behind_words asks for. */
static void value(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const fp3_instruction *in = &p->in;
    const fp3_operation *of = fp3_operation_find(in->op);
    const int is_around = p->is_behind_words && !is_estimate(in->op);
    fprintf(w->to, "%sfp3_%s%s(", is_around ? "fp3_behind(" : "", of->name,
            !p->is_behind_words   ? ""
            : compares(in->op)    ? "_raw"
            : is_estimate(in->op) ? "_behind"
                                  : "");
    for (uint32_t i = 0; i < of->sources; i++) {
        fprintf(w->to, i ? ", " : "");
        fp3_write_operand(w, fp3_operand(in, "abc"[i]), vector);
    }
    fprintf(w->to, "%s)%s", is_estimate(in->op) ? ", table" : "", is_around ? ")" : "");
}

void fp3_write_keep(const writer *w, uint32_t reg, unsigned vector) {
    fprintf(w->to, "        __asm__ volatile(\"\" : : FP3_ANYWHERE(r%" PRIu32 "_%u));\n", reg,
            vector);
}

void fp3_write_stored(const writer *w, uint32_t reg, unsigned vector) {
    if (w->plan->config->flags)
        fp3_write_keep(w, reg, vector);
}

void fp3_write_arithmetic(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const int is_masked = p->is_masked;
    if (p->is_dead && !w->plan->config->flags)
        return;
    /* Of two that are the same, one is chosen without a look at c. */
    const int is_same = p->in.op == FP3_OP_SEL && p->in.a == p->in.b;
    if (is_same && w->plan->config->flags && p->in.c < FP3_BANK_SHARED_BASE)
        fp3_write_keep(w, p->in.c, vector);
    fprintf(w->to, "        r%" PRIu32 "_%u = ", p->in.d, vector);
    if (is_masked)
        fprintf(w->to, "fp3_choose(awake_%u, ", vector);
    fprintf(w->to, "%s", p->is_one_nan ? "fp3_one_nan(" : "");
    value(w, p, vector);
    fprintf(w->to, "%s", p->is_one_nan ? ")" : "");
    if (is_masked)
        fprintf(w->to, ", r%" PRIu32 "_%u)", p->in.d, vector);
    fprintf(w->to, ";\n");
    if (p->is_dead || (p->is_unread && w->plan->config->flags))
        fp3_write_keep(w, p->in.d, vector);
}

void fp3_write_fold(const writer *w, const fp3_fast_word *p, unsigned vector, const char *mask) {
    const fp3_instruction *in = &p->in;
    if (compares(in->op)) {
        fprintf(w->to, "        r%" PRIu32 "_%u = fp3_choose(%s, %s", in->d, vector, mask,
                p->is_one_nan ? "fp3_one_nan(" : "");
        value(w, p, vector);
        fprintf(w->to, "%s, r%" PRIu32 "_%u);\n", p->is_one_nan ? ")" : "", in->d, vector);
        return;
    }
    const int is_minus = in->op == FP3_OP_SUB || in->op == FP3_OP_MSUB;
    const int is_product = in->op == FP3_OP_MADD || in->op == FP3_OP_MSUB;
    const uint32_t added = !is_product && in->a == in->d ? in->b : in->a;
    fprintf(w->to, "        r%" PRIu32 "_%u = %sfp3_%s(r%" PRIu32 "_%u, fp3_choose(%s, ", in->d,
            vector, p->is_one_nan ? "fp3_one_nan(" : "", is_minus ? "sub" : "add", in->d, vector,
            mask);
    if (is_product)
        fprintf(w->to, "fp3_mul(");
    fp3_write_operand(w, added, vector);
    if (is_product) {
        fprintf(w->to, ", ");
        fp3_write_operand(w, in->b, vector);
    }
    fprintf(w->to, "%s, (fp3_v)fp3_all(%s)))%s;\n", is_product ? ")" : "",
            is_minus ? "0" : "FP3_SIGN", p->is_one_nan ? ")" : "");
}

uint64_t fp3_write_registers(const fp3_fast_plan *plan) {
    uint64_t set = plan->entered | plan->live;
    for (uint32_t pc = 0; pc < plan->count; pc++) {
        const fp3_instruction *in = &plan->code[pc].in;
        set |= (uint64_t)1 << in->d;
        for (uint32_t i = 0; i < fp3_operation_find(in->op)->sources; i++)
            if (fp3_operand(in, "abc"[i]) < FP3_BANK_SHARED_BASE)
                set |= (uint64_t)1 << fp3_operand(in, "abc"[i]);
    }
    return set;
}

void fp3_write_constants(const writer *w) {
    FP3_EACH_REGISTER (w->plan->constants, k)
        fprintf(w->to,
                "    const fp3_v k%" PRIu32 " = (fp3_v)fp3_all(p->constants[%" PRIu32
                "]);\n    (void)k%" PRIu32 ";\n",
                k, k, k);
}
