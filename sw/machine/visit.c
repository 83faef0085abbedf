/* SPDX-License-Identifier: Apache-2.0 */
/* visit.c - which registers a visit loads and stores, and the code with both. */
#include "visit.h"

#include <stdlib.h>
#include <string.h>

#include <fp3/isa.h>

_Static_assert(FP3_BANK_OBJECT_BASE == 0 && FP3_BANK_OBJECT_COUNT == 64,
               "a set of object registers is the bits of a uint64_t");

#define BIT(reg) (UINT64_C(1) << (reg))

typedef struct {
    uint32_t op;
    uint64_t reads, writes; /* object registers; sleep may write, or not */
} effect;

/* An illegal word has no effect: it ends the run. What a neighbour gives is in no register. */
static effect effect_of(const fp3_decoded *word) {
    effect e = {.op = word->in.op};
    for (const char *letter = word->of ? word->of->operands : ""; *letter; letter++) {
        const uint32_t operand = fp3_operand(&word->in, *letter);
        if (*letter == 'd' && word->of->writes != FP3_WRITES_NEVER)
            e.writes = BIT(operand);
        else if (operand < FP3_BANK_SHARED_BASE && *letter != word->of->number)
            e.reads |= BIT(operand);
    }
    return e;
}

/* What is read before it is written, from begin on, if after is read after end. An object that
 * falls asleep leaves the part at once, for where asleep is read. */
static uint64_t live(const fp3_image *image, uint32_t begin, uint32_t end, uint64_t after,
                     uint64_t asleep) {
    for (uint32_t i = end; i-- > begin;) {
        const effect e = effect_of(&image->decoded[i]);
        after = e.op == FP3_OP_SLEEP ? after | asleep : after & ~e.writes;
        after |= e.reads;
    }
    return after;
}

/* What the whole program reads before it writes it, if stored is read after its end. */
static uint64_t live_in(const fp3_image *image, uint64_t stored) {
    const uint64_t last = live(image, image->last, image->code_count, stored, 0);
    /* What another step reads first, this one reads, too, or writes: one pass is enough. */
    const uint64_t step = live(image, image->step, image->last, last, last);
    return live(image, 0, image->step, step, last);
}

static uint64_t named(const fp3_image *image, unsigned classes) {
    uint64_t found = 0;
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (FP3_CLASS(image->symbols[i].symbol_class) & classes & FP3_CLASSES_OBJECT)
            found |= BIT(image->symbols[i].index);
    return found;
}

/* An image with loads or stores of its own: what they move. 0 if it has none. */
static int has_own(const fp3_image *image, fp3_visit *v) {
    int found = 0;
    for (uint32_t i = 0; i < image->code_count; i++) {
        const effect e = effect_of(&image->decoded[i]);
        if (e.op == FP3_OP_LD || e.op == FP3_OP_LDS)
            v->loaded |= e.writes;
        else if (e.op == FP3_OP_ST)
            v->stored |= e.reads;
        else
            continue;
        found = 1;
    }
    return found;
}

/* A .temp is stored only where it is no .temp in truth: something reads what an earlier visit left.
 * All other written registers are stored, because the host or another reader may need them. That
 * holds for the register of sleep, which is no .temp. */
static void choose(const fp3_image *image, fp3_visit *v) {
    const uint64_t slept = v->slept < 0 ? 0 : BIT(v->slept);
    uint64_t written = 0;
    for (uint32_t i = 0; i < image->code_count; i++)
        written |= effect_of(&image->decoded[i]).writes;
    const uint64_t outside = written & ~named(image, FP3_CLASS(FP3_SYMBOL_TEMP));
    v->loaded = live_in(image, outside) | slept;
    v->stored = outside | (v->loaded & written);
}

/* Words of a record that neighbours read. */
static uint64_t read_by_others(const fp3_image *image) {
    uint64_t found = 0;
    for (uint32_t i = 0; i < image->code_count; i++) {
        const fp3_decoded *word = &image->decoded[i];
        if (word->of && word->of->gives == FP3_GIVES_WORD)
            found |= BIT(fp3_operand(&word->in, word->of->number) & (FP3_BANK_OBJECT_COUNT - 1));
    }
    return found;
}

static uint32_t lowest(uint64_t set) {
    uint32_t reg = 0;
    while (reg < FP3_BANK_OBJECT_COUNT - 1 && !(set & BIT(reg)))
        reg++;
    return reg;
}

static uint32_t count(uint64_t set) {
    uint32_t bits = 0;
    for (; set; set &= set - 1)
        bits++;
    return bits;
}

static uint32_t put(fp3_visit *v, uint32_t at, uint32_t op, uint64_t set) {
    for (uint32_t reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (set & BIT(reg)) {
            v->decoded[at] = (fp3_decoded){fp3_operation_find(op), {.op = op, .d = reg}};
            v->code[at] = fp3_word_encode(&v->decoded[at].in);
            at++;
        }
    return at;
}

static fp3_status write_code(const fp3_image *image, fp3_visit *v, uint64_t in_front,
                             uint64_t behind, fp3_error *error) {
    v->loads_in_front = count(in_front);
    v->stores_behind = count(behind);
    v->code_count = v->loads_in_front + image->code_count + v->stores_behind;
    v->step = v->loads_in_front + image->step;
    v->last = v->loads_in_front + image->last;
    if (v->code_count > FP3_IMAGE_CODE_LIMIT)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "%u code words, with %u loads and %u stores of the object; %u are possible",
                        v->code_count, v->loads_in_front, v->stores_behind, FP3_IMAGE_CODE_LIMIT);
    v->code = malloc(v->code_count * sizeof *v->code);
    v->decoded = malloc(v->code_count * sizeof *v->decoded);
    if (!v->code || !v->decoded)
        return fp3_no_memory(error);
    /* lds comes first: of an object that sleeps nothing else is loaded. */
    const uint64_t slept = v->slept < 0 ? 0 : in_front & BIT(v->slept);
    const uint32_t at = put(v, put(v, 0, FP3_OP_LDS, slept), FP3_OP_LD, in_front & ~slept);
    memcpy(v->code + at, image->code, image->code_count * sizeof *v->code);
    memcpy(v->decoded + at, image->decoded, image->code_count * sizeof *v->decoded);
    put(v, at + image->code_count, FP3_OP_ST, behind);
    return FP3_OK;
}

fp3_status fp3_visit_make(const fp3_image *image, fp3_visit **visit, fp3_error *error) {
    *visit = NULL;
    fp3_visit *v = calloc(1, sizeof *v);
    if (!v)
        return fp3_no_memory(error);
    v->slept = fp3_image_slept(image);
    const int own = has_own(image, v);
    if (!own)
        choose(image, v);
    v->kept = v->loaded | v->stored | named(image, FP3_CLASSES_HOST);
    if (v->slept >= 0)
        v->kept |= BIT(v->slept);
    v->kept |= read_by_others(image);
    while (v->kept >> (BIT(v->log2) - 1) >> 1)
        v->log2++;
    /* A visit has a load and a store at least. A store that nothing asks for stores what was
     * loaded: the record stays as it is. */
    if (!own && !v->loaded)
        v->loaded = BIT(0);
    if (!own && !v->stored)
        v->stored = BIT(lowest(v->loaded));
    fp3_status status = write_code(image, v, own ? 0 : v->loaded, own ? 0 : v->stored, error);
    if (status)
        fp3_visit_free(&v);
    *visit = v;
    return status;
}

void fp3_visit_free(fp3_visit **visit) {
    if (!visit || !*visit)
        return;
    free((*visit)->code);
    free((*visit)->decoded);
    free(*visit);
    *visit = NULL;
}
