/* SPDX-License-Identifier: Apache-2.0 */
/* identity.c - see identity.h. */
#include "identity.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <inttypes.h>
#include <string.h>

#define IDENTITY (FP3_ID_LETTERS << FP3_ID_LETTERS_LO | FP3_ISA_REVISION)

const uint32_t fp3_identity_addresses[FP3_IDENTITY_WORDS] = {
#define X(NAME, word) FP3_ADDR_##NAME,
    FP3_SHOWN(X, c)
#undef X
};

static void identity_of(const fp3_config *c, uint32_t words[FP3_IDENTITY_WORDS]) {
    const uint32_t list[FP3_IDENTITY_WORDS] = {
#define X(NAME, word) word,
        FP3_SHOWN(X, c)
#undef X
    };
    memcpy(words, list, sizeof list);
}

int fp3_identity_has(const uint32_t words[FP3_IDENTITY_WORDS], int i) {
    enum {
#define X(NAME, word) AT_##NAME,
        FP3_SHOWN(X, c)
#undef X
    };
    return i != AT_FEATURES_MORE || (words[AT_FEATURES] >> FP3_FEATURES_MORE_LO & 1);
}

static int is_of(const fp3_config *config, const uint32_t words[FP3_IDENTITY_WORDS]) {
    uint32_t expected[FP3_IDENTITY_WORDS];
    identity_of(config, expected);
    return memcmp(expected, words, sizeof expected) == 0;
}

const fp3_config *fp3_identity_find(const uint32_t words[FP3_IDENTITY_WORDS]) {
    for (uint32_t i = 0; i < fp3_config_count; i++)
        if (is_of(&fp3_configs[i], words))
            return &fp3_configs[i];
    return NULL;
}

fp3_status fp3_identity_check_id(uint32_t id, fp3_error *error) {
    if (id == IDENTITY)
        return FP3_OK;
    if (id >> 8 == IDENTITY >> 8)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "the hardware has revision %" PRIu32
                        " of the instruction set, this libfp3 %u: both must come from one version",
                        id & 0xff, (unsigned)FP3_ISA_REVISION);
    return fp3_fail(error, FP3_E_SYSTEM,
                    "the hardware is not FP3: its register id is 0x%08" PRIx32
                    ", expected 0x%08" PRIx32,
                    id, IDENTITY);
}

fp3_status fp3_identity_check(const fp3_config *config, const uint32_t words[FP3_IDENTITY_WORDS],
                              fp3_error *error) {
    uint32_t expected[FP3_IDENTITY_WORDS];
    fp3_status status = fp3_identity_check_id(words[0], error);
    if (status || is_of(config, words))
        return status;
    const fp3_config *found = fp3_identity_find(words);
    if (found)
        return fp3_fail(error, FP3_E_SYSTEM, "the hardware has configuration '%s', not '%s'",
                        found->name, config->name);
    identity_of(config, expected);
    size_t i = 0;
    while (words[i] == expected[i])
        i++;
    return fp3_fail(error, FP3_E_SYSTEM,
                    "the hardware is not configuration '%s': at 0x%04" PRIx32 " it has 0x%08" PRIx32
                    ", expected 0x%08" PRIx32,
                    config->name, fp3_identity_addresses[i], words[i], expected[i]);
}
