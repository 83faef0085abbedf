/* writer_speed.c - how fast recordings are written, whatever the engine: snapshots of a ship's two
 * states.
 *
 *     build/tests/writer_speed OBJECTS SNAPSHOTS FILE [compress]
 *
 * Prints bytes of states, seconds until the file is on the disk, megabytes a second, and the most
 * memory that the process had. For the disk alone: dd if=/dev/zero of=FILE bs=1M count=763
 * conv=fdatasync
 */
#include "record/format.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static const char model_text[] = "state v = 0 [m/s]\nstate s = 0 [m]\nstep 1 [s]\nv' = 1\ns' = v\n";

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Values that differ, and cost little. */
static void fill(const fp3_columns *columns, const fp3_slice *block) {
    const float base = (float)block->number + 0.001f * (float)block->first;
    for (size_t c = 0; c < columns->count; c++)
        for (int i = 0; i < (int)block->count; i++)
            ((float *)columns->list[c].values)[i] = base + 0.001f * (float)i;
}

static fp3_status write_all(const fp3_subject *subject, fp3_error *error) {
    fp3_sink *sink = NULL;
    fp3_status status = fp3_format_of(subject->path)->open(subject, &sink, error);
    for (uint64_t n = 0; !status && n < subject->snapshots; n++) {
        fp3_slice block = {.number = n, .step = n, .time = (double)n};
        for (; !status && block.first < subject->objects; block.first += block.count) {
            const size_t left = subject->objects - block.first, room = subject->columns->room;
            block.count = left < room ? left : room;
            fill(subject->columns, &block);
            status = sink->put(sink, &block, error);
        }
    }
    if (!status)
        status = sink->publish(sink, error);
    if (sink)
        sink->close(sink);
    return status;
}

static fp3_status open_program(fp3_program *program, fp3_error *error) {
    char *report = NULL;
    const fp3_compile_def def = fp3_compile_default();
    fp3_status status =
        fp3_model_read(model_text, strlen(model_text), "ship.ode", &program->model, &report, error);
    free(report);
    if (!status)
        status = fp3_integrator_find("rk4", &program->integrator, error);
    if (!status)
        status = fp3_compile(program->model, program->integrator, &def, &program->compiled, error);
    if (!status)
        program->image = program->compiled->image;
    return status;
}

int main(int argc, char **argv) {
    fp3_error error;
    fp3_program program = {0};
    fp3_columns columns = {0};
    struct rusage used;
    if (argc < 4)
        return 2;
    const fp3_around around = {.count = 0};
    fp3_subject s = {.path = argv[3],
                     .program = &program,
                     .columns = &columns,
                     .around = &around,
                     .objects = strtoull(argv[1], NULL, 10),
                     .snapshots = strtoull(argv[2], NULL, 10),
                     .has_time = 1,
                     .h = 1,
                     .time_unit = "s",
                     .engine = "none",
                     .config = "none",
                     .is_compressed = argc > 4};
    fp3_status status = open_program(&program, &error);
    if (!status)
        status = fp3_columns_open(&program, NULL, 0, s.objects, 0, &columns, &error);
    const double begin = now();
    if (!status)
        status = write_all(&s, &error);
    const double seconds = now() - begin, bytes = 4.0 * (double)(2 * s.objects * s.snapshots);
    getrusage(RUSAGE_SELF, &used);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    else
        printf("%.0f bytes, %.3f s, %.0f MB/s, %ld kB\n", bytes, seconds, bytes / seconds / 1e6,
               used.ru_maxrss);
    fp3_columns_free(&columns);
    fp3_compiled_free(&program.compiled);
    fp3_integrator_free(&program.integrator);
    fp3_model_free(&program.model);
    return fp3_exit_code(status);
}
