#include "config.h"

#include <configs.h>
#include <stddef.h>
#include <string.h>

const fp3_config fp3_configs[] = {
#define X(name, ...) {#name, __VA_ARGS__},
    FP3_CONFIGS(X)
#undef X
};
const uint32_t fp3_config_count = sizeof fp3_configs / sizeof *fp3_configs;

const fp3_config *fp3_config_find(const char *name) {
    for (uint32_t i = 0; name && i < fp3_config_count; i++)
        if (strcmp(fp3_configs[i].name, name) == 0)
            return &fp3_configs[i];
    return NULL;
}

uint32_t fp3_config_schedulers(const fp3_config *config) {
    return config->tiles * config->schedulers;
}
