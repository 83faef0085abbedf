/* SPDX-License-Identifier: Apache-2.0 */
/* json.c - see json.h. */
#include "json.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_json_write(const char *path, json_t *root, int digits, fp3_error *error) {
    char *text =
        root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION((size_t)digits)) : NULL;
    const fp3_status status =
        text ? fp3_file_write(path, text, strlen(text), error) : fp3_no_memory(error);
    free(text);
    json_decref(root);
    return status;
}

json_t *fp3_json_number(double x) { return isfinite(x) ? json_real(x) : json_null(); }
