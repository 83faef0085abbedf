/* SPDX-License-Identifier: Apache-2.0 */
/* image_words.c - the names of what a program is made for. */
#include <fp3/image.h>

#include <stdio.h>

static const struct {
    const char *name, *said;
    int has_fewer; /* fraction bits than binary32 */
} kinds[FP3_WORDS_KINDS] = {
    [FP3_WORDS_ANY] = {"any", "any words", 0},
    [FP3_WORDS_FLOATS] = {"floats", "floats", 1},
    [FP3_WORDS_LOGARITHMS] = {"logarithms", "logarithms", 0},
    [FP3_WORDS_FLUSHED] = {"flushed", "flushed floats", 1},
    [FP3_WORDS_CELL] = {"cell", "floats of Cell's SPU", 0},
    [FP3_WORDS_TRUNCATED] = {"truncated", "truncated floats", 1},
    [FP3_WORDS_TRUNCATED_FLUSHED] = {"truncated_flushed", "truncated and flushed floats", 1},
    [FP3_WORDS_MIXED] = {"mixed", "floats with inverses by logarithms", 0},
};

static const char *name(uint32_t words, int is_said, char text[FP3_WORDS_NAME_SIZE]) {
    const uint32_t kind = words % FP3_WORDS_FEWER, fewer = words / FP3_WORDS_FEWER;
    if (kind >= FP3_WORDS_KINDS || fewer > FP3_WORDS_FRACTION - FP3_WORDS_FRACTION_LEAST ||
        (fewer && !kinds[kind].has_fewer))
        return NULL;
    const int length =
        snprintf(text, FP3_WORDS_NAME_SIZE, "%s", is_said ? kinds[kind].said : kinds[kind].name);
    if (fewer)
        snprintf(text + length, FP3_WORDS_NAME_SIZE - (size_t)length,
                 is_said ? " of %u fraction bits" : " %u", FP3_WORDS_FRACTION - fewer);
    return text;
}

const char *fp3_image_words_name(uint32_t words, char text[FP3_WORDS_NAME_SIZE]) {
    return name(words, 0, text);
}

const char *fp3_image_words_said(uint32_t words, char text[FP3_WORDS_NAME_SIZE]) {
    return name(words, 1, text);
}
