/* SPDX-License-Identifier: Apache-2.0 */
/* write.c - see write.h. */
#include "write.h"

#include "place.h"
#include "text.h"
#include "write_around.h"
#include "write_words.h"

#include <fp3/isa.h>
#include <inttypes.h>

typedef fp3_writer writer;

static void fall_asleep(const writer *w, const fp3_instruction *in, unsigned vector) {
    fprintf(w->to, "        {\n            const fp3_i now = awake_%u & fp3_sleeps(", vector);
    fp3_write_operand(w, in->a, vector);
    fprintf(w->to, ", ");
    fp3_write_operand(w, in->b, vector);
    fprintf(w->to,
            ");\n            r%" PRIu32
            "_%u = fp3_choose(now, (fp3_v)fp3_all((int)number), r%" PRIu32
            "_%u);\n            awake_%u &= ~now;\n        }\n",
            in->d, vector, in->d, vector, vector);
}

static void load(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const uint32_t d = p->in.d;
    fprintf(w->to, "        r%" PRIu32 "_%u = ", d, vector);
    if (p->is_masked)
        fprintf(w->to, "fp3_choose(awake_%u, (fp3_v)q%" PRIu32 "[j + %u], r%" PRIu32 "_%u);\n",
                vector, d, vector, d, vector);
    else
        fprintf(w->to, "(fp3_v)q%" PRIu32 "[j + %u];\n", d, vector);
}

static void store(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const uint32_t d = p->in.d;
    const int is_masked = w->plan->sleeps && w->part != FP3_PART_LAST;
    fprintf(w->to, "        q%" PRIu32 "[j + %u] = ", d, vector);
    if (is_masked)
        fprintf(w->to, "fp3_choose(awake_%u, ", vector);
    if (p->is_rounded)
        fprintf(w->to, "fp3_stored(%" PRIu32 ", ", w->plan->config->storage);
    fprintf(w->to, "%sr%" PRIu32 "_%u%s", p->is_one_nan ? "fp3_one_nan(" : "", d, vector,
            p->is_one_nan ? ")" : "");
    if (p->is_rounded)
        fprintf(w->to, ", fp3_draws(p->seed, objects[j + %u], %s, %" PRIu32 "))", vector,
                w->part == FP3_PART_FIRST ? "before" : "number", d);
    if (is_masked)
        fprintf(w->to, ", (fp3_v)q%" PRIu32 "[j + %u])", d, vector);
    fprintf(w->to, ";\n");
    fp3_write_stored(w, d, vector);
}

/* A row's vector. All rows are at a constant distance from `here`, so that the compiler needs one
 * address. */
static void element(const writer *w, uint32_t reg, unsigned vector) {
    fprintf(w->to, "here[%" PRIu32 " * (FP3_BLOCK / FP3_LANES) + %u]", reg, vector);
}

static void instruction(const writer *w, const fp3_fast_word *p, unsigned vector) {
    switch (p->in.op) {
    case FP3_OP_SLEEP:
        fall_asleep(w, &p->in, vector);
        break;
    case FP3_OP_LD:
    case FP3_OP_LDS:
        load(w, p, vector);
        break;
    case FP3_OP_ST:
        store(w, p, vector);
        break;
    default:
        fp3_write_arithmetic(w, p, vector);
    }
}

/* ---- a stretch of steps ---- */

/* A part, once for all vectors. */
static void part(writer *w, fp3_fast_part_number number) {
    const fp3_fast_part *part = &w->plan->part[number];
    w->part = number;
    for (uint32_t pc = part->first; pc < part->end; pc++)
        for (unsigned vector = 0; vector < w->beside; vector++)
            instruction(w, &w->plan->code[pc], vector);
}

static void load_rows(const writer *w, uint64_t set) {
    for (unsigned vector = 0; vector < w->beside; vector++)
        FP3_EACH_REGISTER (set, reg) {
            fprintf(w->to, "        r%" PRIu32 "_%u = ", reg, vector);
            element(w, reg, vector);
            fprintf(w->to, ";\n");
        }
}

static void keep_rows(const writer *w, uint64_t set) {
    for (unsigned vector = 0; vector < w->beside; vector++)
        FP3_EACH_REGISTER (set, reg) {
            fprintf(w->to, "        ");
            element(w, reg, vector);
            fprintf(w->to, " = r%" PRIu32 "_%u;\n", reg, vector);
        }
}

/* Vectors side by side through the whole stretch: from step to step they are in variables. */
static void body(writer *w) {
    const fp3_fast_plan *plan = w->plan;
    const uint64_t written = plan->part[FP3_PART_FIRST].written | plan->part[FP3_PART_STEP].written;
    for (unsigned vector = 0; vector < w->beside; vector++) {
        FP3_EACH_REGISTER (fp3_write_registers(plan), reg)
            fprintf(w->to, "        fp3_v r%" PRIu32 "_%u;\n", reg, vector);
        if (plan->sleeps)
            fprintf(w->to, "        fp3_i awake_%u = awake[j + %u];\n", vector, vector);
    }
    fprintf(w->to, "        if (parts & FP3_BEGINS) {\n");
    load_rows(w, plan->entered);
    part(w, FP3_PART_FIRST);
    fprintf(w->to, "        } else {\n");
    load_rows(w, plan->live);
    fprintf(w->to, "        }\n"
                   "        unsigned number = before;\n"
                   "        for (unsigned i = 0; i < steps; i++) {\n        number++;\n");
    part(w, FP3_PART_STEP);
    fprintf(w->to, "        }\n        if (parts & FP3_ENDS) {\n");
    part(w, FP3_PART_LAST);
    keep_rows(w, (written | plan->part[FP3_PART_LAST].written) & plan->left);
    fprintf(w->to, "        } else {\n");
    keep_rows(w, written & plan->live);
    fprintf(w->to, "        }\n");
    for (unsigned vector = 0; plan->sleeps && vector < w->beside; vector++)
        fprintf(w->to, "        awake[j + %u] = awake_%u;\n", vector, vector);
}

static void declare(const writer *w) {
    const fp3_fast_plan *plan = w->plan;
    fprintf(w->to,
            "    const int *const table = p->table;\n    (void)table;\n"
            "    fp3_i *const awake = (fp3_i *)p->awake;\n    (void)awake;\n"
            "    const fp3_i *const objects = (const fp3_i *)p->objects;\n    (void)objects;\n");
    FP3_EACH_REGISTER (plan->read | plan->stored, reg)
        fprintf(w->to,
                "    fp3_loose *const q%" PRIu32 " = (fp3_loose *)p->records[%" PRIu32
                "];\n    (void)q%" PRIu32 ";\n",
                reg, reg, reg);
    fp3_write_constants(w);
}

static void loop(writer *w, unsigned beside) {
    w->beside = beside;
    fprintf(w->to,
            "    for (; j + %u <= p->vectors; j += %u) {\n"
            "        fp3_v *const here = (fp3_v *)p->rows + j;\n        (void)here;\n",
            beside, beside);
    body(w);
    fprintf(w->to, "    }\n");
}

/* Short programs leave the units idle unless many vectors are on the way. Long ones spill, but two
 * chains of results wait for each other less than one: more than two take the compiler too long. */
static unsigned beside_of(const fp3_fast_plan *plan) {
    const uint32_t count = plan->part[FP3_PART_STEP].end - plan->part[FP3_PART_STEP].first;
    return count <= 40 ? 8 : count <= 250 ? 4 : 2;
}

static void stretch(writer *w) {
    fprintf(w->to,
            "void " FP3_FAST_NAME
            "(const fp3_fast_place *p, unsigned parts, unsigned steps, unsigned before) {\n");
    declare(w);
    fprintf(w->to, "    unsigned long j = 0;\n");
    /* Those that are left over in fours, pairs, alone: a step takes as long for one vector as for
     * four. */
    for (unsigned beside = beside_of(w->plan); beside; beside /= 2)
        loop(w, beside);
    fprintf(w->to, "}\n");
}

fp3_status fp3_fast_write(const fp3_fast_plan *plan, FILE *to, fp3_error *error) {
    writer w = {.plan = plan, .to = to};
    fprintf(to,
            "#define FP3_NEAREST %d\n#define FP3_SUBNORMAL %d\n#define FP3_FINITE %d\n"
            "#define FP3_FLAGS %d\n%s%s%s%s",
            plan->config->nearest != 0, plan->config->subnormal != 0, plan->config->finite != 0,
            plan->config->flags != 0, fp3_text_place, fp3_text_lanes,
            plan->config->fused ? fp3_text_fused : "",
            plan->config->storage ? fp3_text_halves : "");
    if (plan->around.is_any && plan->is_final)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "pairs remember, and a loop over neighbours keeps more than sums, a least "
                        "and a most");
    if (plan->around.is_any)
        fp3_write_phases(&w);
    else
        stretch(&w);
    return ferror(to) ? fp3_fail(error, FP3_E_SYSTEM, "the program's C could not be written")
                      : FP3_OK;
}
