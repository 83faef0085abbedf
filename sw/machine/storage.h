/* SPDX-License-Identifier: Apache-2.0 */
/* storage.h - records of 16 bits (key `storage`): what a store makes of a word, and how it draws
 * where it rounds at random.
 *
 *     uint32_t flags;
 *     const fp3_draw draw = {.seed = fp3_storage_seed(1), .object = 5, .step = 12, .reg = 0};
 *     record = fp3_stored(config, word, &draw, &flags);
 *
 * Every engine has the record's number as the binary32 word that a load gives; only hardware has
 * its 16 bits.
 */
#ifndef FP3_STORAGE_H
#define FP3_STORAGE_H

#include "config.h"

#include <stdint.h>

/* Which store of a run. */
typedef struct {
    uint32_t seed; /* of fp3_storage_seed; 0: to nearest, ties to even */
    uint32_t object, step, reg;
} fp3_draw;

/* The word that a load gives after the store of this one. draw may be NULL: to nearest. *flags:
 * overflow and inexact if a finite number became infinite; nothing else is raised. */
uint32_t fp3_stored(const fp3_config *config, uint32_t word, const fp3_draw *draw, uint32_t *flags);

/* The register `seed` of a run whose caller has chosen this seed; 0: 0. */
uint32_t fp3_storage_seed(uint32_t seed);

/* From 0 on to here, every integer is exact in a record. */
uint32_t fp3_storage_counts(const fp3_config *config);

/* "binary16", and the largest number of its records. */
const char *fp3_storage_name(const fp3_config *config);
float fp3_storage_most(const fp3_config *config);

#endif
