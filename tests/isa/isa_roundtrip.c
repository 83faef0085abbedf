/* isa_roundtrip - instruction words and images come back from their assembly text bit for bit, and
 * illegal words are refused.
 *
 *     isa_roundtrip [--seed N] [--words N]
 *
 * Words: every operation with every register in every place, then random ones, --words in all. Two
 * places have all pairs of registers with at least a million words, else those of which one is a
 * power of two, 0 or 127.
 * Images: random names (some spelled like registers), values, labels and parts.
 * What is legal is decided here from the rows of fp3_operations, not by the library.
 */
#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine/operation.h"

static uint64_t state;

static uint32_t random32(void) { /* splitmix64 */
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)(z >> 32 ^ z);
}

static unsigned long long seed;

static void fail(const char *what, const char *expected, const char *got) {
    printf("FAIL %s\n  expected: %s\n  got:      %s\n  replay:   isa_roundtrip --seed %llu\n", what,
           expected, got, seed);
    exit(1);
}

static void fail_words(const char *what, uint32_t expected, uint32_t got) {
    char e[16], g[16];
    snprintf(e, sizeof e, "0x%08x", expected);
    snprintf(g, sizeof g, "0x%08x", got);
    fail(what, e, g);
}

static uint32_t bits(int high, int low) { return (uint32_t)((2ull << high) - (1ull << low)); }

static uint32_t mask_of(const char *operands) {
    uint32_t mask = 0;
    for (; *operands; operands++)
        mask |= *operands == 'd'   ? bits(FP3_FIELD_D_HI, FP3_FIELD_D_LO)
                : *operands == 'a' ? bits(FP3_FIELD_A_HI, FP3_FIELD_A_LO)
                : *operands == 'b' ? bits(FP3_FIELD_B_HI, FP3_FIELD_B_LO)
                                   : bits(FP3_FIELD_C_HI, FP3_FIELD_C_LO);
    return mask;
}

static int is_legal(uint32_t word) {
    for (int i = 0; i < (int)fp3_operation_count; i++)
        if (word >> FP3_FIELD_OP_LO == fp3_operations[i].code)
            return !(word & ~mask_of(fp3_operations[i].operands) &
                     ~bits(FP3_FIELD_OP_HI, FP3_FIELD_OP_LO));
        else if (fp3_operations[i].code >= FP3_CODE_MORE &&
                 word >> FP3_FIELD_OP_LO ==
                     bits(FP3_FIELD_OP_HI, FP3_FIELD_OP_LO) >> FP3_FIELD_OP_LO &&
                 (word & bits(FP3_FIELD_C_HI, FP3_FIELD_C_LO)) >> FP3_FIELD_C_LO ==
                     fp3_operations[i].code - FP3_CODE_MORE)
            return !(word & ~mask_of(fp3_operations[i].operands) &
                     bits(FP3_FIELD_D_HI, FP3_FIELD_B_LO));
    return 0;
}

/* Loops over neighbours and phases have an order, which random words do not: tests/world. */
static int is_alone(const fp3_operation *of) {
    return of->needs != FP3_KEY_NEIGHBOURS && of->needs != FP3_KEY_KEEP;
}

static uint32_t random_legal(void) {
    int i;
    do
        i = (int)(random32() % (int)fp3_operation_count);
    while (!is_alone(&fp3_operations[i]));
    return fp3_operations[i].code << FP3_FIELD_OP_LO |
           (random32() & mask_of(fp3_operations[i].operands));
}

/* Draft to image to text to image: the same words, and the same from the words alone. */
static void round_trip(const fp3_image *draft) {
    fp3_error error;
    fp3_image *image = NULL, *decoded = NULL;
    fp3_assembly *assembly = NULL;
    uint32_t *before = NULL, *after = NULL;
    size_t before_count = 0, after_count = 0;
    char *text = NULL;
    if (fp3_image_make(draft, &image, &error))
        fail("an image of random legal words is made", "an image", error.text);
    if (fp3_image_encode(image, &before, &before_count, &error) ||
        fp3_image_decode(before, before_count, &decoded, &error))
        fail("an image is read back from its words", "an image", error.text);
    if (fp3_disassemble(decoded, &text, &error))
        fail("an image of legal words is disassembled", "text", error.text);
    if (fp3_assemble(text, strlen(text), "text", &assembly, &error)) {
        printf("%s\n", text);
        fail("disassembled text is assembled", "an image", error.text);
    }
    if (fp3_image_encode(assembly->image, &after, &after_count, &error))
        fail("an image is encoded", "words", error.text);
    if (before_count != after_count) {
        printf("%s\n", text);
        fail_words("the words of image, text, image: their number", (uint32_t)before_count,
                   (uint32_t)after_count);
    }
    for (size_t i = 0; i < before_count; i++)
        if (before[i] != after[i]) {
            printf("%s\nimage word %zu\n", text, i);
            fail_words("image, text, image are the same bits", before[i], after[i]);
        }
    free(before);
    free(after);
    free(text);
    fp3_image_free(&image);
    fp3_image_free(&decoded);
    fp3_assembly_free(&assembly);
}

/* A program has only one sleep register: each register gets a block of its own. */
static int names_slept(uint32_t word) {
    return word >> FP3_FIELD_OP_LO == FP3_OP_SLEEP || word >> FP3_FIELD_OP_LO == FP3_OP_LDS;
}

static uint32_t slept_of(uint32_t word) {
    return names_slept(word) ? (word >> FP3_FIELD_D_LO) % FP3_BANK_OBJECT_COUNT : 0;
}

enum { BLOCK = 8192 };
static uint32_t block[FP3_BANK_OBJECT_COUNT][BLOCK];
static uint32_t block_count[FP3_BANK_OBJECT_COUNT];
static unsigned long long legal_count, illegal_count, image_count;

static void flush_block(uint32_t slept) {
    const uint32_t count = block_count[slept];
    if (count == 0)
        return;
    fp3_image draft = {.code_count = count, .last = count, .code = block[slept]};
    round_trip(&draft);
    block_count[slept] = 0;
}

static void check_word(uint32_t word) {
    char text[FP3_WORD_TEXT_SIZE] = "";
    fp3_error error;
    fp3_instruction decoded;
    if (!is_legal(word)) {
        illegal_count++;
        if (!fp3_word_decode(word, NULL, &error) || !fp3_word_text(word, NULL, text, &error))
            fail_words("an illegal word is refused", 0, word);
        return;
    }
    legal_count++;
    if (fp3_word_decode(word, &decoded, &error))
        fail("a legal word is decoded", "an instruction", error.text);
    if (fp3_word_encode(&decoded) != word)
        fail_words("decode, encode", word, fp3_word_encode(&decoded));
    if (!is_alone(fp3_operation_find(decoded.op)))
        return;
    const uint32_t slept = slept_of(word);
    block[slept][block_count[slept]++] = word;
    if (block_count[slept] == BLOCK)
        flush_block(slept);
}

/* Has none of seven bits, one or all. */
static int is_plain(uint32_t x) { return !(x & (x - 1)) || x == 127; }

/* Pairs of registers in all pairs of places, and every bit of every unused field. */
static void check_every_register(int has_all_pairs) {
    for (int i = 0; i < (int)fp3_operation_count; i++) {
        const fp3_instruction alone = {.op = fp3_operations[i].code};
        const uint32_t op = fp3_word_encode(&alone);
        static const int low[] = {FP3_FIELD_D_LO, FP3_FIELD_A_LO, FP3_FIELD_B_LO, FP3_FIELD_C_LO};
        for (int one = 0; one < 4; one++)
            for (int other = 0; other < one; other++)
                for (uint32_t x = 0; x < 128; x++)
                    for (uint32_t y = 0; y < 128; y++)
                        if ((x < 64 || one > 0) && (y < 64 || other > 0) &&
                            (has_all_pairs || is_plain(x) || is_plain(y)))
                            check_word(op | x << low[one] | y << low[other]);
    }
    for (uint32_t op = 0; op < 32; op++) /* unknown opcodes among them */
        for (int bit = 0; bit < FP3_FIELD_OP_LO; bit++)
            check_word(op << FP3_FIELD_OP_LO | 1u << bit);
}

/* Random names, values, labels and parts; often with few registers, so that uses collide. */
static void check_random_image(void) {
    fp3_symbol symbols[200];
    fp3_constant constants[FP3_BANK_SHARED_COUNT];
    uint32_t code[64], bank_mask = random32() % 2 ? 7 : 63, valued = 0;
    memset(symbols, 0, sizeof symbols);
    fp3_image draft = {.code_count = 1 + random32() % 64};
    draft.step = random32() % draft.code_count;
    draft.last = draft.step + 1 + random32() % (draft.code_count - draft.step);
    const uint32_t slept = random32() & bank_mask;
    int sleeps = 0;
    for (uint32_t i = 0; i < draft.code_count; i++) {
        uint32_t word = random_legal();
        uint32_t keep = (bank_mask << FP3_FIELD_D_LO) | ((bank_mask | 64) << FP3_FIELD_A_LO) |
                        ((bank_mask | 64) << FP3_FIELD_B_LO) | (bank_mask | 64);
        code[i] = word & (keep | bits(FP3_FIELD_OP_HI, FP3_FIELD_OP_LO));
        if (!names_slept(word))
            continue;
        sleeps = 1;
        code[i] &= ~bits(FP3_FIELD_D_HI, FP3_FIELD_D_LO);
        code[i] |= slept << FP3_FIELD_D_LO;
    }
    for (uint32_t k = 0; k < FP3_BANK_SHARED_COUNT && k <= bank_mask; k++) {
        if (random32() % 3 == 0)
            continue;
        static const uint32_t special[] = {0,          0x80000000, 0x3f000000, 0x3f000000,
                                           0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001,
                                           1,          0x7f7fffff};
        constants[valued].index = k;
        constants[valued++].bits = random32() % 2 ? special[random32() % 10] : random32();
    }
    draft.constant_count = valued;
    for (uint32_t bank = 0; bank < 2; bank++)
        for (uint32_t r = 0; r <= bank_mask; r++) {
            if (random32() % 3)
                continue;
            fp3_symbol *s = &symbols[draft.symbol_count++];
            s->index = r;
            if (bank == 0) {
                s->symbol_class = (fp3_symbol_class)(random32() % 3);
                if (sleeps && r == slept)
                    s->symbol_class = FP3_SYMBOL_STATE;
            } else {
                s->symbol_class = FP3_SYMBOL_SHARED;
                for (uint32_t i = 0; i < valued; i++)
                    if (constants[i].index == r)
                        s->symbol_class = FP3_SYMBOL_CONST;
            }
            /* Some names are spelled like a register: the one they stand for, or another. */
            if (random32() % 2)
                snprintf(s->name, sizeof s->name, "n%u_%u", bank, r);
            else
                snprintf(s->name, sizeof s->name, "%c%u", "rk"[random32() % 2],
                         random32() % (bank_mask + 2));
            for (uint32_t i = 0; i + 1 < draft.symbol_count; i++)
                if (!strcmp(symbols[i].name, s->name))
                    snprintf(s->name, sizeof s->name, "m%u_%u", bank, r);
        }
    for (uint32_t i = 0, count = random32() % 5; i < count; i++) {
        fp3_symbol *s = &symbols[draft.symbol_count++];
        s->symbol_class = FP3_SYMBOL_LABEL;
        s->index = random32() % (draft.code_count + 1);
        snprintf(s->name, sizeof s->name, "label_%u", i);
    }
    draft.code = code;
    draft.constants = constants;
    draft.symbols = symbols;
    round_trip(&draft);
    image_count++;
}

int main(int argc, char **argv) {
    unsigned long long words = 2000000;
    seed = 1;
    for (int i = 1; i < argc; i++) {
        char *end = NULL;
        unsigned long long value = i + 1 < argc ? strtoull(argv[i + 1], &end, 0) : 0;
        if (!end || *end || (strcmp(argv[i], "--seed") && strcmp(argv[i], "--words"))) {
            fprintf(stderr, "usage: isa_roundtrip [--seed N] [--words N]\n");
            return 2;
        }
        *(strcmp(argv[i], "--seed") ? &words : &seed) = value;
        i++;
    }
    printf("seed %llu\n", seed);
    state = seed;
    check_every_register(words >= 1000000);
    while (legal_count < words)
        check_word(random_legal());
    for (unsigned long long i = 0; i < words; i++)
        check_word(random32());
    for (uint32_t slept = 0; slept < FP3_BANK_OBJECT_COUNT; slept++)
        flush_block(slept);
    for (unsigned long long i = 0; i < words / 500; i++)
        check_random_image();
    printf("%llu legal words, %llu illegal words, %llu images\n", legal_count, illegal_count,
           image_count);
    return 0;
}
