/* SPDX-License-Identifier: Apache-2.0 */
/* bench_files.c - see bench_files.h. */
#include "bench_files.h"

#include "base/file.h"
#include "base/host.h"

#include <string.h>

static void put_text(FILE *out, const char *text) {
    const int is_quoted = strpbrk(text, ",\"\r\n") != NULL;
    if (is_quoted)
        putc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            putc('"', out);
        putc(*text, out);
    }
    if (is_quoted)
        putc('"', out);
}

/* Nothing where there is no value. */
static void put_value(FILE *out, const json_t *value) {
    if (json_is_string(value))
        put_text(out, json_string_value(value));
    else if (json_is_integer(value))
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_real(value))
        fprintf(out, "%.9g", json_real_value(value));
}

static void put_table(FILE *out, const json_t *points) {
    const char *key;
    json_t *value, *point, *first = json_array_get(points, 0);
    size_t i;
    int is_next = 0;
    json_object_foreach(first, key, value) { fprintf(out, "%s%s", is_next++ ? "," : "", key); }
    fputs("\r\n", out);
    json_array_foreach(points, i, point) {
        is_next = 0;
        json_object_foreach(first, key, value) {
            fputs(is_next++ ? "," : "", out);
            put_value(out, json_object_get(point, key));
        }
        fputs("\r\n", out);
    }
}

fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error) {
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(path, &output, error);
    if (status)
        return status;
    FP3_HOST;
    put_table(fp3_output_stream(output), points);
    status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    return status;
}
