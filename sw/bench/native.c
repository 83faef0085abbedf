/* native.c - see native.h. */
#include "native.h"

#include <dlfcn.h>
#include <errno.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define FLAGS_MOST 16

extern char **environ;

struct fp3_bench_native {
    void *library;
};

static fp3_status write_text(const char *path, const char *text, fp3_error *error) {
    FILE *to = fopen(path, "w");
    const int failed = !to || fputs(text, to) < 0;
    if ((to && fclose(to)) || failed)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", path, strerror(errno));
    return FP3_OK;
}

/* flags, then the rest: no shell reads any of it. */
static fp3_status compile(const char *from, const char *to, const char *const *flags,
                          fp3_error *error) {
    const char *cc = getenv("CC") ? getenv("CC") : "cc";
    const char *rest[] = {"-std=gnu11", "-w", "-fPIC", "-shared", "-o", to, from, "-lm", NULL};
    char *line[FLAGS_MOST + sizeof rest / sizeof *rest + 1];
    unsigned count = 0;
    line[count++] = (char *)(uintptr_t)cc;
    for (unsigned i = 0; i < FLAGS_MOST && flags[i]; i++)
        line[count++] = (char *)(uintptr_t)flags[i];
    for (unsigned i = 0; i < sizeof rest / sizeof *rest; i++)
        line[count++] = (char *)(uintptr_t)rest[i];
    pid_t child;
    int how = 0;
    const int failed = posix_spawnp(&child, cc, NULL, NULL, line, environ);
    if (failed)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", cc, strerror(failed));
    if (waitpid(child, &how, 0) < 0 || !WIFEXITED(how) || WEXITSTATUS(how))
        return fp3_fail(error, FP3_E_SYSTEM, "%s does not compile the equations", cc);
    return FP3_OK;
}

static fp3_status load(const char *path, fp3_bench_native *native, fp3_error *error) {
    native->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    return native->library ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "%s", dlerror());
}

/* The files can go as soon as the library is loaded. */
fp3_status fp3_bench_native_open(const char *text, const char *const *flags,
                                 fp3_bench_native **native, fp3_error *error) {
    const char *top = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    char folder[4096], source[4200], library[4200];
    snprintf(folder, sizeof folder, "%s/fp3-native-XXXXXX", top);
    *native = calloc(1, sizeof **native);
    if (!*native)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    fp3_status status = FP3_OK;
    if (!mkdtemp(folder)) {
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: %s", folder, strerror(errno));
    } else {
        snprintf(source, sizeof source, "%s/text.c", folder);
        snprintf(library, sizeof library, "%s/text.so", folder);
        status = write_text(source, text, error);
        if (!status)
            status = compile(source, library, flags, error);
        if (!status)
            status = load(library, *native, error);
        remove(source);
        remove(library);
        rmdir(folder);
    }
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
