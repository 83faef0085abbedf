/* stream.h - random programs for a configuration.
 *
 * Of three makes where contexts interleave: raw words, of which every register is kept; with names,
 * of which some are .temp; with loads and stores of their own. A register that a visit may find
 * with what another object left there is read only where every path has written it: the rest of the
 * path is what an object that falls asleep leaves out.
 */
#ifndef FP3_TESTS_STREAM_H
#define FP3_TESTS_STREAM_H

#include "chance.h"

#include <fp3/image.h>
#include <fp3/isa.h>
#include <machine/config.h>
#include <machine/operation.h>
#include <machine/storage.h>
#include <stdio.h>
#include <string.h>

enum { CODE_SHORT = 40, CODE_MAX = 160, REGISTERS_MAX = 64, NOWHERE = UINT16_MAX };

typedef enum { RAW, NAMED, COMPOSED } make_of;

typedef struct {
    make_of make;
    uint32_t code[CODE_MAX];
    uint32_t count, step, last;
    fp3_symbol symbols[REGISTERS_MAX];
    uint32_t symbol_count;
    uint32_t illegal; /* where a word is that the configuration does not have, or NOWHERE */
    int slept;        /* the register that sleep writes, or -1 */
    unsigned sleeps;  /* how many there are */
    /* While it is made. */
    const fp3_config *config;
    uint32_t pool;      /* registers in use: 0 .. pool-1 */
    uint32_t recent[4]; /* destinations: what follows depends on them */
    uint64_t temps;     /* that a visit finds undefined */
    uint64_t defined;   /* here */
    uint64_t at_last;   /* where the last part begins */
} stream;

/* What the host can write into an object: a number that is too large for a record of 16 bits is
 * refused, its infinity is not. There numbers of other sizes are more telling: at both ends of
 * binary16, and halfway between two of its numbers. */
static inline uint32_t object_value(chance *c, const fp3_config *config) {
    uint32_t flags, bits = value(c);
    if (config->storage && below(c, 2))
        bits = (bits & 0x807fffffu) | (below(c, 2) ? 100 + below(c, 15) : 138 + below(c, 5)) << 23;
    return fp3_stored(config, bits, NULL, &flags);
}

static inline uint32_t stream_source(chance *c, const stream *s) {
    for (int i = 0; i < 4; i++) {
        const uint32_t kind = below(c, 8);
        const uint32_t reg = kind < 2 ? s->recent[below(c, 4)] : below(c, s->pool);
        if (kind >= 4)
            break;
        if (s->defined >> reg & 1)
            return reg;
    }
    return FP3_BANK_SHARED_BASE + below(c, s->config->registers);
}

static inline uint32_t stream_destination(chance *c, stream *s) {
    uint32_t d;
    do
        d = below(c, 5) ? below(c, s->pool) : s->recent[below(c, 4)];
    while ((int)d == s->slept); /* nothing but sleep says that an object sleeps */
    s->recent[below(c, 4)] = d;
    s->defined |= UINT64_C(1) << d;
    return d;
}

static inline uint32_t stream_word(uint32_t op, uint32_t d, uint32_t a, uint32_t b, uint32_t c) {
    return fp3_word_encode(&(fp3_instruction){op, d, a, b, c});
}

static inline int stream_has(const fp3_config *config, uint32_t op) {
    return fp3_operation_lacks(config, op) == FP3_KEY_NONE;
}

/* How many operands an operation reads. */
static inline uint32_t stream_sources(uint32_t op) { return fp3_operation_find(op)->sources; }

static inline int is_arithmetic(uint32_t op) {
    return fp3_operation_is_arithmetic(fp3_operation_find(op));
}

/* An arithmetic operation that the configuration has, or one that it does not have. The two that
 * work on one register are not asked for: see sleep_word. */
static inline uint32_t random_op(chance *c, const fp3_config *config, int is_had) {
    for (;;) {
        const uint32_t op = fp3_operations[below(c, fp3_operation_count)].code;
        if (is_arithmetic(op) && stream_has(config, op) == is_had)
            return op;
    }
}

/* Whether it lacks any. */
static inline int lacks_arithmetic(const fp3_config *config) {
    for (uint32_t i = 0; i < fp3_operation_count; i++)
        if (is_arithmetic(fp3_operations[i].code) && !stream_has(config, fp3_operations[i].code))
            return 1;
    return 0;
}

/* An operation and its operands; d is 0, or 1 where a product may not be written to an even
 * register. */
static inline uint32_t operation_word(chance *c, stream *s) {
    const uint32_t op = random_op(c, s->config, 1), sources = stream_sources(op);
    const uint32_t x = stream_source(c, s), y = sources > 1 ? stream_source(c, s) : 0;
    const uint32_t z = sources > 2 ? stream_source(c, s) : 0;
    const int is_odd = s->config->dual && fp3_operation_multiplies(fp3_operation_find(op));
    return stream_word(op, is_odd, x, y, z);
}

static inline int stream_is_legal(const stream *s, uint32_t word) {
    fp3_instruction in;
    return !fp3_word_decode(word, &in, NULL) && !fp3_operation_mixes(s->config, &in);
}

/* Where sums and products are apart, until one fits. */
static inline uint32_t arithmetic_word(chance *c, stream *s) {
    uint32_t word, d;
    do
        word = operation_word(c, s);
    while (!stream_is_legal(s, word));
    const uint32_t odd = word >> FP3_FIELD_D_LO & 1;
    const stream before = *s;
    do {
        *s = before; /* what is not taken is not written */
        d = stream_destination(c, s);
    } while (s->config->dual && (d & 1) != odd);
    return (word & ~(UINT32_C(63) << FP3_FIELD_D_LO)) | d << FP3_FIELD_D_LO;
}

static inline uint32_t sleep_word(chance *c, stream *s, int is_last) {
    const uint32_t x = stream_source(c, s), y = stream_source(c, s);
    s->sleeps++;
    if (!is_last)
        s->at_last &= s->defined;
    return stream_word(FP3_OP_SLEEP, (uint32_t)s->slept, x, y, 0);
}

static inline uint32_t load_word(chance *c, stream *s) {
    const uint32_t d = stream_destination(c, s);
    return stream_word(FP3_OP_LD, d, 0, 0, 0);
}

/* A store of what is defined; a load if nothing is. */
static inline uint32_t store_word(chance *c, stream *s) {
    const uint32_t first = below(c, s->pool);
    for (uint32_t i = 0; i < s->pool; i++) {
        const uint32_t reg = (first + i) % s->pool;
        if (s->defined >> reg & 1 && (int)reg != s->slept)
            return stream_word(FP3_OP_ST, reg, 0, 0, 0);
    }
    return load_word(c, s);
}

/* A word of one of the three parts. */
static inline uint32_t legal_word(chance *c, stream *s, uint32_t index) {
    const int is_last = index >= s->last, is_first = index < s->step;
    if (s->make == COMPOSED) {
        if (index == 0 && s->slept >= 0)
            return stream_word(FP3_OP_LDS, (uint32_t)s->slept, 0, 0, 0);
        if (is_first && below(c, 2))
            return load_word(c, s);
        if (!is_first && s->illegal == NOWHERE && below(c, is_last ? 2 : 20) == 0)
            return is_last || below(c, 2) ? store_word(c, s) : load_word(c, s);
    }
    if (s->slept >= 0 && below(c, s->count) == 0)
        return sleep_word(c, s, is_last);
    return arithmetic_word(c, s);
}

/* With the fields of word that the operation has. */
static inline uint32_t stream_turned(uint32_t word, uint32_t op) {
    const uint32_t fields[] = {0x07ffc000u, 0x07ffff80u, 0x07ffffffu};
    return op << FP3_FIELD_OP_LO | (word & fields[stream_sources(op) - 1]);
}

/* Written to the other bank, or reads one twice, where it reads a register. */
static inline uint32_t mixed_word(chance *c, uint32_t word) {
    const uint32_t first = word >> FP3_FIELD_A_LO & 127;
    if (first >= FP3_BANK_SHARED_BASE || below(c, 2))
        return word ^ UINT32_C(1) << FP3_FIELD_D_LO;
    return (word & ~(UINT32_C(127) << FP3_FIELD_B_LO)) | first << FP3_FIELD_B_LO;
}

/* Begins another field than word's, so that nothing else is wrong with it. */
static inline uint32_t illegal_word(chance *c, stream *s) {
    const fp3_config *config = s->config;
    const uint32_t word = arithmetic_word(c, s), random = (uint32_t)next64(c);
    const uint32_t low = random & 0x07ffffffu, beyond = config->registers;
    for (;;)
        switch (below(c, 6)) {
        case 0:
            return low; /* code 0 */
        case 1:         /* a code that no instruction has, also none of those with neighbours */
            if (!fp3_operation_find(random >> FP3_FIELD_OP_LO) &&
                !fp3_operation_find(FP3_CODE_MORE + (random >> FP3_FIELD_C_LO & 127)))
                return random;
            break;
        case 2: { /* an operand too many */
            const uint32_t op = random_op(c, config, 1);
            const uint32_t field = stream_sources(op) > 1 || below(c, 2) ? 0 : FP3_FIELD_B_LO;
            if (stream_sources(op) < 3)
                return stream_turned(word, op) | (1 + below(c, 127)) << field;
            break;
        }
        case 3: /* what may be left out, and is */
            if (lacks_arithmetic(config))
                return stream_turned(word, random_op(c, config, 0));
            break;
        case 4:
            /* The composer takes these for the program's own loads and stores. */
            if (!config->interleave)
                return (FP3_OP_SLEEP + below(c, 4)) << FP3_FIELD_OP_LO;
            if (config->dual) /* a sum among the products, or two of them read, or the reverse */
                return mixed_word(c, word);
            break;
        default:
            if (beyond < REGISTERS_MAX) {
                static const int fields[] = {FP3_FIELD_D_LO, FP3_FIELD_A_LO, FP3_FIELD_B_LO,
                                             FP3_FIELD_C_LO};
                return (word & 0x07ffff80u) |
                       (uint32_t)(config->chain ? FP3_OP_MSUB : FP3_OP_MUL) << FP3_FIELD_OP_LO |
                       beyond << fields[below(c, config->chain ? 4 : 3)];
            }
        }
}

static inline void make_lengths(chance *c, stream *s, uint32_t room) {
    /* Mostly short: after some dozens of operations there are too many infinities and NaNs. */
    s->count = 1 + below(c, below(c, 4) && room > CODE_SHORT ? CODE_SHORT : below(c, 2) ? room : 6);
    s->step = below(c, below(c, 2) ? s->count : 1 + s->count / 4);
    s->last = s->step + 1 + below(c, s->count - s->step);
    if (s->make == COMPOSED && s->slept >= 0 && s->step == 0) {
        s->step = 1; /* for the lds */
        s->last++;
        s->count++;
    }
}

/* Which registers have names, and which of them are temps. In the words of a composed stream, every
 * register is one until it is loaded. */
static inline void make_names(chance *c, stream *s) {
    for (uint32_t reg = 0; reg < s->pool && s->make == NAMED; reg++) {
        const int is_temp = (int)reg != s->slept && below(c, 2);
        fp3_symbol *symbol = &s->symbols[s->symbol_count];
        if (below(c, 4) == 0)
            continue;
        symbol->symbol_class = is_temp                               ? FP3_SYMBOL_TEMP
                               : (int)reg == s->slept || below(c, 2) ? FP3_SYMBOL_STATE
                                                                     : FP3_SYMBOL_PARAM;
        symbol->index = reg;
        snprintf(symbol->name, sizeof symbol->name, "x%u", reg);
        s->symbol_count++;
        /* The other temps are read at once: what they hold has to be kept. */
        if (is_temp && below(c, 3))
            s->temps |= UINT64_C(1) << reg;
    }
    /* States that are now in their registers, now in records. */
    for (uint32_t reg = 0; reg < s->pool && s->make == COMPOSED; reg += 2) {
        fp3_symbol *symbol = &s->symbols[s->symbol_count++];
        symbol->symbol_class = FP3_SYMBOL_STATE;
        symbol->index = reg;
        snprintf(symbol->name, sizeof symbol->name, "x%u", reg);
    }
    if (s->make == COMPOSED)
        s->temps = ~UINT64_C(0);
    s->defined = ~s->temps;
    if (s->make == COMPOSED && s->slept >= 0)
        s->defined |= UINT64_C(1) << s->slept;
}

/* words: how many of a record each object has. */
static inline void make_stream(chance *c, stream *s, const fp3_config *config, uint32_t words) {
    memset(s, 0, sizeof *s);
    s->config = config;
    s->illegal = NOWHERE;
    s->slept = -1;
    s->make = config->interleave ? (make_of)below(c, 3) : RAW;
    s->pool = words < config->registers ? words : config->registers;
    if (config->interleave && below(c, 4))
        s->pool = 1 + config->dual + below(c, s->pool - config->dual);
    /* Loads and stores of all registers may come around it, and an lds. */
    if (config->interleave && 2 * s->pool + 8 > config->program_words)
        s->pool = (config->program_words - 8) / 2;
    const uint32_t room = config->program_words - (config->interleave ? 2 * s->pool + 3 : 0);
    const int is_illegal = below(c, 12) == 0;
    if (config->sleep && !is_illegal && s->pool > 1 && below(c, 2))
        s->slept = (int)below(c, s->pool);
    make_lengths(c, s, room < CODE_MAX - 2 ? room : CODE_MAX - 2);
    if (is_illegal)
        s->illegal = below(c, s->count);
    make_names(c, s);
    for (int i = 0; i < 4; i++)
        do
            s->recent[i] = below(c, s->pool);
        while ((int)s->recent[i] == s->slept);
    s->at_last = ~UINT64_C(0);
    for (uint32_t i = 0; i < s->count; i++) {
        if (i == s->last)
            s->defined &= s->at_last;
        s->code[i] = i == s->illegal ? illegal_word(c, s) : legal_word(c, s, i);
    }
    if (s->sleeps && s->make == COMPOSED) /* the host must see who sleeps */
        s->code[s->count++] = stream_word(FP3_OP_ST, (uint32_t)s->slept, 0, 0, 0);
}

static inline fp3_image stream_image(const stream *s) {
    return (fp3_image){.code = s->code,
                       .code_count = s->count,
                       .step = s->step,
                       .last = s->last,
                       .symbols = s->symbols,
                       .symbol_count = s->symbol_count};
}

#endif
