/* SPDX-License-Identifier: Apache-2.0 */
/* write_around.c - see write_around.h and, in place.h, fp3_fast_list.
 *
 * Registers of the vector are r5_0, those of turn s of the turns that are side by side r5_(s + 1),
 * what arithmetic there is given by the neighbour given_(s + 1). What turn s gives for word 7 of
 * the program is n7_s. Where some objects have no neighbour, another pair stands in, which raises
 * nothing that it does not raise anyway, and sums take -0, a least and a most nothing
 * (`takes_s`). What else a loop keeps stays as it was; there the pair may raise anything, which
 * counts as a hint (around.c).
 */
#include "write_around.h"

#include "place.h"
#include "text.h"

#include <fp3/isa.h>
#include <inttypes.h>

typedef fp3_writer writer;

static void declare(const writer *w) {
    const fp3_fast_plan *plan = w->plan;
    fprintf(w->to,
            "    const int *const table = p->table;\n    (void)table;\n"
            "    fp3_i lanes;\n    for (int i = 0; i < FP3_LANES; i++)\n        lanes[i] = i;\n");
    fp3_write_constants(w);
    FP3_EACH_REGISTER (plan->read, reg)
        fprintf(w->to,
                "    const fp3_loose *const o%" PRIu32 " = (const fp3_loose *)p->own[%" PRIu32
                "];\n    const float *const s%" PRIu32 " = p->seen[%" PRIu32
                "];\n    (void)o%" PRIu32 ";\n    (void)s%" PRIu32 ";\n",
                reg, reg, reg, reg, reg, reg);
    FP3_EACH_REGISTER (plan->stored, reg)
        fprintf(w->to, "    fp3_loose *const q%" PRIu32 " = (fp3_loose *)p->next[%" PRIu32 "];\n",
                reg, reg);
}

/* ---- what a turn gives ---- */

/* Turns side by side: of a list, as FP3_TURN_PLAIN, or any; of all others, objects that are none of
 * this vector, or any. */
typedef enum { PLAIN, LIST, ALL, ALL_BUT_ONE } kind;

/* Whether it is given to a register. */
static int is_loaded(const fp3_fast_word *p) {
    return p->in.op == FP3_OP_LDN || p->in.op == FP3_OP_LDL;
}

/* Whether a loop over its list writes fields. */
static int is_written(const writer *w, const fp3_fast_loop *l) {
    return w->plan->around.lists[l->list].kept != 0;
}

/* Words of a turn on the tape, if it is plain. */
static uint32_t stride(const writer *w, const fp3_fast_loop *l) {
    return FP3_TURN_HEAD + w->plan->around.lists[l->list].fields;
}

/* The words or fields of turn s, n7_s for word 7; how: the C that finds one, by the column's or the
 * field's number. */
static void take(const writer *w, const fp3_fast_loop *l, unsigned s, fp3_gives gives,
                 const char *how) {
    for (uint32_t pc = l->first; pc < l->end; pc++)
        if (w->plan->code[pc].gives == gives) {
            const uint32_t number = w->plan->code[pc].number;
            fprintf(w->to, "                n%" PRIu32 "_%u = (fp3_v)", pc, s);
            fprintf(w->to, how, number, number);
            fprintf(w->to, ";\n");
        }
}

/* Where a register's word is in a record. */
static uint32_t place_of(const writer *w, uint32_t reg) {
    return (uint32_t)__builtin_popcountll(w->plan->around.published & (((uint64_t)1 << reg) - 1));
}

static void take_from_records(const writer *w, const fp3_fast_loop *l, unsigned s) {
    uint64_t quads = 0;
    for (uint32_t pc = l->first; pc < l->end; pc++) {
        const fp3_fast_word *p = &w->plan->code[pc];
        if (p->gives != FP3_GIVES_WORD)
            continue;
        const uint32_t place = place_of(w, p->number);
        if (!(quads >> place / 4 & 1))
            fprintf(w->to,
                    "                fp3_v c%" PRIu32 "[4];\n"
                    "                fp3_gather(p->records + %" PRIu32 ", at, c%" PRIu32 ");\n",
                    place / 4, place / 4 * 4, place / 4);
        quads |= (uint64_t)1 << place / 4;
        fprintf(w->to, "                n%" PRIu32 "_%u = c%" PRIu32 "[%" PRIu32 "];\n", pc, s,
                place / 4, place % 4);
    }
}

static void take_from_list(const writer *w, const fp3_fast_loop *l, unsigned s) {
    const uint32_t count = w->plan->around.lists[l->list].fields;
    fprintf(w->to,
            "            {\n            const int base = at[0], others = at[1], kind = at[2];\n"
            "            at += FP3_TURN_HEAD;\n"
            "            takes_%u = fp3_takes(kind, lanes);\n"
            "            if (base >= 0) {\n",
            s);
    take(w, l, s, FP3_GIVES_WORD, "fp3_row((const int *)s%" PRIu32 " + base)");
    fprintf(w->to, "                if (others != base) {\n");
    for (uint32_t pc = l->first; pc < l->end; pc++)
        if (w->plan->code[pc].gives == FP3_GIVES_WORD)
            fprintf(w->to,
                    "                n%" PRIu32 "_%u = fp3_choose(takes_%u, n%" PRIu32
                    "_%u, (fp3_v)fp3_row((const int *)s%" PRIu32 " + others));\n",
                    pc, s, s, pc, s, w->plan->code[pc].number);
    fprintf(w->to, "                }\n            } else {\n");
    take_from_records(w, l, s);
    fprintf(w->to, "                at += FP3_LANES;\n            }\n");
    if (is_written(w, l)) {
        fprintf(w->to, "            entries_%u = at;\n", s);
        take(w, l, s, FP3_GIVES_FIELD, "fp3_entries(l->field, at, %" PRIu32 ")");
        fprintf(w->to, "            at += FP3_LANES;\n");
    } else if (count) {
        fprintf(w->to, "            if (kind & FP3_TURN_SAME) {\n");
        take(w, l, s, FP3_GIVES_FIELD, "fp3_all(at[%" PRIu32 "])");
        fprintf(w->to, "                at += %" PRIu32 ";\n            } else {\n", count);
        take(w, l, s, FP3_GIVES_FIELD, "fp3_row(at + %" PRIu32 " * FP3_LANES)");
        fprintf(w->to, "                at += %" PRIu32 " * FP3_LANES;\n            }\n", count);
    }
    fprintf(w->to, "            }\n");
}

/* Object t, for all but itself, for whom another one stands in; behind the last one nobody takes
 * it. Lanes behind the last object have what that one has. */
static void take_from_all(const writer *w, const fp3_fast_loop *l, unsigned s) {
    fprintf(
        w->to,
        "            {\n"
        "            const unsigned one = t < turns ? t : turns - 1, another = one ? one - 1 : 1;\n"
        "            const fp3_i own = ((lanes < last) & lanes) | (~(lanes < last) & last);\n"
        "            const fp3_i is_other = own != (int)(one - mine);\n");
    take(w, l, s, FP3_GIVES_WORD,
         "fp3_choose(is_other, (fp3_v)fp3_all(((const int *)s%" PRIu32
         ")[one]), (fp3_v)fp3_all(((const int *)s%" PRIu32 ")[another]))");
    fprintf(w->to,
            "            takes_%u = is_other & -(t < turns);\n            t++;\n            }\n",
            s);
}

/* What is there before the first word of turn s. */
static void begin(const writer *w, const fp3_fast_loop *l, unsigned s, kind of) {
    if (of == PLAIN || of == ALL)
        return;
    for (uint32_t pc = l->first; pc < l->end; pc++)
        if (w->plan->code[pc].gives != FP3_GIVES_NOTHING)
            fprintf(w->to, "            fp3_v n%" PRIu32 "_%u;\n", pc, s);
    fprintf(w->to, "            fp3_i takes_%u;\n", s);
    if (of == LIST && is_written(w, l))
        fprintf(w->to, "            const int *entries_%u;\n            (void)entries_%u;\n", s, s);
    if (of == ALL_BUT_ONE)
        take_from_all(w, l, s);
    else
        take_from_list(w, l, s);
}

/* A word that the neighbour or the link gives. Where the turn has it in a known place, it is read
 * here. */
static void give(const writer *w, const fp3_fast_loop *l, uint32_t pc, unsigned s, kind of) {
    const fp3_fast_word *p = &w->plan->code[pc];
    const uint32_t number = p->number;
    if (is_loaded(p))
        fprintf(w->to, "            r%" PRIu32 "_%u = ", p->in.d, s + 1);
    else
        fprintf(w->to, "            given_%u = ", s + 1);
    if (of == ALL)
        fprintf(w->to, "(fp3_v)fp3_all(((const int *)s%" PRIu32 ")[t + %u]);\n", number, s);
    else if (of != PLAIN)
        fprintf(w->to, "n%" PRIu32 "_%u;\n", pc, s);
    else if (p->gives == FP3_GIVES_WORD)
        fprintf(w->to, "(fp3_v)fp3_row((const int *)s%" PRIu32 " + at[%" PRIu32 "]);\n", number,
                s * stride(w, l));
    else
        fprintf(w->to, "(fp3_v)fp3_all(at[%" PRIu32 "]);\n",
                s * stride(w, l) + FP3_TURN_HEAD + number);
}

/* ---- turns side by side ---- */

static void copy(const writer *w, uint32_t reg, unsigned to, unsigned from) {
    fprintf(w->to, "            r%" PRIu32 "_%u = r%" PRIu32 "_%u;\n", reg, to, reg, from);
}

/* A turn on its way. */
typedef struct {
    uint32_t at;                           /* word */
    uint64_t taken;                        /* registers that it has from the turn before */
    uint32_t given[FP3_BANK_OBJECT_COUNT]; /* 1 + the word that gives a register, which nothing has
                                              read yet; or 0 */
} turn;

/* What a turn keeps and has not touched for the last time. */
static uint64_t left_by(const writer *w, const fp3_fast_loop *l, const turn *t) {
    uint64_t left = 0;
    for (uint32_t pc = t->at; pc < l->end; pc++)
        left |= fp3_fast_touched(&w->plan->code[pc]);
    return left & l->kept;
}

static void keep_as_it_was(const writer *w, uint32_t reg, unsigned s) {
    fprintf(w->to,
            "            r%" PRIu32 "_%u = fp3_choose(takes_%u, r%" PRIu32 "_%u, r%" PRIu32
            "_%u);\n",
            reg, s + 1, s, reg, s + 1, reg, s);
}

/* What is given is read where it is first needed, as it would else wait in a register; what is kept
 * at once. */
static void do_word(const writer *w, const fp3_fast_loop *l, turn *t, unsigned s, kind of) {
    const uint32_t pc = t->at++;
    const fp3_fast_word *p = &w->plan->code[pc];
    const uint64_t kept = fp3_fast_touched(p) & l->kept;
    char mask[16];
    if (is_loaded(p) && !(kept >> p->in.d & 1)) {
        t->given[p->in.d] = 1 + pc;
        return;
    }
    FP3_EACH_REGISTER (fp3_fast_touched(p), reg) {
        if (t->given[reg])
            give(w, l, t->given[reg] - 1, s, of);
        t->given[reg] = 0;
    }
    if (p->gives != FP3_GIVES_NOTHING)
        give(w, l, pc, s, of);
    if (p->in.op == FP3_OP_STL) {
        fprintf(w->to,
                "            fp3_remember(l->field, entries_%u, %" PRIu32
                ", takes_%u, (fp3_i)%sr%" PRIu32 "_%u%s);\n",
                s, p->number, s, p->is_one_nan ? "fp3_one_nan(" : "", p->in.d, s + 1,
                p->is_one_nan ? ")" : "");
        return;
    }
    FP3_EACH_REGISTER (is_loaded(p) ? 0 : kept & ~t->taken, reg)
        copy(w, reg, s + 1, s);
    t->taken |= kept;
    snprintf(mask, sizeof mask, "takes_%u", s);
    if (kept && l->is_fold && of != PLAIN && of != ALL)
        fp3_write_fold(w, p, s + 1, mask);
    else if (!is_loaded(p))
        fp3_write_arithmetic(w, p, s + 1);
    if (!l->is_fold && of != PLAIN && of != ALL)
        FP3_EACH_REGISTER (kept & ~left_by(w, l, t), reg)
            keep_as_it_was(w, reg, s);
}

/* A word of one turn and then of the next, as a turn waits for its own results more than for
 * anything else. What one leaves to the next (sums) is touched by the next when nothing of the one
 * before will touch it again. Registers of turn s are r5_(s + 1). */
static void body(const writer *w, const fp3_fast_loop *l, kind of) {
    const unsigned turns = FP3_TURNS_BESIDE;
    turn t[FP3_TURNS_BESIDE] = {0};
    uint64_t named = l->outside | l->kept;
    for (uint32_t pc = l->first; pc < l->end; pc++)
        named |= (uint64_t)1 << w->plan->code[pc].in.d;
    for (unsigned s = 0; s < turns; s++) {
        t[s].at = l->first;
        fprintf(w->to, "            fp3_v given_%u;\n            (void)given_%u;\n", s + 1, s + 1);
        FP3_EACH_REGISTER (named, reg)
            fprintf(w->to, "            fp3_v r%" PRIu32 "_%u;\n", reg, s + 1);
        FP3_EACH_REGISTER (l->outside, reg)
            fprintf(w->to, "            r%" PRIu32 "_%u = e%" PRIu32 ";\n", reg, s + 1, reg);
    }
    while (t[turns - 1].at < l->end)
        for (unsigned s = 0; s < turns; s++)
            if (t[s].at < l->end &&
                !(s && left_by(w, l, &t[s - 1]) & fp3_fast_touched(&w->plan->code[t[s].at])))
                do_word(w, l, &t[s], s, of);
    FP3_EACH_REGISTER (t[0].taken, reg)
        copy(w, reg, 0, turns);
}

static void turns(const writer *w, const fp3_fast_loop *l, kind of) {
    for (unsigned s = 0; s < FP3_TURNS_BESIDE; s++)
        begin(w, l, s, of);
    body(w, l, of);
    if (of == PLAIN)
        fprintf(w->to, "            at += %" PRIu32 ";\n", FP3_TURNS_BESIDE * stride(w, l));
    else if (of == ALL)
        fprintf(w->to, "            t += %d;\n", FP3_TURNS_BESIDE);
}

/* e5: register 5 as the loop finds it; for an object without any neighbour, as another one of the
 * vector has it. */
static void loop_over_list(const writer *w, const fp3_fast_loop *l) {
    fprintf(w->to, "        const int *at = l->tape + l->start[j];\n"
                   "        const int *const end = l->tape + l->start[j + 1];\n"
                   "        if (at < end && *at++) {\n"
                   "            const fp3_i from = fp3_row(at);\n"
                   "            at += FP3_LANES;\n            (void)from;\n");
    FP3_EACH_REGISTER (l->outside, reg)
        fprintf(w->to, "            e%" PRIu32 " = fp3_from(e%" PRIu32 ", from);\n", reg, reg);
    fprintf(w->to, "        }\n        while (at < end)\n");
    if (is_written(w, l)) { /* no turn is plain */
        fprintf(w->to, "            {\n");
        turns(w, l, LIST);
        fprintf(w->to, "            }\n");
        return;
    }
    fprintf(w->to, "            if (at[2] & FP3_TURN_PLAIN) {\n");
    turns(w, l, PLAIN);
    fprintf(w->to, "            } else {\n");
    turns(w, l, LIST);
    fprintf(w->to, "            }\n");
}

static void loop_over_all(const writer *w, const fp3_fast_loop *l) {
    fprintf(w->to,
            "        const unsigned mine = j * FP3_LANES;\n"
            "        const int last = (int)(l->objects - 1 - mine);\n"
            "        const unsigned turns = last || l->first ? l->end : mine; /* nothing but "
            "itself */\n"
            "        unsigned t = l->first;\n"
            "        while (t < turns)\n"
            "            if ((t + %d <= mine || t >= mine + FP3_LANES) && t + %d <= turns) {\n",
            FP3_TURNS_BESIDE, FP3_TURNS_BESIDE);
    turns(w, l, ALL);
    fprintf(w->to, "            } else {\n");
    turns(w, l, ALL_BUT_ONE);
    fprintf(w->to, "            }\n");
}

static void loop_around(const writer *w, const fp3_fast_loop *l) {
    fprintf(w->to,
            "        {\n        const fp3_fast_list *const l = &p->lists[%" PRIu32 "];\n"
            "        (void)l;\n",
            l->list);
    FP3_EACH_REGISTER (l->outside, reg)
        fprintf(w->to, "        fp3_v e%" PRIu32 " = r%" PRIu32 "_0;\n", reg, reg);
    fprintf(w->to, "        if (l->start) {\n");
    loop_over_list(w, l);
    fprintf(w->to, "        } else {\n");
    if (!w->plan->around.lists[l->list].fields)
        loop_over_all(w, l);
    fprintf(w->to, "        }\n        }\n");
    /* A sum that nothing reads behind the loop reads itself in it, and counts for its flags. */
    if (w->plan->config->flags)
        FP3_EACH_REGISTER (l->kept, reg)
            fp3_write_keep(w, reg, 0);
}

/* ---- a phase ---- */

static void load_own(const writer *w, uint32_t d) {
    fprintf(w->to, "        r%" PRIu32 "_0 = (fp3_v)o%" PRIu32 "[j - p->bias];\n", d, d);
}

static void store_next(const writer *w, const fp3_fast_word *p) {
    fprintf(w->to, "        q%" PRIu32 "[j - p->bias] = %sr%" PRIu32 "_0%s;\n", p->in.d,
            p->is_one_nan ? "fp3_one_nan(" : "", p->in.d, p->is_one_nan ? ")" : "");
    fp3_write_stored(w, p->in.d, 0);
}

static void phase(const writer *w, uint32_t number) {
    const fp3_fast_plan *plan = w->plan;
    uint32_t next = 0;
    fprintf(w->to,
            "    if (phase == %" PRIu32 ")\n    for (unsigned long j = first; j < end; j++) {\n",
            number);
    FP3_EACH_REGISTER (fp3_write_registers(plan), reg)
        fprintf(w->to, "        fp3_v r%" PRIu32 "_0;\n", reg);
    for (uint32_t pc = plan->phase[number]; pc < plan->phase[number + 1]; pc++) {
        const fp3_fast_word *p = &plan->code[pc];
        while (next < plan->loop_count && plan->loops[next].end < pc)
            next++;
        if (p->in.op == FP3_OP_LD)
            load_own(w, p->in.d);
        else if (p->in.op == FP3_OP_ST)
            store_next(w, p);
        else if (p->in.op == FP3_OP_EACH) {
            loop_around(w, &plan->loops[next]);
            pc = plan->loops[next].end;
        } else if (!p->ends_phase)
            fp3_write_arithmetic(w, p, 0);
    }
    fprintf(w->to, "    }\n");
}

/* Records of what neighbours read. */
static void publish(const writer *w) {
    const uint64_t published = w->plan->around.published;
    uint32_t words = 0;
    fprintf(w->to,
            "    if (phase == %" PRIu32 ")\n    for (unsigned long j = first; j < end; j++) {\n"
            "        fp3_v v[4] = {0};\n",
            w->plan->around.distinct);
    FP3_EACH_REGISTER (published, reg) {
        fprintf(w->to, "        v[%" PRIu32 "] = (fp3_v)o%" PRIu32 "[j - p->bias];\n", words % 4,
                reg);
        words++;
        if (words % 4 == 0 || reg == 63 - (uint32_t)__builtin_clzll(published))
            fprintf(w->to,
                    "        fp3_scatter(p->records + j * FP3_LANES * FP3_RECORD + %" PRIu32
                    ", v);\n",
                    (words - 1) / 4 * 4);
    }
    fprintf(w->to, "    }\n");
}

void fp3_write_phases(const writer *w) {
    fprintf(w->to, "#define FP3_RECORD %" PRIu32 "\n%s", fp3_fast_record(w->plan), fp3_text_turns);
    fprintf(w->to, "void " FP3_FAST_NAME
                   "(const fp3_fast_around *p, unsigned phase, unsigned first, unsigned end) {\n");
    declare(w);
    for (uint32_t i = 0; i < w->plan->around.distinct; i++)
        phase(w, i);
    publish(w);
    fprintf(w->to, "}\n");
}
