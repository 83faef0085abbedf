/* mutate.h - changes words of a model rather than bytes, so that the result is often a model, too,
 * and reaches the stages after the reader. Only for libFuzzer. */
#ifndef FP3_FUZZ_MUTATE_H
#define FP3_FUZZ_MUTATE_H

#include <language/lexer.h>
#include <stdio.h>
#include <string.h>

enum { MUTATE_WORDS = 2048, MUTATE_WORD_SIZE = 200, MUTATE_MODELS = 256, MUTATE_MODEL_SIZE = 4096 };

/* Accepted models to start from: nearly all of a fuzzer's own corpus is errors. */
typedef struct {
    char text[MUTATE_MODELS][MUTATE_MODEL_SIZE];
    size_t size[MUTATE_MODELS];
    unsigned count;
} mutate_models;

static void mutate_remember(mutate_models *models, const char *text, size_t size) {
    if (size > MUTATE_MODEL_SIZE)
        return;
    memcpy(models->text[models->count % MUTATE_MODELS], text, size);
    models->size[models->count++ % MUTATE_MODELS] = size;
}

static unsigned mutate_random(unsigned *state, unsigned limit) {
    *state = *state * 1103515245u + 12345u;
    return (*state >> 16) % limit;
}

/* Another word of the same kind as words[i], or words[i] if none is found. */
static fp3_token mutate_other(const fp3_token *words, unsigned count, unsigned i, unsigned *state) {
    for (unsigned tries = 0; tries < 20; tries++) {
        fp3_token other = words[mutate_random(state, count)];
        if (other.kind == words[i].kind)
            return other;
    }
    return words[i];
}

static const char *mutate_operator(unsigned *state) {
    static const char *const operators[] = {"+", "-",  "*",  "/",  "+",  "*",     "<",
                                            ">", "<=", ">=", "==", "!=", " and ", " or "};
    return operators[mutate_random(state, sizeof operators / sizeof *operators)];
}

static const char *mutate_function(unsigned *state) {
    static const char *const functions[] = {"sqrt", "sin",  "tan", "atan", "acos", "exp",
                                            "log",  "tanh", "abs", "-",    "not ", ""};
    return functions[mutate_random(state, sizeof functions / sizeof *functions)];
}

static const char *mutate_number(unsigned *state) {
    static const char *const numbers[] = {"0", "1",    "2",     "3",     "-1",   "8",   "0.5",
                                          "7", "1e30", "1e-40", "3e-38", "3e38", "1/3", "1e300"};
    return numbers[mutate_random(state, sizeof numbers / sizeof *numbers)];
}

static void mutate_word(const fp3_token *words, unsigned count, unsigned i, unsigned *state,
                        char text[MUTATE_WORD_SIZE]) {
    fp3_token a = words[i], b = mutate_other(words, count, i, state);
    int a_size = a.length < 40 ? (int)a.length : 40, b_size = b.length < 40 ? (int)b.length : 40;
    unsigned how = mutate_random(state, 6);
    if (a.kind == FP3_TOKEN_NUMBER && how < 2)
        snprintf(text, MUTATE_WORD_SIZE, "%s", mutate_number(state));
    else if (a.kind == FP3_TOKEN_SYMBOL && strchr("+-*/<>", *a.text))
        snprintf(text, MUTATE_WORD_SIZE, "%s", mutate_operator(state));
    else if (a.kind == FP3_TOKEN_SYMBOL || how < 3)
        snprintf(text, MUTATE_WORD_SIZE, "%.*s", b_size, b.text);
    else if (how < 4)
        snprintf(text, MUTATE_WORD_SIZE, "%s(%.*s)", mutate_function(state), a_size, a.text);
    else
        snprintf(text, MUTATE_WORD_SIZE, "(%.*s%s%.*s)", a_size, a.text, mutate_operator(state),
                 b_size, b.text);
}

/* Returns the new size. copy is what data was. */
static size_t mutate_model(unsigned char *data, const char *copy, size_t size, size_t room,
                           unsigned state) {
    static fp3_token words[MUTATE_WORDS];
    unsigned count = 0;
    char text[MUTATE_WORD_SIZE];
    ode_lexer lexer;
    fp3_ode_lexer_open(&lexer, copy, size);
    for (fp3_token t = fp3_ode_next(&lexer);
         t.kind != FP3_TOKEN_END_OF_FILE && count < MUTATE_WORDS; t = fp3_ode_next(&lexer))
        if (t.kind == FP3_TOKEN_NAME || t.kind == FP3_TOKEN_NUMBER || t.kind == FP3_TOKEN_SYMBOL)
            words[count++] = t;
    if (!count)
        return size;
    unsigned i = mutate_random(&state, count);
    mutate_word(words, count, i, &state, text);
    size_t before = (size_t)(words[i].text - copy), length = strlen(text);
    size_t behind = size - before - words[i].length;
    if (before + length + behind > room)
        return size;
    memcpy(data + before, text, length);
    memcpy(data + before + length, words[i].text + words[i].length, behind);
    return before + length + behind;
}

#endif
