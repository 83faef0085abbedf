/* SPDX-License-Identifier: Apache-2.0 */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "neighbours.h"
#include "operation.h"
#include <fp3/isa.h>

/* Names. */

const char *fp3_class_name(fp3_symbol_class symbol_class) {
    static const char *const names[] = {"state", "param", "temp", "shared",
                                        "const", "label", "worst"};
    return symbol_class < FP3_SYMBOL_CLASSES ? names[symbol_class] : "?";
}

const char *fp3_name_expected(const char *name, fp3_symbol_class symbol_class) {
    const unsigned classes = FP3_CLASS(symbol_class) & FP3_CLASSES_HOST;
    if (!strcmp(name, FP3_NAME_STEP) && classes & ~FP3_CLASS(FP3_SYMBOL_SHARED))
        return "another name ('h' is the time step, a .shared: all objects have the same)";
    if (!strcmp(name, FP3_NAME_STEPS) && classes & ~FP3_CLASS(FP3_SYMBOL_STATE))
        return "another name ('steps' is how many steps an object has made, a .state)";
    return NULL;
}

int fp3_class_is_object(fp3_symbol_class symbol_class) {
    return (FP3_CLASS(symbol_class) & FP3_CLASSES_OBJECT) != 0;
}

const fp3_symbol *fp3_image_find(const fp3_image *image, const char *name, unsigned classes) {
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (!strcmp(image->symbols[i].name, name))
            return FP3_CLASS(image->symbols[i].symbol_class) & classes ? &image->symbols[i] : NULL;
    return NULL;
}

const char *fp3_image_name(const fp3_image *image, uint32_t operand) {
    int object = operand < FP3_BANK_SHARED_BASE;
    uint32_t index = object ? operand - FP3_BANK_OBJECT_BASE : operand - FP3_BANK_SHARED_BASE;
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        if (symbol->index == index && symbol->symbol_class != FP3_SYMBOL_LABEL &&
            fp3_class_is_object(symbol->symbol_class) == object)
            return symbol->name;
    }
    return NULL;
}

const uint32_t *fp3_image_value(const fp3_image *image, uint32_t index) {
    for (uint32_t i = 0; i < image->constant_count; i++)
        if (image->constants[i].index == index)
            return &image->constants[i].bits;
    return NULL;
}

static int find_state(const fp3_image *image, const char *name) {
    const fp3_symbol *s = fp3_image_find(image, name, FP3_CLASS(FP3_SYMBOL_STATE));
    return s ? (int)s->index : -1;
}

int fp3_image_steps(const fp3_image *image) { return find_state(image, FP3_NAME_STEPS); }

int fp3_image_rest(const fp3_image *image) { return find_state(image, FP3_NAME_REST); }

int fp3_image_removed(const fp3_image *image) { return find_state(image, FP3_NAME_REMOVED); }

static int names_slept(const fp3_decoded *word) {
    return word->of && (word->in.op == FP3_OP_SLEEP || word->in.op == FP3_OP_LDS);
}

int fp3_image_slept(const fp3_image *image) {
    for (uint32_t i = 0; i < image->code_count; i++)
        if (names_slept(&image->decoded[i]))
            return (int)image->decoded[i].in.d;
    return -1;
}

/* Images. */

static int by_index(const void *left, const void *right) {
    const fp3_constant *a = left, *b = right;
    return (a->index > b->index) - (a->index < b->index);
}

/* Total, so that an image has one form only: labels of one place go by their names. */
static int by_class(const void *left, const void *right) {
    const fp3_symbol *a = left, *b = right;
    if (a->symbol_class != b->symbol_class)
        return a->symbol_class < b->symbol_class ? -1 : 1;
    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return strcmp(a->name, b->name);
}

static int by_name(const void *left, const void *right) {
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

static fp3_status check_names(const fp3_image *image, fp3_error *error) {
    if (image->symbol_count < 2)
        return FP3_OK;
    const char **names = malloc(image->symbol_count * sizeof *names);
    if (!names)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < image->symbol_count; i++)
        names[i] = image->symbols[i].name;
    qsort(names, image->symbol_count, sizeof *names, by_name);
    fp3_status status = FP3_OK;
    for (uint32_t i = 1; !status && i < image->symbol_count; i++)
        if (!strcmp(names[i - 1], names[i]))
            status =
                fp3_fail(error, FP3_E_PROGRAM, "the name '%s' stands for two things", names[i]);
    free(names);
    return status;
}

static fp3_status check_symbols(const fp3_image *image, fp3_error *error) {
    const char *object[FP3_BANK_OBJECT_COUNT] = {0}, *shared[FP3_BANK_SHARED_COUNT] = {0};
    char valued[FP3_BANK_SHARED_COUNT] = {0};
    for (uint32_t i = 0; i < image->constant_count; i++) {
        uint32_t index = image->constants[i].index;
        if (index >= FP3_BANK_SHARED_COUNT)
            return fp3_fail(error, FP3_E_PROGRAM, "value %u is for shared constant %u of %d", i,
                            index, FP3_BANK_SHARED_COUNT);
        if (valued[index])
            return fp3_fail(error, FP3_E_PROGRAM, "shared constant %u has two values", index);
        valued[index] = 1;
    }
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        if (symbol->symbol_class >= FP3_SYMBOL_CLASSES)
            return fp3_fail(error, FP3_E_PROGRAM, "symbol %u is of the unknown class %u", i,
                            (unsigned)symbol->symbol_class);
        if (!memchr(symbol->name, 0, FP3_NAME_SIZE) || !fp3_name_valid(symbol->name))
            return fp3_fail(error, FP3_E_PROGRAM, "symbol %u has '%.*s' for a name", i,
                            FP3_NAME_SIZE - 1, symbol->name);
        const char *expected = fp3_name_expected(symbol->name, symbol->symbol_class);
        if (expected)
            return fp3_fail(error, FP3_E_PROGRAM, "symbol %u: found the %s '%s', expected %s", i,
                            fp3_class_name(symbol->symbol_class), symbol->name, expected);
        if (symbol->symbol_class == FP3_SYMBOL_LABEL) {
            if (symbol->index > image->code_count)
                return fp3_fail(error, FP3_E_PROGRAM,
                                "label '%s' is at %u, after the %u code words", symbol->name,
                                symbol->index, image->code_count);
            continue;
        }
        int is_object = fp3_class_is_object(symbol->symbol_class);
        uint32_t count = is_object ? FP3_BANK_OBJECT_COUNT : FP3_BANK_SHARED_COUNT;
        if (symbol->index >= count)
            return fp3_fail(error, FP3_E_PROGRAM, "%s '%s' is register %u of %u",
                            fp3_class_name(symbol->symbol_class), symbol->name, symbol->index,
                            count);
        const char **owner = is_object ? &object[symbol->index] : &shared[symbol->index];
        if (*owner)
            return fp3_fail(error, FP3_E_PROGRAM, "'%s' and '%s' are both %c%u", *owner,
                            symbol->name, is_object ? 'r' : 'k', symbol->index);
        *owner = symbol->name;
        if (symbol->symbol_class == FP3_SYMBOL_CONST && !valued[symbol->index])
            return fp3_fail(error, FP3_E_PROGRAM, "const '%s' has no value", symbol->name);
        if (symbol->symbol_class == FP3_SYMBOL_SHARED && valued[symbol->index])
            return fp3_fail(error, FP3_E_PROGRAM,
                            "shared '%s' has a value, but the host writes shared constants",
                            symbol->name);
    }
    return check_names(image, error);
}

/* The host finds out from one register of an object whether it sleeps, and keeps it. */
static fp3_status check_slept(const fp3_image *image, fp3_error *error) {
    const int slept = fp3_image_slept(image);
    if (slept < 0)
        return FP3_OK;
    for (uint32_t i = 0; i < image->code_count; i++)
        if (names_slept(&image->decoded[i]) && image->decoded[i].in.d != (uint32_t)slept)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "code word %u sleeps in r%u, but an earlier word in r%d: a program has "
                            "one sleep register",
                            i, image->decoded[i].in.d, slept);
    if (slept == fp3_image_steps(image))
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "r%d, in which objects sleep, is 'steps', how many steps an object has made", slept);
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *s = &image->symbols[i];
        if (s->index == (uint32_t)slept && fp3_class_is_object(s->symbol_class) &&
            s->symbol_class != FP3_SYMBOL_STATE)
            return fp3_fail(error, FP3_E_PROGRAM,
                            "r%d, in which objects sleep, is the %s '%s' and not a state", slept,
                            fp3_class_name(s->symbol_class), s->name);
    }
    return FP3_OK;
}

static void raise_to(uint32_t *highest, uint32_t value) {
    if (*highest < value)
        *highest = value;
}

static void count_operand(fp3_image *image, uint32_t operand) {
    if (operand < FP3_BANK_SHARED_BASE)
        raise_to(&image->registers, operand - FP3_BANK_OBJECT_BASE + 1);
    else
        raise_to(&image->shared, operand - FP3_BANK_SHARED_BASE + 1);
}

static void count_used(fp3_image *image) {
    image->registers = image->shared = 0;
    for (uint32_t i = 0; i < image->code_count; i++) {
        const fp3_decoded *word = &image->decoded[i];
        for (const char *letter = word->of ? word->of->operands : ""; *letter; letter++)
            if (!fp3_operation_counts(word->of, *letter))
                count_operand(image, fp3_operand(&word->in, *letter));
    }
    for (uint32_t i = 0; i < image->constant_count; i++)
        raise_to(&image->shared, image->constants[i].index + 1);
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class != FP3_SYMBOL_LABEL)
            raise_to(fp3_class_is_object(image->symbols[i].symbol_class) ? &image->registers
                                                                         : &image->shared,
                     image->symbols[i].index + 1);
}

static void *copied(const void *from, size_t bytes) {
    void *to = malloc(bytes ? bytes : 1);
    if (to && bytes)
        memcpy(to, from, bytes);
    return to;
}

fp3_status fp3_image_make(const fp3_image *draft, fp3_image **image, fp3_error *error) {
    *image = NULL;
    if (draft->code_count > FP3_IMAGE_CODE_LIMIT)
        return fp3_fail(error, FP3_E_PROGRAM, "%u code words; %u are possible", draft->code_count,
                        FP3_IMAGE_CODE_LIMIT);
    if (draft->step >= draft->last || draft->last > draft->code_count)
        return fp3_fail(error, FP3_E_PROGRAM, "the step part is %u to %u of %u code words",
                        draft->step, draft->last, draft->code_count);
    char words[FP3_WORDS_NAME_SIZE];
    if (!fp3_image_words_name(draft->words, words))
        return fp3_fail(error, FP3_E_PROGRAM, "no arithmetic has the number %u", draft->words);
    if (draft->constant_count > FP3_BANK_SHARED_COUNT)
        return fp3_fail(error, FP3_E_PROGRAM, "%u values for %d shared constants",
                        draft->constant_count, FP3_BANK_SHARED_COUNT);
    if (draft->symbol_count > FP3_BANK_OBJECT_COUNT + FP3_BANK_SHARED_COUNT + FP3_IMAGE_LABEL_LIMIT)
        return fp3_fail(error, FP3_E_PROGRAM, "%u symbols are too many", draft->symbol_count);
    fp3_status status = check_symbols(draft, error);
    if (status)
        return status;

    uint32_t *code = copied(draft->code, draft->code_count * sizeof *code);
    fp3_constant *constants = copied(draft->constants, draft->constant_count * sizeof *constants);
    fp3_symbol *symbols = copied(draft->symbols, draft->symbol_count * sizeof *symbols);
    fp3_decoded *decoded = fp3_decode_all(draft->code, draft->code_count);
    fp3_image *made = copied(draft, sizeof *draft);
    if (!code || !constants || !symbols || !decoded || !made) {
        free(code);
        free(constants);
        free(symbols);
        free(decoded);
        free(made);
        return fp3_no_memory(error);
    }
    qsort(constants, draft->constant_count, sizeof *constants, by_index);
    qsort(symbols, draft->symbol_count, sizeof *symbols, by_class);
    made->code = code;
    made->constants = constants;
    made->symbols = symbols;
    made->decoded = decoded;
    count_used(made);
    fp3_neighbourhood around;
    status = check_slept(made, error);
    if (!status)
        status = fp3_neighbourhood_find(made, &around, error);
    if (status)
        fp3_image_free(&made);
    *image = made;
    return status;
}

void fp3_image_free(fp3_image **image) {
    if (!image || !*image)
        return;
    free((void *)(*image)->code);
    free((void *)(*image)->constants);
    free((void *)(*image)->symbols);
    free((void *)(*image)->decoded);
    free(*image);
    *image = NULL;
}
