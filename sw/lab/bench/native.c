/* SPDX-License-Identifier: Apache-2.0 */
/* native.c - see native.h. */
#include "native.h"

#include "base/cc.h"
#include "base/temporary.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FLAGS_MOST 16

struct fp3_bench_native {
    void *library;
};

static fp3_status compile(const char *text, const char *to, const char *const *flags,
                          fp3_error *error) {
    const char *options[FLAGS_MOST + 6] = {"-std=gnu11", "-w", "-fPIC", "-shared", "-lm"};
    for (unsigned i = 0; i < FLAGS_MOST && flags[i]; i++)
        options[5 + i] = flags[i];
    return fp3_cc_compile(text, options, to, 1, error);
}

static fp3_status load(const char *path, fp3_bench_native *native, fp3_error *error) {
    native->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    return native->library ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
}

/* The file can go as soon as the library is loaded. */
fp3_status fp3_bench_native_open(const char *text, const char *const *flags,
                                 fp3_bench_native **native, fp3_error *error) {
    const char *top = secure_getenv("TMPDIR");
    char library[PATH_MAX];
    fp3_temporary place;
    *native = calloc(1, sizeof **native);
    if (!*native)
        return fp3_no_memory(error);
    top = top && *top ? top : "/tmp";
    if (fp3_temporary_open_in(top, &place)) {
        const fp3_status status = fp3_fail(error, FP3_E_SYSTEM, "%s: %s", top, strerror(errno));
        fp3_bench_native_close(native);
        return status;
    }
    fp3_status status = FP3_OK;
    if (snprintf(library, sizeof library, "%s/" FP3_TEMPORARY_NEW, place.path) >= PATH_MAX)
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: %s", top, strerror(ENAMETOOLONG));
    if (!status)
        status = compile(text, library, flags, error);
    if (!status)
        status = load(library, *native, error);
    fp3_temporary_close(&place);
    if (status)
        fp3_bench_native_close(native);
    return status;
}

void fp3_bench_native_close(fp3_bench_native **native) {
    if (*native && (*native)->library)
        dlclose((*native)->library);
    free(*native);
    *native = NULL;
}

fp3_status fp3_bench_native_find(const fp3_bench_native *native, const char *name, void *function,
                                 fp3_error *error) {
    void *const found = dlsym(native->library, name);
    if (!found)
        return fp3_fail(error, FP3_E_SYSTEM, "the compiled equations have no '%s'", name);
    memcpy(function, &found, sizeof found); /* C has no cast from one to the other */
    return FP3_OK;
}
