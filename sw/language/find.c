/* SPDX-License-Identifier: Apache-2.0 */
/* find.c - integrators by name: those that are built in, and files. */
#include <fp3/model.h>

#include <base/file.h>
#include <gen/integrators.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *path, *text;
} built_in[] = {
#define X(name, text) {#name, "programs/integrators/" #name ".cfg", text},
    FP3_INTEGRATORS(X)
#undef X
};
enum { BUILT_IN = sizeof built_in / sizeof *built_in };

const char *fp3_integrator_name(unsigned number) {
    return number < BUILT_IN ? built_in[number].name : NULL;
}

static fp3_status read_file(const char *path, fp3_integrator **integrator, fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (!status && strlen(text) != size)
        status = fp3_fail(error, FP3_E_PROGRAM, "%s: found a NUL byte, expected text", path);
    if (!status)
        status = fp3_integrator_read(text, path, integrator, error);
    free(text);
    return status;
}

static int is_path(const char *name) {
    const size_t length = strlen(name);
    return strchr(name, '/') || (length >= 4 && strcmp(name + length - 4, ".cfg") == 0);
}

fp3_status fp3_integrator_find(const char *name, fp3_integrator **integrator, fp3_error *error) {
    *integrator = NULL;
    if (is_path(name))
        return read_file(name, integrator, error);
    char names[512] = "";
    for (unsigned i = 0; i < BUILT_IN; i++) {
        if (strcmp(name, built_in[i].name) == 0)
            return fp3_integrator_read(built_in[i].text, built_in[i].path, integrator, error);
        if (strlen(names) + strlen(built_in[i].name) + 3 < sizeof names)
            strcat(strcat(names, i ? ", " : ""), built_in[i].name);
    }
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "no integrator '%s': there are %s, and files that end in .cfg", name, names);
}
