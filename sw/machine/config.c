/* SPDX-License-Identifier: Apache-2.0 */
#include "config.h"

#include <assert.h>
#include <string.h>

const fp3_config fp3_configs[] = {FP3_CONFIG_ROWS};
const uint32_t fp3_config_count = sizeof fp3_configs / sizeof *fp3_configs;

static const struct {
    const char *name, *lack;
    const char *choices[6];
    size_t offset;
} keys[] = {FP3_KEY_ROWS};

const fp3_config *fp3_config_find(const char *name) {
    for (uint32_t i = 0; name && i < fp3_config_count; i++)
        if (strcmp(fp3_configs[i].name, name) == 0)
            return &fp3_configs[i];
    return NULL;
}

fp3_status fp3_config_choose(const char *name, const fp3_config **config, fp3_error *error) {
    char names[512] = "";
    *config = fp3_config_find(name);
    if (*config)
        return FP3_OK;
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
        strncat(names, fp3_configs[i].name, sizeof names - strlen(names) - 1);
    }
    return fp3_fail(error, FP3_E_ARGUMENT, "no configuration '%s': there are %s", name ? name : "",
                    names);
}

int fp3_config_computes_as(const fp3_config *config, const fp3_config *other) {
    return fp3_config_words(config) == fp3_config_words(other) && config->fused == other->fused &&
           config->storage == other->storage;
}

uint32_t fp3_config_words(const fp3_config *config) {
    const fp3_image_words kind =
        config->logarithmic ? FP3_WORDS_LOGARITHMS
        : config->finite    ? FP3_WORDS_CELL
        : !config->nearest ? (config->subnormal ? FP3_WORDS_TRUNCATED : FP3_WORDS_TRUNCATED_FLUSHED)
        : !config->subnormal ? FP3_WORDS_FLUSHED
        : config->mixed      ? FP3_WORDS_MIXED
                             : FP3_WORDS_FLOATS;
    return (uint32_t)kind + FP3_WORDS_FEWER * (FP3_WORDS_FRACTION - config->fraction);
}

uint32_t fp3_config_schedulers(const fp3_config *config) {
    return config->tiles * config->schedulers;
}

uint32_t fp3_config_broadcast(const fp3_config *config) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    uint32_t all = 0;
    while (schedulers > 1 && all < schedulers)
        all = 2 * all + 1;
    return all;
}

uint32_t fp3_config_value(const fp3_config *config, fp3_key key) {
    assert(key < FP3_KEY_COUNT);
    uint32_t value;
    memcpy(&value, (const char *)config + keys[key].offset, sizeof value);
    return value;
}

const char *fp3_key_name(fp3_key key) {
    assert(key < FP3_KEY_COUNT);
    return keys[key].name;
}

const char *fp3_key_choice(fp3_key key, uint32_t value) {
    assert(key < FP3_KEY_COUNT);
    return value < sizeof keys->choices / sizeof *keys->choices ? keys[key].choices[value] : NULL;
}

const char *fp3_key_lack(fp3_key key) {
    assert(key < FP3_KEY_COUNT);
    return keys[key].lack;
}
