/* SPDX-License-Identifier: Apache-2.0 */
/* operation.h - the rows of isa/isa.toml as a table.
 *
 * Whoever asks what an operation is (which operands, which unit, what a configuration must have for
 * it) asks this table, so that a new operation needs no further case anywhere. What it computes is
 * in execute.h.
 *
 *     const fp3_operation *of = fp3_operation_find(word.op);
 *     if (of && of->path & FP3_UNIT_MULTIPLIER)
 *         products++;
 */
#ifndef FP3_OPERATION_H
#define FP3_OPERATION_H

#include "config.h"
#include "gen/operations.h"

#include <fp3/image.h>
#include <fp3/isa.h>
#include <stdint.h>

typedef struct {
    uint32_t code;
    const char *name;
    const char *operands; /* a letter each, in the order of the assembly language: "dab" */
    uint32_t sources;     /* how many registers are read: none, a, a and b, or a, b and c */
    unsigned path;        /* FP3_UNIT_*: the units that it goes through */
    fp3_counter counter;  /* where the hardware counts it: fp3_operation_counter */
    fp3_key needs;        /* what a configuration must have for it, or FP3_KEY_NONE */
    unsigned raises;      /* FP3_FLAG_*: what it can raise, in any configuration */
    fp3_writes writes;    /* whether it writes d when it is executed */
    int commutes;         /* a and b can be exchanged */
    fp3_gives gives;      /* what it has of a neighbour */
    int takes_field;      /* a field of the neighbour's entry becomes d, which is read */
    char number;          /* the operand that numbers this, which is no register; 0: none */
    uint32_t computes; /* what it makes of this and of register a, as an operation; 0: nothing, */
    int is_first;      /* ... in which this is operand a, and not b */
} fp3_operation;

extern const fp3_operation fp3_operations[];
extern const unsigned fp3_operation_count;

/* By code; NULL if unknown. */
const fp3_operation *fp3_operation_find(uint32_t code);

/* A word of a program. An image and a visit keep their words decoded, so no word is decoded twice;
 * fp3_word_decode is for a word that comes alone, as from a trace. */
typedef struct fp3_decoded {
    const fp3_operation *of; /* NULL: the word is no instruction */
    fp3_instruction in;      /* all 0 then */
} fp3_decoded;

/* The caller frees what it gets; NULL: out of memory. */
fp3_decoded *fp3_decode_all(const uint32_t *code, uint32_t count);

/* Whether its result depends on operands, rounding and flushing alone, and so can be computed
 * beforehand. The others work with the store or put an object to sleep. */
int fp3_operation_is_arithmetic(const fp3_operation *operation);

/* Where a configuration keeps sums and products apart (`dual`): whether the multiplier makes it, or
 * what is made in a product's place; else the adder, or both are taken by a load or a store. */
static inline int fp3_operation_multiplies(const fp3_operation *of) {
    return (of->path & (FP3_UNIT_MULTIPLIER | FP3_UNIT_VALUE)) != 0;
}

/* Where this configuration's hardware counts it. */
fp3_counter fp3_operation_counter(const fp3_config *config, const fp3_operation *of);

/* Whether it adds b doubled or halved. */
int fp3_operation_scales(uint32_t code);

/* Its bit in a set of operations; 0: there is no such code. */
uint64_t fp3_operation_bit(uint32_t code);

/* The key without which this configuration does not have the operation; FP3_KEY_NONE if it has it.
 */
fp3_key fp3_operation_lacks(const fp3_config *config, uint32_t code);

/* Where a configuration keeps sums and products apart (`dual`): what this instruction does that it
 * must not, or NULL. As in rtl/front/fp3_decode.v. */
const char *fp3_operation_mixes(const fp3_config *config, const fp3_instruction *word);

/* Whether this operand is the number of a field, or how often phases are made, and so stands in
 * assembly as a number. */
static inline int fp3_operation_counts(const fp3_operation *of, char letter) {
    return of->gives != FP3_GIVES_WORD && letter == of->number;
}

/* Whether a phase ends with this word of the program. */
static inline int fp3_ends_phase(const fp3_decoded *word) {
    return word->of && (word->in.op == FP3_OP_PHASE || word->in.op == FP3_OP_REPEAT ||
                        word->in.op == FP3_OP_AGAIN || word->in.op == FP3_OP_HOLD);
}

/* Of an operation that computes with what a neighbour gives: its operands a and b as those of
 * `computes`. */
static inline void fp3_operation_place(const fp3_operation *of, uint32_t own, uint32_t given,
                                       uint32_t *a, uint32_t *b) {
    *a = of->is_first ? given : own;
    *b = of->is_first ? own : given;
}

/* The operand that a letter of `operands` stands for. */
static inline uint32_t fp3_operand(const fp3_instruction *word, char letter) {
    return letter == 'd' ? word->d : letter == 'a' ? word->a : letter == 'b' ? word->b : word->c;
}

#endif
