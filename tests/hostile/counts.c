/* counts.c - every count of engine.h, batch.h and program.h at its ends: 0, 1, all, one more,
 * SIZE_MAX, and where first + count overflows. Each call ends with the status in its row and
 * touches no memory but its own: room is exact, so that a sanitizer sees more, and what stands
 * behind it is looked at.
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <fp3/recording.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OBJECTS 5u
#define MARK 0x5a

typedef struct {
    fp3_engine *engine; /* adaptive steps, loaded and run */
    fp3_batch *batch;
    fp3_program *program;
    fp3_params *params;
    fp3_error error;
    size_t registers;
    void *room; /* of all objects, and a mark behind them */
} bench;

typedef fp3_status call(bench *b, size_t first, size_t count);

/* ---- the calls with a first and a count ---- */

#define CALL(name, expression)                                                                     \
    static fp3_status name(bench *b, size_t first, size_t count) {                                 \
        (void)first;                                                                               \
        (void)count;                                                                               \
        return expression;                                                                         \
    }

CALL(engine_write, fp3_engine_write(b->engine, first, count, 0, b->room))
CALL(engine_read, fp3_engine_read(b->engine, first, count, 0, b->room))
CALL(engine_status, fp3_engine_status(b->engine, first, count, b->room))
CALL(engine_clear, fp3_engine_clear_status(b->engine, first, count))
CALL(engine_failure, fp3_engine_failure(b->engine, first, count, b->room))
CALL(engine_wake, fp3_engine_wake(b->engine, first, count))
CALL(engine_remove, fp3_engine_remove(b->engine, first, count))
CALL(engine_live, fp3_engine_live(b->engine, first, count, 0, FP3_FOREVER))
CALL(engine_report, fp3_adaptive_report_make(b->engine, first, count, b->room))
CALL(batch_write, fp3_batch_write(b->batch, "v", first, count, b->room))
CALL(batch_write_double, fp3_batch_write_double(b->batch, "v", first, count, b->room))
CALL(batch_write_param, fp3_batch_write(b->batch, "k", first, count, b->room))
CALL(batch_read,
     fp3_batch_read(b->batch, (const char *[]){"v"}, 1, first, count, (float *[]){b->room}))
CALL(batch_read_double,
     fp3_batch_read_double(b->batch, (const char *[]){"k"}, 1, first, count, (double *[]){b->room}))

/* Of these the count is of registers. */
CALL(write_shared, fp3_engine_write_shared(b->engine, (uint32_t)first, count, b->room))
CALL(read_shared, fp3_engine_read_shared(b->engine, (uint32_t)first, count, b->room))

static fp3_status read_no_columns(bench *b, size_t first, size_t count) {
    return fp3_batch_read(b->batch, NULL, 0, first, count, NULL);
}

/* ---- one number ---- */

CALL(get_state, fp3_engine_get(b->engine, first, "v_x", b->room))
CALL(get_shared, fp3_engine_get(b->engine, first, "until", b->room))
CALL(look, fp3_adaptive_look(b->engine, first, b->room))
CALL(life, fp3_engine_life(b->engine, first) == FP3_ALIVE ? FP3_OK : FP3_E_ARGUMENT)
CALL(counters, fp3_engine_scheduler_counters(b->engine, (uint32_t)first, b->room))
CALL(share, fp3_engine_scheduler_share(b->engine, (uint32_t)first, b->room))
CALL(group, fp3_engine_read_shared_of(b->engine, first, 0, 1, b->room))
CALL(group_steps, fp3_engine_group_steps(b->engine, first) ? FP3_OK : FP3_E_ARGUMENT)

static const fp3_image *image(const bench *b) { return b->program->image; }

static fp3_status groups(bench *b, size_t first, size_t count) {
    const fp3_group all = {.image = image(b), .objects = OBJECTS};
    (void)first;
    return fp3_engine_load_groups(b->engine, &all, count);
}

static fp3_status group_of(bench *b, size_t first, size_t objects) {
    const fp3_group two[] = {{.image = image(b), .objects = first},
                             {.image = image(b), .objects = objects}};
    return fp3_engine_load_groups(b->engine, two, 2);
}

static fp3_status open_engine(bench *b, size_t objects, size_t threads) {
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    def.engine = "fast";
    def.config = "many_full";
    def.objects = (uint32_t)objects;
    def.threads = (uint32_t)threads;
    def.error = &b->error;
    const fp3_status status = fp3_engine_open(&def, &engine);
    fp3_engine_close(&engine);
    return status;
}

static const char model[] = "param k = 1\nstate v = 1\nstep 0.125\nv' = -k*v\n";

static fp3_status open_batch(bench *b, size_t objects, size_t size) {
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *batch = NULL;
    def.text = model;
    def.text_size = size;
    def.objects = objects;
    def.error = &b->error;
    const fp3_status status = fp3_batch_open(&def, &batch);
    fp3_batch_close(&batch);
    return status;
}

static fp3_status record(bench *b, size_t observed, size_t times) {
    static const char *const names[] = {"v_x", "v_y", "v_x"};
    static const double at[] = {0.5, 1};
    fp3_recording_def def = fp3_recording_default();
    fp3_recording *recording = NULL;
    def.path = "/dev/null";
    def.observed = names;
    def.observed_count = observed;
    def.times = at;
    def.time_count = times;
    const fp3_status status =
        fp3_recording_open(&def, b->program, b->params, b->engine, &recording, &b->error);
    fp3_recording_close(&recording);
    return status;
}

CALL(run, fp3_engine_run(b->engine, first, NULL))
CALL(step_batch, fp3_batch_run(b->batch, first))

/* ---- the rows ---- */

/* {first, count} and what the calls of `ranges` say; `all` stands for OBJECTS or all registers. */
static int check_range(bench *b, const char *name, call *call, size_t all) {
    const struct {
        size_t first, count;
        fp3_status status;
    } rows[] = {
        {0, 0, FP3_OK},
        {0, 1, FP3_OK},
        {0, all, FP3_OK},
        {all - 1, 1, FP3_OK},
        {all, 0, FP3_OK},
        {0, all + 1, FP3_E_ARGUMENT},
        {all, 1, FP3_E_ARGUMENT},
        {all + 1, 0, FP3_E_ARGUMENT},
        {1, SIZE_MAX, FP3_E_ARGUMENT},
        {0, SIZE_MAX, FP3_E_ARGUMENT},
        {2, SIZE_MAX - 1, FP3_E_ARGUMENT},
        {0, SIZE_MAX / 4, FP3_E_ARGUMENT},
        {all - 1, (size_t)UINT32_MAX + 2, FP3_E_ARGUMENT},
    };
    int failed = 0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        memset(b->room, 0, all * sizeof(double));
        const fp3_status status = call(b, rows[i].first, rows[i].count);
        if (status == rows[i].status)
            continue;
        printf("%s, first %zu, count %zu: status %d, expected %d: %s\n", name, rows[i].first,
               rows[i].count, (int)status, (int)rows[i].status, b->error.text);
        failed++;
    }
    return failed;
}

static int check_ranges(bench *b) {
    static const struct {
        const char *name;
        call *call;
        int is_of_registers;
    } ranges[] = {
#define RANGE(name, is_of_registers) {#name, name, is_of_registers}
        RANGE(engine_write, 0),      RANGE(engine_read, 0), RANGE(engine_status, 0),
        RANGE(engine_clear, 0),      RANGE(engine_wake, 0), RANGE(engine_live, 0),
        RANGE(engine_report, 0),     RANGE(batch_write, 0), RANGE(batch_write_double, 0),
        RANGE(batch_write_param, 0), RANGE(batch_read, 0),  RANGE(batch_read_double, 0),
        RANGE(write_shared, 1),      RANGE(read_shared, 1), RANGE(engine_remove, 0),
    };
    int failed = 0;
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        failed += check_range(b, ranges[i].name, ranges[i].call,
                              ranges[i].is_of_registers ? b->registers : OBJECTS);
    fp3_engine_wake(b->engine, 0, OBJECTS);
    fp3_engine_run(b->engine, 1, NULL);
    return failed + check_range(b, "engine_failure", engine_failure, OBJECTS) +
           (read_no_columns(b, 0, SIZE_MAX) != FP3_OK);
}

static int check_numbers(bench *b) {
    const struct {
        const char *name;
        call *call;
        size_t first, count;
        fp3_status status;
    } rows[] = {
#define ROW(name, first, count, status) {#name, name, first, count, status}
        ROW(get_state, OBJECTS - 1, 0, FP3_OK),
        ROW(get_state, OBJECTS, 0, FP3_E_ARGUMENT),
        ROW(get_shared, OBJECTS - 1, 0, FP3_OK),
        ROW(get_shared, OBJECTS, 0, FP3_E_ARGUMENT),
        ROW(get_shared, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(look, OBJECTS - 1, 0, FP3_OK),
        ROW(look, OBJECTS, 0, FP3_E_ARGUMENT),
        ROW(look, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(life, OBJECTS - 1, 0, FP3_OK),
        ROW(life, OBJECTS, 0, FP3_E_ARGUMENT),
        ROW(life, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(counters, 0, 0, FP3_OK),
        ROW(counters, UINT32_MAX, 0, FP3_E_ARGUMENT),
        ROW(share, 0, 0, FP3_OK),
        ROW(share, UINT32_MAX, 0, FP3_E_ARGUMENT),
        ROW(group, 0, 0, FP3_OK),
        ROW(group, 1, 0, FP3_E_ARGUMENT),
        ROW(group, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(group_steps, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(run, (size_t)UINT32_MAX + 1, 0, FP3_E_ARGUMENT),
        ROW(run, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(run, 0, 0, FP3_OK),
        ROW(step_batch, 0, 0, FP3_OK),
        ROW(step_batch, 1, 0, FP3_OK),
        ROW(step_batch, SIZE_MAX, 0, FP3_E_ARGUMENT),
        ROW(record, 0, 2, FP3_E_ARGUMENT),
        ROW(record, 1, 1, FP3_OK),
        ROW(record, 2, 2, FP3_OK),
        ROW(record, SIZE_MAX, 1, FP3_E_ARGUMENT),
        ROW(record, SIZE_MAX - 1, 1, FP3_E_ARGUMENT),
        ROW(record, 1, 0, FP3_E_ARGUMENT),
        ROW(record, 1, SIZE_MAX, FP3_E_SYSTEM), /* no memory for so many times */
        ROW(group_of, OBJECTS, 0, FP3_E_ARGUMENT),
        ROW(group_of, 1, SIZE_MAX, FP3_E_ARGUMENT),
        ROW(group_of, 2, OBJECTS - 1, FP3_E_ARGUMENT),
        ROW(group_of, 1, OBJECTS - 2, FP3_E_ARGUMENT),
        ROW(groups, 0, 0, FP3_E_ARGUMENT),
        ROW(groups, 0, SIZE_MAX, FP3_E_PROGRAM), /* more than there are schedulers */
        ROW(groups, 0, 1, FP3_OK),
        ROW(open_engine, 1, 1, FP3_OK),
        ROW(open_engine, 1, 1024, FP3_OK),
        ROW(open_engine, 1, 1025, FP3_E_ARGUMENT),
        ROW(open_engine, 1, UINT32_MAX, FP3_E_ARGUMENT),
        ROW(open_engine, (1u << 25) + 1, 1, FP3_E_ARGUMENT),
        ROW(open_engine, UINT32_MAX, 1, FP3_E_ARGUMENT),
        ROW(open_batch, 0, sizeof model - 1, FP3_E_ARGUMENT),
        ROW(open_batch, 1, sizeof model - 1, FP3_OK),
        ROW(open_batch, (1u << 25) + 1, sizeof model - 1, FP3_E_ARGUMENT),
        ROW(open_batch, (size_t)UINT32_MAX + 2, sizeof model - 1, FP3_E_ARGUMENT),
        ROW(open_batch, SIZE_MAX, sizeof model - 1, FP3_E_ARGUMENT),
        ROW(open_batch, 1, 0, FP3_E_PROGRAM),
        ROW(open_batch, 1, SIZE_MAX, FP3_E_PROGRAM),
    };
    int failed = 0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const fp3_status status = rows[i].call(b, rows[i].first, rows[i].count);
        if (status == rows[i].status)
            continue;
        printf("%s, %zu, %zu: status %d, expected %d: %s\n", rows[i].name, rows[i].first,
               rows[i].count, (int)status, (int)rows[i].status, b->error.text);
        failed++;
    }
    return failed;
}

/* ---- what they are called with ---- */

static fp3_status open_all(bench *b, const char *path, const char *engine) {
    fp3_program_def how = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_batch_def columns = fp3_batch_default();
    columns.text = model;
    columns.text_size = sizeof model - 1;
    columns.objects = OBJECTS;
    how.compile.config = def.config = "shared_full";
    how.is_adaptive = 1;
    def.engine = engine;
    def.objects = OBJECTS;
    def.is_without_compiler = 1;
    def.error = columns.error = &b->error;
    fp3_status status = fp3_program_open(path, &how, &b->program, NULL, &b->error);
    if (!status)
        status = fp3_params_make(&b->params, &b->error);
    if (!status)
        status = fp3_engine_open(&def, &b->engine);
    if (!status)
        status = fp3_program_load(b->program, b->params, b->engine, &b->error);
    return status ? status : fp3_batch_open(&columns, &b->batch);
}

int main(int argc, char **argv) {
    bench b = {.registers = 64};
    if (argc != 3)
        return 2;
    const size_t size = b.registers * sizeof(double) + sizeof(fp3_adaptive_report);
    char *room = b.room = malloc(size + 1);
    if (!room || open_all(&b, argv[1], argv[2])) {
        printf("%s\n", b.error.text);
        return 1;
    }
    room[size] = MARK;
    const int failed = check_ranges(&b) + check_numbers(&b) + (room[size] != MARK);
    printf("%d failed\n", failed);
    fp3_batch_close(&b.batch);
    fp3_engine_close(&b.engine);
    fp3_params_free(&b.params);
    fp3_program_close(&b.program);
    free(room);
    return failed != 0;
}
