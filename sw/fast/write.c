/* write.c - see write.h. */
#include "write.h"

#include "text.h"

#include <fp3/isa.h>
#include <inttypes.h>

typedef struct {
    const fp3_fast_plan *plan;
    FILE *to;
    fp3_fast_part_number part;
    unsigned beside; /* vectors */
} writer;

/* ---- names ---- */

/* r5_2: register 5 of the vector 2 of those side by side; k3: a shared constant. */
static void operand(const writer *w, uint32_t number, unsigned vector) {
    if (number >= FP3_BANK_SHARED_BASE)
        fprintf(w->to, "k%" PRIu32, number - FP3_BANK_SHARED_BASE);
    else
        fprintf(w->to, "r%" PRIu32 "_%u", number, vector);
}

/* ---- an instruction ---- */

static int compares(uint32_t op) {
    return op == FP3_OP_MIN || op == FP3_OP_MAX || op == FP3_OP_LT || op == FP3_OP_LE;
}

static void value(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const fp3_instruction *in = &p->in;
    const fp3_operation *of = fp3_operation_find(in->op);
    fprintf(w->to, "fp3_%s%s(", of->name, p->is_behind && compares(in->op) ? "_raw" : "");
    for (uint32_t i = 0; i < of->sources; i++) {
        fprintf(w->to, i ? ", " : "");
        operand(w, fp3_operand(in, "abc"[i]), vector);
    }
    fprintf(w->to, in->op == FP3_OP_RCP || in->op == FP3_OP_RSQRT ? ", table)" : ")");
}

/* The results of what has flags alone must be computed all the same. */
static void arithmetic(const writer *w, const fp3_fast_word *p, unsigned vector) {
    const int is_masked = p->is_masked;
    if (p->is_dead && !w->plan->config->flags)
        return;
    fprintf(w->to, "        r%" PRIu32 "_%u = ", p->in.d, vector);
    if (is_masked)
        fprintf(w->to, "fp3_choose(awake_%u, ", vector);
    fprintf(w->to, "%s%s", p->is_one_nan ? "fp3_one_nan(" : "", p->is_behind ? "fp3_behind(" : "");
    value(w, p, vector);
    fprintf(w->to, "%s%s", p->is_behind ? ")" : "", p->is_one_nan ? ")" : "");
    if (is_masked)
        fprintf(w->to, ", r%" PRIu32 "_%u)", p->in.d, vector);
    fprintf(w->to, ";\n");
    if (p->is_dead)
        fprintf(w->to, "        __asm__ volatile(\"\" : : \"x\"(r%" PRIu32 "_%u));\n", p->in.d,
                vector);
}

static void fall_asleep(const writer *w, const fp3_instruction *in, unsigned vector) {
    fprintf(w->to, "        {\n            const fp3_i now = awake_%u & fp3_sleeps(", vector);
    operand(w, in->a, vector);
    fprintf(w->to, ", ");
    operand(w, in->b, vector);
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
    fprintf(w->to, "%sr%" PRIu32 "_%u%s", p->is_one_nan ? "fp3_one_nan(" : "", d, vector,
            p->is_one_nan ? ")" : "");
    if (is_masked)
        fprintf(w->to, ", (fp3_v)q%" PRIu32 "[j + %u])", d, vector);
    fprintf(w->to, ";\n");
}

/* A row's vector. All rows are at a constant distance from `here`, so that the compiler needs one address. */
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
        arithmetic(w, p, vector);
    }
}

/* ---- a stretch of steps ---- */

/* All registers that the program names. */
static uint64_t registers_of(const fp3_fast_plan *plan) {
    uint64_t set = plan->entered | plan->live;
    for (uint32_t pc = 0; pc < plan->count; pc++) {
        const fp3_instruction *in = &plan->code[pc].in;
        set |= (uint64_t)1 << in->d;
        for (uint32_t i = 0; in->op != FP3_OP_LDN && i < fp3_operation_find(in->op)->sources; i++)
            if (fp3_operand(in, "abc"[i]) < FP3_BANK_SHARED_BASE)
                set |= (uint64_t)1 << fp3_operand(in, "abc"[i]);
    }
    return set;
}

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
        FP3_EACH_REGISTER (registers_of(plan), reg)
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
    fprintf(w->to, "    const int *const table = p->table;\n    (void)table;\n"
                   "    fp3_i *const awake = (fp3_i *)p->awake;\n    (void)awake;\n");
    FP3_EACH_REGISTER (plan->read | plan->stored, reg)
        fprintf(w->to,
                "    fp3_loose *const q%" PRIu32 " = (fp3_loose *)p->records[%" PRIu32
                "];\n    (void)q%" PRIu32 ";\n",
                reg, reg, reg);
    FP3_EACH_REGISTER (plan->constants, k)
        fprintf(w->to,
                "    const fp3_v k%" PRIu32 " = (fp3_v)fp3_all(p->constants[%" PRIu32
                "]);\n    (void)k%" PRIu32 ";\n",
                k, k, k);
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

/* Short programs leave the units idle unless many vectors are on the way. Long ones spill, but two chains of results wait for
 * each other less than one: more than two take the compiler too long. */
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
    /* Those that are left over in fours, pairs, alone: a step takes as long for one vector as for four. */
    for (unsigned beside = beside_of(w->plan); beside; beside /= 2)
        loop(w, beside);
    fprintf(w->to, "}\n");
}

/* ---- phases, with neighbours ---- */

/* Registers of the vector are r5_0. Within a loop they are r5_1: where an object has no neighbour, another of the vector
 * stands in for it with all that it has. */
enum { OUTSIDE = 0, WITHIN = 1 };

static void declare_around(const writer *w) {
    const fp3_fast_plan *plan = w->plan;
    fprintf(w->to,
            "    const int *const table = p->table;\n    (void)table;\n"
            "    fp3_i lanes;\n    for (int i = 0; i < FP3_LANES; i++)\n        lanes[i] = i;\n");
    FP3_EACH_REGISTER (plan->constants, k)
        fprintf(w->to,
                "    const fp3_v k%" PRIu32 " = (fp3_v)fp3_all(p->constants[%" PRIu32
                "]);\n    (void)k%" PRIu32 ";\n",
                k, k, k);
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

static void of_neighbour(const writer *w, const fp3_instruction *in) {
    if (in->op == FP3_OP_LDN)
        fprintf(w->to, "            r%" PRIu32 "_1 = fp3_seen(s%" PRIu32 ", base, other, t);\n",
                in->d, in->a);
    else
        fprintf(w->to, "            r%" PRIu32 "_1 = *field++;\n", in->d);
}

/* A word of neighbours that stand side by side, anywhere, or are one and the same. */
static const char look[] =
    "enum { FP3_ANYWHERE = -1, FP3_ONE_OBJECT = -2 };\n"
    "FP3_OPERATION fp3_v fp3_seen(const float *seen, int base, fp3_i other, unsigned t) {\n"
    "    if (base >= 0)\n        return (fp3_v)*(const fp3_loose *)(seen + base);\n"
    "    if (base == FP3_ONE_OBJECT)\n        return (fp3_v)fp3_all(((const int *)seen)[t]);\n"
    "    return (fp3_v)fp3_entry((const int *)seen, other);\n}\n";

/* What a turn is: of a list, or object t for all but itself. Lanes behind the last object have what that one has. */
static const char turn[] =
    "            int base = FP3_ONE_OBJECT, is_full = t / FP3_LANES != j;\n"
    "            fp3_i other = lanes, from = lanes;\n"
    "            const fp3_v *field = (const fp3_v *)l->field + (unsigned long)t * l->fields;\n"
    "            (void)base, (void)other, (void)field;\n"
    "            if (l->turn) {\n"
    "                base = l->base[t], is_full = l->is_full[t];\n"
    "                other = ((const fp3_i *)l->other)[t], from = ((const fp3_i *)l->from)[t];\n"
    "            } else if (!is_full) {\n"
    "                const int last = (int)(l->objects - 1 - j * FP3_LANES), me = (int)(t % "
    "FP3_LANES);\n"
    "                const fp3_i own = ((lanes < last) & lanes) | (~(lanes < last) & last);\n"
    "                if (last == 0)\n                    continue;\n"
    "                from = ((own == me) & (me == 0)) | (~(own == me) & lanes);\n"
    "            }\n";

static void loop_around(const writer *w, const fp3_fast_loop *l) {
    const fp3_fast_plan *plan = w->plan;
    uint64_t named = l->outside | l->kept;
    for (uint32_t pc = l->first; pc < l->end; pc++)
        named |= (uint64_t)1 << plan->code[pc].in.d;
    fprintf(w->to,
            "        {\n        const fp3_fast_list *const l = &p->lists[%" PRIu32 "];\n"
            "        const unsigned turns = l->turn ? l->turn[j + 1] : l->objects;\n"
            "        for (unsigned t = l->turn ? l->turn[j] : 0; t < turns; t++) {\n%s",
            l->list, turn);
    FP3_EACH_REGISTER (named, reg)
        fprintf(w->to,
                (l->outside | l->kept) >> reg & 1 ? "            fp3_v r%" PRIu32 "_1 = r%" PRIu32
                                                    "_0;\n"
                                                  : "            fp3_v r%" PRIu32 "_1;\n",
                reg, reg);
    fprintf(w->to, "            if (!is_full) {\n");
    FP3_EACH_REGISTER (l->outside | l->kept, reg)
        fprintf(w->to, "                r%" PRIu32 "_1 = fp3_from(r%" PRIu32 "_0, from);\n", reg,
                reg);
    fprintf(w->to, "            }\n");
    for (uint32_t pc = l->first; pc < l->end; pc++) {
        const fp3_fast_word *p = &plan->code[pc];
        if (p->in.op == FP3_OP_LDN || p->in.op == FP3_OP_LDL)
            of_neighbour(w, &p->in);
        else
            arithmetic(w, p, WITHIN);
    }
    FP3_EACH_REGISTER (l->kept, reg)
        fprintf(w->to,
                "            r%" PRIu32 "_0 = is_full ? r%" PRIu32
                "_1 : fp3_choose(from == lanes, r%" PRIu32 "_1, r%" PRIu32 "_0);\n",
                reg, reg, reg, reg);
    fprintf(w->to, "        }\n        }\n");
}

static void load_own(const writer *w, uint32_t d) {
    fprintf(w->to, "        r%" PRIu32 "_0 = (fp3_v)o%" PRIu32 "[j - p->bias];\n", d, d);
}

static void store_next(const writer *w, const fp3_fast_word *p) {
    fprintf(w->to, "        q%" PRIu32 "[j - p->bias] = %sr%" PRIu32 "_0%s;\n", p->in.d,
            p->is_one_nan ? "fp3_one_nan(" : "", p->in.d, p->is_one_nan ? ")" : "");
}

static void phase(const writer *w, uint32_t number) {
    const fp3_fast_plan *plan = w->plan;
    uint32_t next = 0;
    fprintf(w->to,
            "    if (phase == %" PRIu32 ")\n    for (unsigned long j = first; j < end; j++) {\n",
            number);
    FP3_EACH_REGISTER (registers_of(plan), reg)
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
        } else if (p->in.op != FP3_OP_PHASE)
            arithmetic(w, p, OUTSIDE);
    }
    fprintf(w->to, "    }\n");
}

static void phases(const writer *w) {
    fprintf(w->to, "%s", look);
    fprintf(w->to, "void " FP3_FAST_NAME
                   "(const fp3_fast_around *p, unsigned phase, unsigned first, unsigned end) {\n");
    declare_around(w);
    for (uint32_t i = 0; i < w->plan->around.phases; i++)
        phase(w, i);
    fprintf(w->to, "}\n");
}

fp3_status fp3_fast_write(const fp3_fast_plan *plan, FILE *to, fp3_error *error) {
    writer w = {.plan = plan, .to = to};
    fprintf(to, "#define FP3_NEAREST %d\n#define FP3_SUBNORMAL %d\n#define FP3_FLAGS %d\n%s%s",
            plan->config->nearest != 0, plan->config->subnormal != 0, plan->config->flags != 0,
            fp3_text_place, fp3_text_lanes);
    if (plan->around.is_any)
        phases(&w);
    else
        stretch(&w);
    return ferror(to) ? fp3_fail(error, FP3_E_SYSTEM, "the program's C could not be written")
                      : FP3_OK;
}
