/* SPDX-License-Identifier: Apache-2.0 */
/* neighbours.c - see neighbours.h. */
#include "neighbours.h"

#include "operation.h"

#include <inttypes.h>

#define BIT(reg) (UINT64_C(1) << (reg))

/* A walk through the words of a program. */
typedef struct {
    const fp3_image *image;
    fp3_neighbourhood *found;
    fp3_error *error;
    uint32_t at;
    int loop;                        /* index of the `each` of the loop around, or -1 */
    uint32_t fields, loaded;         /* of an entry, as far as that loop says; its `ldl` so far */
    uint64_t kept;                   /* fields that this loop writes */
    uint64_t written;                /* registers of lists whose fields this phase has written */
    int has_stored;                  /* in this phase */
    uint32_t repeated, first;        /* how often phases are made; the first of them; 0: once */
    uint64_t stored;                 /* words that this phase stores */
    uint64_t stored_any, stored_all; /* by some phase; by all that have ended */
    uint64_t stored_last;            /* by the one that has ended last */
} walk;

static fp3_status refuse(const walk *w, const char *what) {
    return fp3_fail(w->error, FP3_E_PROGRAM, "code word %" PRIu32 ": %s", w->at, what);
}

static uint32_t op_at(const fp3_image *image, uint32_t at) {
    return image->decoded[at].of ? image->decoded[at].in.op : 0;
}

static fp3_gives gives_at(const fp3_image *image, uint32_t at) {
    return image->decoded[at].of ? image->decoded[at].of->gives : FP3_GIVES_NOTHING;
}

static int takes_field(const fp3_image *image, uint32_t at) {
    return image->decoded[at].of && image->decoded[at].of->takes_field;
}

static int is_of_neighbours(const fp3_image *image, uint32_t at) {
    const uint32_t op = op_at(image, at);
    return gives_at(image, at) != FP3_GIVES_NOTHING || takes_field(image, at) ||
           op == FP3_OP_EACH || op == FP3_OP_NEXT || fp3_ends_phase(&image->decoded[at]);
}

static fp3_status end_phase(walk *w) {
    w->stored_any |= w->stored;
    w->stored_all &= w->stored;
    w->stored_last = w->stored;
    w->stored = w->written = 0;
    w->has_stored = 0;
    w->found->distinct++;
    w->found->phases++;
    return FP3_OK;
}

static fp3_status begin_repetition(walk *w) {
    w->first = w->found->distinct;
    w->repeated = w->image->decoded[w->at].in.d;
    return w->repeated ? FP3_OK : refuse(w, "'repeat' has phases made at least once");
}

static fp3_status end_repetition(walk *w) {
    w->found->phases += (w->repeated - 1) * (w->found->distinct - w->first);
    w->repeated = 0;
    return FP3_OK;
}

/* A word that ends a phase, and may begin or end a repetition. */
static fp3_status visit_end(walk *w) {
    const uint32_t op = op_at(w->image, w->at);
    if (w->repeated && op == FP3_OP_REPEAT)
        return refuse(w, "a repetition ends, with 'again', before another begins");
    if (!w->repeated && op == FP3_OP_AGAIN)
        return refuse(w, "'again' ends a repetition, behind 'repeat'");
    const fp3_status status = end_phase(w);
    return status || op == FP3_OP_PHASE ? status
           : op == FP3_OP_REPEAT        ? begin_repetition(w)
                                        : end_repetition(w);
}

static fp3_status end_loop(walk *w) {
    fp3_neighbourhood *f = w->found;
    const uint32_t reg = w->image->decoded[w->loop].in.d;
    uint32_t i = 0;
    while (i < f->list_count && f->lists[i].reg != reg)
        i++;
    if (i < f->list_count && f->lists[i].fields != w->fields)
        return refuse(w, "two loops over one list read different numbers of fields");
    if (i == FP3_LISTS_MAX)
        return refuse(w, "a program has at most 8 lists of neighbours");
    if (i == f->list_count)
        f->lists[f->list_count++] = (fp3_list_shape){.reg = reg, .fields = w->fields};
    f->lists[i].kept |= w->kept;
    w->written |= w->kept ? BIT(reg) : 0;
    w->loop = -1;
    return FP3_OK;
}

static fp3_status count_field(walk *w, uint32_t number) {
    if (number >= FP3_FIELDS_MAX)
        return refuse(w, "an entry of a list has at most 64 fields");
    if (number >= w->fields)
        w->fields = number + 1;
    return FP3_OK;
}

/* An instruction that a neighbour gives something. */
static fp3_status visit_given(walk *w) {
    const fp3_decoded *word = &w->image->decoded[w->at];
    const uint32_t number =
        word->of->number ? fp3_operand(&word->in, word->of->number) : w->loaded++;
    if (w->loop < 0)
        return refuse(
            w, "instructions that read a neighbour, and 'next', belong in a loop, behind 'each'");
    if (word->of->gives == FP3_GIVES_WORD) {
        w->found->published |= BIT(number & (FP3_BANK_OBJECT_COUNT - 1));
        if (number >= FP3_BANK_SHARED_BASE)
            return refuse(w, "a word of a neighbour's record is read, not a shared constant");
        return w->has_stored ? refuse(w, "a phase loads all words before it stores any") : FP3_OK;
    }
    if (w->kept)
        return refuse(w, "a loop reads all fields of an entry before it writes any");
    return count_field(w, number);
}

/* An instruction that writes a field of the entry. */
static fp3_status visit_taken(walk *w) {
    const fp3_decoded *word = &w->image->decoded[w->at];
    const uint32_t number = fp3_operand(&word->in, word->of->number);
    if (w->loop < 0)
        return refuse(w, "'stl' belongs in a loop, behind 'each'");
    w->kept |= number < FP3_FIELDS_MAX ? BIT(number) : 0;
    return count_field(w, number);
}

static fp3_status visit_word(walk *w) {
    const fp3_image *image = w->image;
    const fp3_instruction *in = &image->decoded[w->at].in;
    const uint32_t op = op_at(image, w->at);
    if (gives_at(image, w->at) != FP3_GIVES_NOTHING)
        return visit_given(w);
    if (takes_field(image, w->at))
        return visit_taken(w);
    if (op == FP3_OP_EACH && w->written & BIT(in->d))
        return refuse(w, "a phase goes through a list before it writes its fields, not after");
    if (op == FP3_OP_SLEEP || op == FP3_OP_LDS)
        return refuse(w, "no object sleeps in a program with neighbours");
    if ((op == FP3_OP_EACH || fp3_ends_phase(&image->decoded[w->at])) && w->loop >= 0)
        return refuse(w, "a loop over neighbours ends before another, or a phase, begins or ends");
    if (op == FP3_OP_NEXT && w->loop < 0)
        return refuse(
            w, "instructions that read a neighbour, and 'next', belong in a loop, behind 'each'");
    if (op == FP3_OP_LD && w->has_stored)
        return refuse(w, "a phase loads all words before it stores any");
    if (op == FP3_OP_ST && w->loop >= 0)
        return refuse(w, "a loop over neighbours stores nothing");
    switch (op) {
    case FP3_OP_EACH:
        w->loop = (int)w->at;
        w->fields = w->loaded = 0;
        w->kept = 0;
        return FP3_OK;
    case FP3_OP_NEXT:
        return end_loop(w);
    case FP3_OP_PHASE:
    case FP3_OP_REPEAT:
    case FP3_OP_AGAIN:
        return visit_end(w);
    case FP3_OP_ST:
        w->stored |= BIT(in->d);
        w->has_stored = 1;
        return FP3_OK;
    default:
        return FP3_OK;
    }
}

static int uses_neighbours(const fp3_image *image) {
    for (uint32_t i = 0; i < image->code_count; i++)
        if (is_of_neighbours(image, i))
            return 1;
    return 0;
}

static uint64_t find_worst(const fp3_image *image) {
    uint64_t worst = 0;
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_WORST)
            worst |= BIT(image->symbols[i].index);
    return worst;
}

/* What the last phase stores is compared by nobody. */
static fp3_status check_worst(const walk *w) {
    const uint64_t worst = w->found->worst, wrong = worst & (~w->stored_any | w->stored_last);
    uint32_t reg = 0;
    while (wrong && !(wrong >> reg & 1))
        reg++;
    if (!wrong)
        return FP3_OK;
    return fp3_fail(w->error, FP3_E_PROGRAM,
                    "r%" PRIu32 " is a .worst, which all objects compare behind the phase that "
                    "stores it: expected a phase, and not the last one, that does",
                    reg);
}

/* The driver's own words. It has no image of the program that it makes of them. */
static fp3_status check_kept(walk *w) {
    for (w->at = 0; w->at < w->image->code_count; w->at++) {
        const fp3_operation *of = w->image->decoded[w->at].of;
        if (of && of->needs == FP3_KEY_KEEP)
            return refuse(w, "'keep', 'raise' and 'hold' are words that the driver of the hardware "
                             "adds to a program: an image has none");
    }
    return FP3_OK;
}

fp3_status fp3_neighbourhood_find(const fp3_image *image, fp3_neighbourhood *found,
                                  fp3_error *error) {
    walk w = {.image = image, .found = found, .error = error, .loop = -1, .stored_all = UINT64_MAX};
    fp3_status status = FP3_OK;
    *found = (fp3_neighbourhood){.is_any = uses_neighbours(image), .worst = find_worst(image)};
    status = check_kept(&w);
    if (status || !found->is_any)
        return status ? status : check_worst(&w);
    if (image->step != 0 || image->last != image->code_count)
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "a program with neighbours has a step part alone, no first and no last part");
    for (w.at = 0; !status && w.at < image->code_count; w.at++)
        status = visit_word(&w);
    if (!status && w.loop >= 0)
        status = refuse(&w, "the program ends within a loop over neighbours");
    if (!status && w.repeated)
        status = refuse(&w, "the program ends within a repetition, without 'again'");
    if (!status && op_at(image, image->code_count - 1) != FP3_OP_AGAIN)
        status = end_phase(&w);
    if (!status)
        status = check_worst(&w);
    if (status)
        return status;
    const uint64_t missed = found->published & w.stored_any & ~w.stored_all;
    uint32_t reg = 0;
    while (missed && !(missed >> reg & 1))
        reg++;
    if (missed)
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "word r%" PRIu32 " is read by neighbours: each phase stores it, or none does", reg);
    return FP3_OK;
}

uint64_t fp3_neighbourhood_compared(const fp3_neighbourhood *shape, const fp3_code *program,
                                    uint32_t begin) {
    uint64_t stored = 0;
    if (!shape->worst || !begin)
        return 0;
    for (uint32_t i = begin - 1; i-- > 0 && !fp3_ends_phase(&program->decoded[i]);)
        if (program->decoded[i].of && program->decoded[i].in.op == FP3_OP_ST)
            stored |= BIT(program->decoded[i].in.d);
    return stored & shape->worst;
}

uint32_t fp3_neighbourhood_end(const fp3_decoded *decoded, uint32_t each) {
    while (!decoded[each].of || decoded[each].in.op != FP3_OP_NEXT)
        each++;
    return each;
}

uint32_t fp3_neighbourhood_behind(const fp3_decoded *decoded, uint32_t at,
                                  fp3_repetition *repetition) {
    if (decoded[at].in.op == FP3_OP_REPEAT)
        *repetition = (fp3_repetition){at + 1, decoded[at].in.d};
    return decoded[at].in.op == FP3_OP_AGAIN && --repetition->left ? repetition->begin : at + 1;
}

int fp3_neighbourhood_phase(const fp3_code *program, uint32_t phase, uint32_t *first,
                            uint32_t *end) {
    fp3_repetition repetition = {0, 0};
    for (*first = 0;; *first = fp3_neighbourhood_behind(program->decoded, *end, &repetition)) {
        *end = *first;
        while (*end < program->count && !fp3_ends_phase(&program->decoded[*end]))
            (*end)++;
        if (!phase--)
            return *first < *end;
        if (*end >= program->count)
            return 0;
    }
}
