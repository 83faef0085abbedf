/* SPDX-License-Identifier: Apache-2.0 */
/* needs.h - what a program needs of a configuration, and which configuration has it. */
#ifndef FP3_NEEDS_H
#define FP3_NEEDS_H

#include "config.h"

typedef struct {
    uint64_t operations; /* of fp3_operation_bit; fp3_needs_check takes them as given */
    uint32_t registers;  /* of an object */
    uint32_t constants, words;
    int is_visited; /* words: with the loads and stores of a visit */
} fp3_needs;

/* FP3_E_PROGRAM: registers, constants or words are too few. The message says how many are needed,
 * how many there are, and the nearest configuration that the program would fit: the one with the
 * fewest other keys among those for as many objects (one or many). */
fp3_status fp3_needs_check(const fp3_needs *needs, const fp3_config *config, fp3_error *error);

#endif
