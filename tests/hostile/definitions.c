/* definitions.c - what a program gets that was compiled with other headers, or that forgot a
 * default.
 *
 * Of each definition of the library: one that is smaller and one that is larger than the library's,
 * as older and newer headers have it, one of zeros, and one that is as it must be. Prints "NAME:
 * STATUS TEXT" of each call that takes it.
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <fp3/recording.h>
#include <fp3/scene_tune.h>
#include <fp3/tune.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROOM 1024
#define GUARD 0xa5

static const char text[] = "state x = 1\nstep 0.125\nspan 1\nx' = -x\n";
static fp3_error error;
static fp3_program *program;
static fp3_params *params;
static fp3_engine *engine;
static fp3_integrator *integrator;

static void must(int status) {
    if (!status)
        return;
    printf("%s\n", error.text);
    exit(1);
}

/* ---- each definition: its default, and the calls that take it ---- */

static fp3_status use_engine(void *def) {
    fp3_engine_def *of = def;
    fp3_engine *made = NULL;
    of->error = &error;
    const fp3_status status = fp3_engine_open(of, &made);
    fp3_engine_close(&made);
    return status;
}

static fp3_status use_batch(void *def) {
    fp3_batch_def *of = def;
    fp3_batch *made = NULL;
    of->error = &error;
    of->text = text;
    of->text_size = sizeof text - 1;
    const fp3_status status = fp3_batch_open(of, &made);
    fp3_batch_close(&made);
    return status;
}

static fp3_status use_compile(void *def) {
    fp3_compiled *made = NULL;
    const fp3_status status = fp3_compile(program->model, integrator, def, &made, &error);
    fp3_compiled_free(&made);
    return status;
}

static fp3_status use_adaptive(void *def) {
    fp3_model *made = NULL;
    char *report = NULL;
    must(fp3_model_read(text, sizeof text - 1, "text", &made, &report, &error));
    const fp3_status status = fp3_model_adapt(made, def, &error);
    fp3_model_free(&made);
    return status;
}

/* The batch copies what it is given. */
static fp3_status use_batch_adaptive(void *def) {
    fp3_batch_def of = fp3_batch_default();
    of.adaptive = def;
    return use_batch(&of);
}

static fp3_status use_program(void *def) {
    fp3_program *made = NULL;
    const fp3_status status =
        fp3_program_read(text, sizeof text - 1, "text", def, &made, NULL, &error);
    fp3_program_close(&made);
    return status;
}

static fp3_status use_program_file(void *def) {
    fp3_program *made = NULL;
    const fp3_status status = fp3_program_open("none.ode", def, &made, NULL, &error);
    fp3_program_close(&made);
    return status;
}

static fp3_status use_recording(void *def) {
    fp3_recording *made = NULL;
    const fp3_status status = fp3_recording_open(def, program, params, engine, &made, &error);
    fp3_recording_close(&made);
    return status;
}

static fp3_status use_tune(void *def) {
    fp3_tune_def *of = def;
    fp3_tuning *made = NULL;
    of->program = program;
    of->params = params;
    of->config = "none"; /* so that nothing is searched */
    const fp3_status status = fp3_tune(of, &made, &error);
    fp3_tuning_free(&made);
    return status;
}

static fp3_status use_tuning_scene(void *def) {
    const fp3_tuning none = {0};
    char *scene = NULL;
    return fp3_tuning_scene(def, &none, "x.ode", 1, &scene, &error);
}

static fp3_status use_scene_tune(void *def) {
    fp3_scene_tune_def *of = def;
    fp3_scene_tuning *made = NULL;
    of->tolerance = 2; /* so that nothing is searched */
    const fp3_status status = fp3_scene_tune(of, &made, &error);
    fp3_scene_tuning_free(&made);
    return status;
}

static fp3_status use_scene_tuning_text(void *def) {
    const fp3_scene_tuning none = {0};
    char *scene = NULL;
    return fp3_scene_tuning_text(def, &none, NULL, &scene, &error);
}

/* Each call goes by the types of its definition. */
#define MAKER(name)                                                                                \
    static void make_##name(void *def, size_t size) { fp3_##name##_set_default(def, size); }
MAKER(engine)
MAKER(batch)
MAKER(compile)
MAKER(adaptive)
MAKER(program)
MAKER(recording)
MAKER(tune)
MAKER(scene_tune)

static const struct {
    const char *name;
    size_t size;
    void (*make)(void *def, size_t size);
    fp3_status (*use)(void *def);
} definitions[] = {
    {"engine", sizeof(fp3_engine_def), make_engine, use_engine},
    {"batch", sizeof(fp3_batch_def), make_batch, use_batch},
    {"compile", sizeof(fp3_compile_def), make_compile, use_compile},
    {"adaptive", sizeof(fp3_adaptive_def), make_adaptive, use_adaptive},
    {"adaptive", sizeof(fp3_adaptive_def), make_adaptive, use_batch_adaptive},
    {"program", sizeof(fp3_program_def), make_program, use_program},
    {"program", sizeof(fp3_program_def), make_program, use_program_file},
    {"recording", sizeof(fp3_recording_def), make_recording, use_recording},
    {"tune", sizeof(fp3_tune_def), make_tune, use_tune},
    {"tune", sizeof(fp3_tune_def), make_tune, use_tuning_scene},
    {"scene_tune", sizeof(fp3_scene_tune_def), make_scene_tune, use_scene_tune},
    {"scene_tune", sizeof(fp3_scene_tune_def), make_scene_tune, use_scene_tuning_text}};

static void try(size_t i, const char *what, size_t size) {
    _Alignas(16) unsigned char room[ROOM];
    memset(room, size ? GUARD : 0, sizeof room);
    if (size)
        definitions[i].make(room, size);
    for (size_t at = size; size && at < sizeof room; at++)
        if (room[at] != GUARD) {
            printf("%s: wrote beyond %zu bytes\n", definitions[i].name, size);
            return;
        }
    error.text[0] = '\0';
    const fp3_status status = definitions[i].use(room);
    printf("%s %s: %d %s\n", what, definitions[i].name, (int)status, error.text);
}

int main(void) {
    fp3_program_def how = fp3_program_default();
    how.compile.config = "many_full";
    fp3_engine_def def = fp3_engine_default();
    def.engine = "isa";
    def.config = "many_full";
    def.error = &error;
    must(fp3_program_read(text, sizeof text - 1, "text", &how, &program, NULL, &error));
    must(fp3_integrator_find("rk4", &integrator, &error));
    must(fp3_params_make(&params, &error));
    must(fp3_engine_open(&def, &engine));
    must(fp3_program_load(program, params, engine, &error));
    for (size_t i = 0; i < sizeof definitions / sizeof *definitions; i++) {
        try(i, "older", definitions[i].size - 8);
        try(i, "newer", definitions[i].size + 8);
        try(i, "zeros", 0);
        try(i, "right", definitions[i].size);
    }
    fp3_batch *batch = NULL; /* could not be opened */
    float x = 0;
    fp3_failure failure;
    printf("NULL: %d %d %d %d %d %d %d %d %d %d %d %d %d, %zu %d %g\n",
           (int)fp3_batch_run(batch, 1), (int)fp3_batch_set(batch, "x", 1),
           (int)fp3_batch_write(batch, "x", 0, 1, &x),
           (int)fp3_batch_write_double(batch, "x", 0, 1, &(double){0}),
           (int)fp3_batch_read(batch, (const char *[]){"x"}, 1, 0, 1, (float *[]){&x}),
           (int)fp3_batch_read_double(batch, (const char *[]){"x"}, 1, 0, 1,
                                      (double *[]){&(double){0}}),
           (int)fp3_batch_column(batch, "x", &(const float *){NULL}),
           (int)fp3_batch_link(batch, "x", &(fp3_links){0}),
           (int)fp3_batch_link_more(batch, "x", &(fp3_links){0}),
           (int)fp3_batch_unlink(batch, "x", NULL, NULL, 0),
           (int)fp3_batch_add(batch, 1, &(uint64_t){0}), (int)fp3_batch_restart(batch),
           (int)fp3_batch_failure(batch, &failure, NULL), fp3_batch_objects(batch),
           fp3_batch_engine(batch) || fp3_batch_compiled(batch), fp3_batch_time(batch));
    fp3_engine_close(&engine);
    fp3_params_free(&params);
    fp3_integrator_free(&integrator);
    fp3_program_close(&program);
    return 0;
}
