/* SPDX-License-Identifier: Apache-2.0 */
/* hardware.c - see hardware.h. */
#include "hardware.h"

#include "engine/common/library.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fp3_status check(const char *path, const char *config, const fp3_rtl_ops *ops,
                        fp3_error *error) {
    if (ops->version != FP3_RTL_VERSION || ops->size != sizeof *ops)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "%s: interface %u of %u bytes, this libfp3 wants %u of %zu: both must come "
                        "from one build",
                        path, (unsigned)ops->version, (unsigned)ops->size, FP3_RTL_VERSION,
                        sizeof *ops);
    if (strcmp(ops->config, config) != 0)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: has configuration '%s'", path, ops->config);
    return FP3_OK;
}

typedef struct {
    char text[64];
} file_name;

static file_name file_of(const char *config) {
    file_name name;
    snprintf(name.text, sizeof name.text, "fp3_%s.so", config);
    return name;
}

int fp3_hardware_is_there(const char *config) { return fp3_library_is_there(file_of(config).text); }

fp3_status fp3_hardware_load(const char *config, fp3_hardware *hardware, fp3_error *error) {
    const file_name name = file_of(config);
    char *path = NULL;
    *hardware = (fp3_hardware){0};
    fp3_status status = fp3_library_load(name.text, "simulated hardware for the rtl engine",
                                         &hardware->library, &path, error);
    if (!status) {
        hardware->ops = fp3_library_symbol(hardware->library, "fp3_rtl_table");
        status = hardware->ops ? check(path, config, hardware->ops, error)
                               : fp3_fail(error, FP3_E_SYSTEM, "%s: no hardware of FP3's", path);
    }
    free(path);
    if (status)
        fp3_hardware_unload(hardware);
    return status;
}

void fp3_hardware_unload(fp3_hardware *hardware) {
    fp3_library_unload(hardware->library);
    *hardware = (fp3_hardware){0};
}
