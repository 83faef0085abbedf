/* memory.c - memory runs out once: at the first allocation, at the second, and so on, until a call
 * needs no more.
 *
 *     memory PROGRAM SCENE [STEP]
 *
 * Each call then fails as it says, or succeeds without it; none crashes, and what is open is
 * closed. Counted are the allocations of our own code: libraries (libconfig, GSL) end the process
 * themselves. STEP: every so many alone, from the hundredth on.
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <fp3/recording.h>
#include <fp3/scene.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef __SANITIZE_ADDRESS__
int main(void) { /* a sanitizer has an allocator of its own */
    printf("0 failed\n");
    return 0;
}
#else

/* ---- the allocator ---- */

extern void *__libc_malloc(size_t size), *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size), *__libc_memalign(size_t to, size_t size);
extern const char __executable_start[], etext[];

static const char *task = "";
static long at,
    left = -1; /* the allocation that fails; how many come before it; below 0: it has come */
static int is_armed;

static int is_out(const void *caller) {
    const char *from = caller;
    return is_armed && from >= __executable_start && from < etext && left-- == 0;
}

#define CALLER __builtin_return_address(0)

void *malloc(size_t size) { return is_out(CALLER) ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) {
    return is_out(CALLER) ? NULL : __libc_calloc(count, size);
}
void *realloc(void *memory, size_t size) {
    return is_out(CALLER) ? NULL : __libc_realloc(memory, size);
}
void *aligned_alloc(size_t to, size_t size) {
    return is_out(CALLER) ? NULL : __libc_memalign(to, size);
}
static char *copy(const char *text, size_t size) {
    char *made = __libc_malloc(size + 1);
    memcpy(made, text, size);
    made[size] = '\0';
    return made;
}
char *strdup(const char *text) { return is_out(CALLER) ? NULL : copy(text, strlen(text)); }
char *strndup(const char *text, size_t most) {
    return is_out(CALLER) ? NULL : copy(text, strnlen(text, most));
}
int asprintf(char **to, const char *format, ...) {
    va_list arguments;
    if (is_out(CALLER))
        return -1;
    va_start(arguments, format);
    const int size = vasprintf(to, format, arguments);
    va_end(arguments);
    return size;
}

/* ---- what is called ---- */

static const char *program_path, *scene_path;
static fp3_error error;

static fp3_status compile(void) {
    fp3_program_def how = fp3_program_default();
    fp3_program *program = NULL;
    char *report = NULL;
    how.compile.config = "many_full";
    const fp3_status status = fp3_program_open(program_path, &how, &program, &report, &error);
    free(report);
    fp3_program_close(&program);
    return status;
}

static fp3_program *ready; /* compiled while there was memory */

static fp3_status run(const char *name) {
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    fp3_params *params = NULL;
    fp3_failure failure;
    def.engine = name;
    def.config = "many_full";
    def.objects = 5;
    def.threads = 1;
    def.is_interpreted = 1;
    def.error = &error;
    fp3_status status = fp3_params_make(&params, &error);
    if (!status)
        status = fp3_params_set(params, "m=1e5+1/7", &error);
    if (!status)
        status = fp3_params_spread(params, "T=1e5:1e30", &error); /* some fail in the run */
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_program_load(ready, params, engine, &error);
    if (!status)
        status = fp3_engine_live(engine, 0, 1, 1, 4);
    if (!status)
        status = fp3_engine_run(engine, 5, NULL);
    if (!status)
        status = fp3_engine_failure(engine, 0, 5, &failure);
    fp3_engine_close(&engine);
    fp3_params_free(&params);
    return status;
}

static fp3_status run_isa(void) { return run("isa"); }
static fp3_status run_fast(void) { return run("fast"); }

static fp3_status open_scene(void) {
    fp3_scene *scene = NULL;
    fp3_engine *engine = NULL;
    fp3_status status = fp3_scene_open(scene_path, NULL, &scene, &error);
    if (!status) {
        fp3_engine_def def = fp3_scene_engine(scene);
        def.engine = "isa";
        def.error = &error;
        status = fp3_engine_open(&def, &engine);
    }
    if (!status)
        status = fp3_scene_load(scene, engine, &error);
    fp3_engine_close(&engine);
    fp3_scene_close(&scene);
    return status;
}

static fp3_status step_batch(void) {
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *batch = NULL;
    float m[5] = {1e5f, 2e5f, 3e5f, 4e5f, 5e5f};
    def.compiled = ready->compiled;
    def.compile.config = "many_full";
    def.objects = 5;
    def.threads = 1;
    def.error = &error;
    fp3_status status = fp3_batch_open(&def, &batch);
    if (!status)
        status = fp3_batch_write(batch, "m", 0, 5, m);
    if (!status)
        status = fp3_batch_run(batch, 3);
    if (!status)
        status = fp3_batch_read(batch, (const char *[]){"v"}, 1, 0, 5, (float *[]){m});
    fp3_batch_close(&batch);
    return status;
}

static fp3_status record(void) {
    fp3_recording_def def = fp3_recording_default();
    fp3_engine_def on = fp3_engine_default();
    fp3_engine *engine = NULL;
    fp3_params *params = NULL;
    fp3_recording *recording = NULL;
    fp3_cost cost;
    on.engine = "isa";
    on.config = "many_full";
    on.objects = 5;
    on.error = &error;
    def.path = "/dev/null";
    def.steps = 4;
    def.every = 2;
    fp3_status status = fp3_params_make(&params, &error);
    if (!status)
        status = fp3_engine_open(&on, &engine);
    if (!status)
        status = fp3_program_load(ready, params, engine, &error);
    if (!status)
        status = fp3_recording_open(&def, ready, params, engine, &recording, &error);
    if (!status)
        status = fp3_recording_run(recording, &cost, &error);
    fp3_recording_close(&recording);
    fp3_engine_close(&engine);
    fp3_params_free(&params);
    return status;
}

/* ---- one after the other ---- */

static void crash(int number) {
    char said[128];
    const int size =
        snprintf(said, sizeof said, "%s: signal %d after allocation %ld\n", task, number, at);
    _exit(size > 0 && write(STDOUT_FILENO, said, (size_t)size) == size ? 1 : 2);
}

static int check(const char *name, fp3_status (*call)(void), long step) {
    int failed = 0;
    long tried = 0;
    task = name;
    for (at = 0;; at += at < 100 ? 1 : step, tried++) {
        error.text[0] = '\0';
        left = at;
        is_armed = 1;
        const fp3_status status = call();
        is_armed = 0;
        if (left >= 0 && !status)
            break;
        if (status == FP3_OK || (status == FP3_E_SYSTEM && *error.text))
            continue;
        printf("%s, allocation %ld: status %d: %s\n", name, at, (int)status, error.text);
        if (left >= 0 || ++failed > 5) /* that is no lack of memory */
            return failed + 1;
    }
    fprintf(stderr, "%s: %ld of %ld allocations\n", name, tried, at);
    return failed;
}

int main(int argc, char **argv) {
    fp3_program_def how = fp3_program_default();
    how.compile.config = "many_full";
    if (argc < 3 || fp3_program_open(argv[1], &how, &ready, NULL, &error)) {
        printf("%s\n", error.text);
        return 1;
    }
    program_path = argv[1];
    scene_path = argv[2];
    const long step = argc > 3 ? strtol(argv[3], NULL, 10) : 1;
    signal(SIGSEGV, crash);
    signal(SIGABRT, crash);
    const int failed = check("isa", run_isa, step) + check("fast", run_fast, step) +
                       check("batch", step_batch, step) + check("recording", record, step) +
                       check("compile", compile, step) + check("scene", open_scene, step);
    printf("%d failed\n", failed);
    fp3_program_close(&ready);
    return failed != 0;
}
#endif
