/* SPDX-License-Identifier: Apache-2.0 */
/* plan.c - see plan.h. */
#include "plan.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static uint64_t bit(uint32_t operand) {
    return operand < FP3_BANK_SHARED_BASE ? (uint64_t)1 << operand : 0;
}

static int is_arithmetic(const fp3_instruction *in) {
    return fp3_operation_is_arithmetic(fp3_operation_find(in->op));
}

static int is_load(const fp3_instruction *in) {
    return in->op == FP3_OP_LD || in->op == FP3_OP_LDS;
}

static int is_of_neighbour(const fp3_instruction *in) {
    return in->op == FP3_OP_LDN || in->op == FP3_OP_LDL;
}

/* Register d is written to a record or an entry. */
static int is_kept(const fp3_instruction *in) {
    return in->op == FP3_OP_ST || in->op == FP3_OP_STL;
}

static uint32_t sources_of(const fp3_instruction *in) {
    return fp3_operation_find(in->op)->sources;
}

uint32_t fp3_fast_record(const fp3_fast_plan *plan) {
    return ((uint32_t)__builtin_popcountll(plan->around.published) + 3) / 4 * 4;
}

uint64_t fp3_fast_touched(const fp3_fast_word *word) {
    uint64_t set = bit(word->in.d);
    for (uint32_t i = 0; i < sources_of(&word->in); i++)
        set |= bit(fp3_operand(&word->in, "abc"[i]));
    return set;
}

/* ---- reading ---- */

/* in_front: words that the image does not have. */
static fp3_status check(const fp3_fast_plan *plan, uint32_t pc, uint32_t in_front,
                        fp3_error *error) {
    const fp3_config *config = plan->config;
    const fp3_instruction *in = &plan->code[pc].in;
    const uint32_t in_bank = FP3_BANK_SHARED_BASE - 1, most = config->registers;
    if (in->d >= most || (in->a & in_bank) >= most || (in->b & in_bank) >= most ||
        (in->c & in_bank) >= most || fp3_operation_lacks(config, in->op) != FP3_KEY_NONE ||
        fp3_operation_mixes(config, in))
        return fp3_fail(error, FP3_E_PROGRAM,
                        "word %" PRIu32 " is no instruction of configuration '%s'", pc - in_front,
                        config->name);
    for (uint32_t i = 0; in->op == FP3_OP_LDS && i < pc; i++)
        if (!is_load(&plan->code[i].in))
            return fp3_fail(error, FP3_E_PROGRAM,
                            "word %" PRIu32 " is an lds: engine 'fast' takes an lds only behind "
                            "loads",
                            pc - in_front);
    return FP3_OK;
}

static void note(fp3_fast_plan *plan, uint32_t pc) {
    const fp3_instruction *in = &plan->code[pc].in;
    for (uint32_t i = 0; i < sources_of(in); i++) {
        const uint32_t operand = fp3_operand(in, "abc"[i]);
        if (operand >= FP3_BANK_SHARED_BASE && operand != FP3_FAST_GIVEN)
            plan->constants |= (uint64_t)1 << (operand - FP3_BANK_SHARED_BASE);
    }
    if (is_load(in))
        plan->read |= bit(in->d);
    if (plan->code[pc].gives == FP3_GIVES_WORD)
        plan->read |= bit(plan->code[pc].number);
    if (in->op == FP3_OP_ST)
        plan->stored |= bit(in->d);
    for (int i = 0; i < FP3_PARTS; i++) {
        if (pc < plan->part[i].first || pc >= plan->part[i].end)
            continue;
        plan->part[i].words |= is_load(in) || in->op == FP3_OP_ST ? bit(in->d) : 0;
        plan->part[i].stored |= in->op == FP3_OP_ST ? bit(in->d) : 0;
    }
    if (is_arithmetic(in))
        plan->written |= bit(in->d);
    plan->sleeps |= in->op == FP3_OP_SLEEP;
    plan->has_lds |= in->op == FP3_OP_LDS;
}

/* What a neighbour gives a word; arithmetic with it becomes that of registers. loaded: by `ldl`, of
 * this turn. */
static void find_given(fp3_fast_word *p, const fp3_operation *of, uint32_t *loaded) {
    const fp3_instruction in = p->in;
    if (in.op == FP3_OP_EACH)
        *loaded = 0;
    p->gives = of->gives;
    if (of->takes_field)
        p->number = fp3_operand(&in, of->number);
    if (p->gives == FP3_GIVES_NOTHING)
        return;
    p->number = of->number ? fp3_operand(&in, of->number) : (*loaded)++;
    if (!of->computes)
        return;
    p->in = (fp3_instruction){.op = of->computes, .d = in.d};
    fp3_operation_place(of, in.a, FP3_FAST_GIVEN, &p->in.a, &p->in.b);
}

static fp3_status decode(const fp3_code *code, fp3_fast_plan *plan, fp3_error *error) {
    fp3_status status = FP3_OK;
    uint32_t loaded = 0;
    for (uint32_t pc = 0; !status && pc < code->count; pc++) {
        plan->code[pc].in = code->decoded[pc].in;
        if (!code->decoded[pc].of)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "word %" PRIu32 " is no instruction: engine 'fast' refuses the program",
                            pc - code->in_front);
        status = check(plan, pc, code->in_front, error);
        if (status)
            break;
        plan->code[pc].ends_phase = fp3_ends_phase(&code->decoded[pc]);
        find_given(&plan->code[pc], code->decoded[pc].of, &loaded);
        note(plan, pc);
    }
    return status;
}

/* ---- what is read later ---- */

/* The registers that are live before an instruction; asleep: before the last part. */
static uint64_t before(const fp3_instruction *in, uint64_t live, uint64_t asleep) {
    const fp3_operation *of = fp3_operation_find(in->op);
    if (of->writes == FP3_WRITES_ALWAYS)
        live &= ~bit(in->d);
    if (is_kept(in))
        live |= bit(in->d);
    if (in->op == FP3_OP_SLEEP)
        live |= asleep;
    for (uint32_t i = 0; i < sources_of(in); i++)
        live |= bit(fp3_operand(in, "abc"[i]));
    return live;
}

static uint64_t pass_words(fp3_fast_plan *plan, uint32_t first, uint32_t end, uint64_t live,
                           uint64_t asleep);

/* Of a loop: what the next neighbour needs is read, too. */
static uint64_t pass_loop(fp3_fast_plan *plan, fp3_fast_loop *loop, uint64_t after) {
    uint64_t head = 0, written = 0;
    for (uint64_t old = UINT64_MAX; head != old;) {
        old = head;
        head = pass_words(plan, loop->first, loop->end, after | head, 0);
    }
    for (uint32_t pc = loop->first; pc < loop->end; pc++)
        written |= is_kept(&plan->code[pc].in) ? 0 : bit(plan->code[pc].in.d);
    loop->kept = written & (after | head);
    loop->outside = head & ~loop->kept;
    return after | head;
}

static uint64_t pass_words(fp3_fast_plan *plan, uint32_t first, uint32_t end, uint64_t live,
                           uint64_t asleep) {
    for (uint32_t pc = end; pc-- > first;) {
        fp3_fast_word *p = &plan->code[pc];
        uint32_t loop = 0;
        while (loop < plan->loop_count && plan->loops[loop].end != pc)
            loop++;
        if (loop < plan->loop_count) {
            live = pass_loop(plan, &plan->loops[loop], live);
            pc = plan->loops[loop].first - 1; /* `each` */
            continue;
        }
        p->is_dead = is_arithmetic(&p->in) && !(live & bit(p->in.d));
        live = before(&p->in, live, asleep);
    }
    return live;
}

/* Of a part: live before it, from what is live after it. Notes instructions with unread results. */
static uint64_t pass(fp3_fast_plan *plan, fp3_fast_part_number part, uint64_t live,
                     uint64_t asleep) {
    return pass_words(plan, plan->part[part].first, plan->part[part].end, live, asleep);
}

static uint64_t writes_of(const fp3_fast_plan *plan, fp3_fast_part_number part) {
    uint64_t set = 0;
    for (uint32_t pc = plan->part[part].first; pc < plan->part[part].end; pc++)
        if (fp3_operation_find(plan->code[pc].in.op)->writes != FP3_WRITES_NEVER)
            set |= bit(plan->code[pc].in.d);
    return set;
}

/* Notes what a step makes and no later step reads. live: what the next step reads. */
static void find_unread(fp3_fast_plan *plan, uint64_t live, uint64_t asleep) {
    const fp3_fast_part *step = &plan->part[FP3_PART_STEP];
    for (uint32_t pc = step->end; pc-- > step->first;) {
        fp3_fast_word *p = &plan->code[pc];
        p->is_unread = is_arithmetic(&p->in) && !(live & bit(p->in.d));
        live = before(&p->in, live, asleep);
    }
}

/* What those asleep keep is read, too. */
static void find_live(fp3_fast_plan *plan, uint64_t states) {
    for (fp3_fast_part_number i = FP3_PART_FIRST; i < FP3_PARTS; i++)
        plan->part[i].written = writes_of(plan, i);
    plan->left = plan->config->interleave ? 0 : UINT64_MAX;
    const uint64_t last = pass(plan, FP3_PART_LAST, plan->left, 0) | (plan->sleeps ? states : 0);
    uint64_t head = 0;
    for (uint64_t old = UINT64_MAX; head != old;) {
        old = head;
        head |= pass(plan, FP3_PART_STEP, head | last, last);
    }
    find_unread(plan, head, last);
    plan->live = head | last;
    plan->entered = pass(plan, FP3_PART_FIRST, plan->live, last) |
                    (plan->sleeps ? plan->part[FP3_PART_FIRST].written & plan->live : 0);
}

/* ---- whose NaN it is ---- */

enum { OF_HOST = 1, OF_ADDER = 2 };

static int is_constant(uint32_t operand) {
    return operand >= FP3_BANK_SHARED_BASE && operand != FP3_FAST_GIVEN;
}

/* What a value may have come from; shared constants come from the host. */
static int origin(const unsigned char *from, uint32_t operand) {
    return operand < FP3_BANK_SHARED_BASE ? from[operand] : OF_HOST;
}

static int is_sum(uint32_t op) {
    return op == FP3_OP_ADD || op == FP3_OP_SUB || op == FP3_OP_MUL || op == FP3_OP_MADD ||
           op == FP3_OP_MSUB || op == FP3_OP_FMADD || op == FP3_OP_FMSUB || op == FP3_OP_ADDH ||
           op == FP3_OP_SUBH || op == FP3_OP_ADDT || op == FP3_OP_SUBT;
}

/* Of operands that are not. */
static int makes_subnormal(uint32_t op) { return op == FP3_OP_RCP || op == FP3_OP_EXP2; }

/* From what is known before an instruction to what is known after it. mixed: registers that are
 * stored and may hold either. */
static void follow(fp3_fast_word *p, const fp3_config *config, unsigned char *from,
                   uint64_t *mixed) {
    const fp3_instruction *in = &p->in;
    if (is_kept(in) && from[in->d] == (OF_HOST | OF_ADDER))
        *mixed |= bit(in->d);
    if (is_kept(in))
        p->is_one_nan = from[in->d] == OF_ADDER;
    if (is_load(in) || is_of_neighbour(in))
        from[in->d] = OF_HOST;
    if (in->op == FP3_OP_SLEEP)
        from[in->d] |= OF_HOST;
    if (!is_arithmetic(in))
        return;
    /* Without infinities, a zero of any sign becomes +0 there. */
    p->is_behind = in->op == FP3_OP_RSQRT || (!config->subnormal && makes_subnormal(in->op)) ||
                   (config->finite && !is_sum(in->op));
    p->is_behind_words = p->is_behind;
    for (uint32_t i = 0; !is_sum(in->op) && i < sources_of(in); i++) {
        const uint32_t operand = fp3_operand(in, "abc"[i]);
        const int is_of_host = origin(from, operand) & OF_HOST;
        p->is_behind |= is_of_host;
        if (!config->subnormal || !is_constant(operand)) /* one below the normal ones is flushed */
            p->is_behind_words |= is_of_host;
    }
    from[in->d] = OF_ADDER;
}

static void follow_part(fp3_fast_plan *plan, fp3_fast_part_number part, unsigned char *from,
                        uint64_t *mixed) {
    unsigned char outside[FP3_BANK_OBJECT_COUNT] = {0};
    uint32_t loop = 0;
    int turns = 0;
    for (uint32_t pc = plan->part[part].first; pc < plan->part[part].end; pc++) {
        follow(&plan->code[pc], plan->config, from, mixed);
        if (loop == plan->loop_count)
            continue;
        if (plan->code[pc].in.op == FP3_OP_EACH)
            memcpy(outside, from, sizeof outside);
        if (pc != plan->loops[loop].end)
            continue;
        for (int i = 0; i < FP3_BANK_OBJECT_COUNT; i++)
            from[i] |= outside[i]; /* there may be no neighbour, or another */
        if (++turns < 2) {
            pc = plan->loops[loop].first - 1;
        } else {
            turns = 0;
            loop++;
        }
    }
}

/* ---- loops and phases ---- */

/* Which phases a step makes. */
static void find_order(const fp3_code *code, fp3_fast_plan *plan) {
    for (uint32_t i = 0, first, end; i < plan->around.phases; i++) {
        fp3_neighbourhood_phase(code, i, &first, &end);
        while (plan->phase[plan->order[i]] < first)
            plan->order[i]++;
    }
}

static fp3_status find_loops(const fp3_code *code, fp3_fast_plan *plan, fp3_error *error) {
    uint32_t phases = 0;
    plan->loops = calloc(plan->count + 1u, sizeof *plan->loops);
    plan->phase = calloc(plan->around.distinct + 2u, sizeof *plan->phase);
    plan->order = calloc(plan->around.phases + 1u, sizeof *plan->order);
    if (!plan->loops || !plan->phase || !plan->order)
        return fp3_no_memory(error);
    for (uint32_t pc = 0; pc < plan->count; pc++) {
        const fp3_instruction *in = &plan->code[pc].in;
        fp3_fast_loop *loop = &plan->loops[plan->loop_count];
        if (in->op == FP3_OP_EACH) {
            loop->first = pc + 1;
            while (plan->around.lists[loop->list].reg != in->d)
                loop->list++;
        } else if (in->op == FP3_OP_NEXT) {
            loop->end = pc;
            plan->loop_count++;
        } else if (plan->code[pc].ends_phase) {
            plan->phase[++phases] = pc + 1;
        }
    }
    plan->phase[++phases] = plan->count;
    find_order(code, plan);
    return FP3_OK;
}

/* Register d is a sum, a least or a most: it takes something that does not depend on what a loop
 * keeps. */
static int changes_a_fold(const fp3_instruction *in, uint64_t kept) {
    const uint64_t a = bit(in->a) & kept, b = bit(in->b) & kept, own = bit(in->d) & kept;
    switch (in->op) {
    case FP3_OP_ADD:
    case FP3_OP_MIN:
    case FP3_OP_MAX:
        return (a == own && !b) || (b == own && !a);
    case FP3_OP_SUB:
        return a == own && !b;
    case FP3_OP_MADD:
    case FP3_OP_MSUB:
        return bit(in->c) == own && !a && !b;
    default:
        return 0;
    }
}

/* Of what the loop keeps each register has been computed before it in this phase, so that it is no
 * NaN of the host's, and only folds change it. */
static int are_folds(const fp3_fast_plan *plan, const fp3_fast_loop *loop, uint32_t phase) {
    uint64_t computed = 0;
    for (uint32_t pc = phase; pc < loop->first; pc++) {
        const fp3_instruction *in = &plan->code[pc].in;
        if (is_arithmetic(in))
            computed |= bit(in->d);
        else if (!is_kept(in))
            computed &= ~bit(in->d);
    }
    for (uint32_t pc = loop->first; pc < loop->end; pc++)
        if (fp3_fast_touched(&plan->code[pc]) & loop->kept &&
            !changes_a_fold(&plan->code[pc].in, loop->kept))
            return 0;
    return !(loop->kept & ~computed);
}

int fp3_fast_remembers(const fp3_fast_plan *plan, uint32_t phase) {
    int is_any = 0;
    for (uint32_t pc = plan->phase[phase]; pc < plan->phase[phase + 1]; pc++)
        is_any |= plan->code[pc].in.op == FP3_OP_STL;
    return is_any;
}

int fp3_fast_folds(const fp3_fast_plan *plan, uint32_t phase) {
    int are_folds = 1;
    for (uint32_t i = 0; i < plan->loop_count; i++)
        if (plan->loops[i].first >= plan->phase[phase] &&
            plan->loops[i].first < plan->phase[phase + 1])
            are_folds &= plan->loops[i].is_fold;
    return are_folds;
}

static void find_folds(fp3_fast_plan *plan) {
    for (uint32_t i = 0; i < plan->loop_count; i++) {
        uint32_t phase = 0;
        while (plan->phase[phase + 1] <= plan->loops[i].first)
            phase++;
        plan->loops[i].is_fold = are_folds(plan, &plan->loops[i], plan->phase[phase]);
    }
    for (uint32_t i = 0; i < plan->around.distinct; i++)
        plan->is_final |= fp3_fast_remembers(plan, i) && !fp3_fast_folds(plan, i);
}

/* The second pass of the step part begins with what the first part or a step left. */
static uint64_t find_origins(fp3_fast_plan *plan) {
    unsigned char from[FP3_BANK_OBJECT_COUNT], head[FP3_BANK_OBJECT_COUNT];
    uint64_t mixed = 0;
    for (int i = 0; i < FP3_BANK_OBJECT_COUNT; i++)
        from[i] = OF_HOST;
    follow_part(plan, FP3_PART_FIRST, from, &mixed);
    for (int i = 0; i < FP3_BANK_OBJECT_COUNT; i++)
        head[i] = from[i];
    follow_part(plan, FP3_PART_STEP, from, &mixed);
    for (int i = 0; i < FP3_BANK_OBJECT_COUNT; i++)
        from[i] |= head[i];
    follow_part(plan, FP3_PART_STEP, from, &mixed);
    /* Who fell asleep comes from anywhere. */
    for (int i = 0; plan->sleeps && i < FP3_BANK_OBJECT_COUNT; i++)
        from[i] = OF_HOST | (plan->written >> i & 1 ? OF_ADDER : 0);
    follow_part(plan, FP3_PART_LAST, from, &mixed);
    return mixed;
}

static void mark(fp3_fast_plan *plan) {
    const uint64_t mixed = find_origins(plan);
    const int all = plan->sleeps && !plan->config->interleave;
    for (uint32_t pc = 0; pc < plan->count; pc++) {
        fp3_fast_word *p = &plan->code[pc];
        if (is_kept(&p->in)) {
            p->is_one_nan &= !(mixed & bit(p->in.d));
            p->is_rounded =
                p->in.op == FP3_OP_ST && plan->config->storage && (int)p->in.d != plan->slept;
        }
        if (!is_arithmetic(&p->in) && !is_load(&p->in))
            continue;
        p->is_masked =
            plan->sleeps && pc < plan->part[FP3_PART_LAST].first && plan->live & bit(p->in.d);
        p->is_one_nan = is_arithmetic(&p->in) && (all || (mixed & bit(p->in.d)) || p->is_masked);
    }
}

/* ---- all ---- */

fp3_status fp3_fast_plan_make(const fp3_config *config, const fp3_code *code, uint64_t states,
                              const fp3_neighbourhood *around, fp3_fast_plan *plan,
                              fp3_error *error) {
    *plan = (fp3_fast_plan){.config = config,
                            .code = calloc(code->count ? code->count : 1, sizeof *plan->code),
                            .count = code->count,
                            .around = *around,
                            .slept = code->slept};
    plan->part[FP3_PART_FIRST].end = plan->part[FP3_PART_STEP].first = code->step;
    plan->part[FP3_PART_STEP].end = plan->part[FP3_PART_LAST].first = code->last;
    plan->part[FP3_PART_LAST].end = code->count;
    fp3_status status = plan->code ? decode(code, plan, error) : fp3_no_memory(error);
    if (!status && around->is_any)
        status = find_loops(code, plan, error);
    if (status) {
        fp3_fast_plan_free(plan);
        return status;
    }
    find_live(plan, states);
    if (around->is_any)
        find_folds(plan);
    mark(plan);
    return FP3_OK;
}

void fp3_fast_plan_free(fp3_fast_plan *plan) {
    free(plan->code);
    free(plan->loops);
    free(plan->phase);
    free(plan->order);
    *plan = (fp3_fast_plan){0};
}
