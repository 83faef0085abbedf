/* SPDX-License-Identifier: Apache-2.0 */
/* identity.h - which configuration answers on a bus, by the registers that say so. */
#ifndef FP3_IDENTITY_H
#define FP3_IDENTITY_H

#include "machine/config.h"

#include "gen/registers.h"

#define FP3_IDENTITY_WORD(NAME, word) +1
#define FP3_IDENTITY_WORDS (0 FP3_SHOWN(FP3_IDENTITY_WORD, 0))

/* Byte addresses of `id` and of the other registers that describe a build. */
extern const uint32_t fp3_identity_addresses[FP3_IDENTITY_WORDS];
/* Whether hardware that has these words before number i has that one, too; if not, it stands for 0.
 */
int fp3_identity_has(const uint32_t words[FP3_IDENTITY_WORDS], int i);

/* The first named configuration that has these words; NULL: there is none. */
const fp3_config *fp3_identity_find(const uint32_t words[FP3_IDENTITY_WORDS]);
/* FP3_E_SYSTEM: they are not those of the configuration; the message says what they are. */
fp3_status fp3_identity_check(const fp3_config *config, const uint32_t words[FP3_IDENTITY_WORDS],
                              fp3_error *error);
/* FP3_E_SYSTEM: `id` is not that of an FP3 with this instruction set. */
fp3_status fp3_identity_check_id(uint32_t id, fp3_error *error);

#endif
