/* recording_api.c - fp3/recording.h from a program: what it promises, what it refuses. Prints a
 * line for each promise that is broken.
 *
 *     build/tests/recording_api MODEL      writes api.csv
 */
#include <fp3/program.h>
#include <fp3/recording.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition))                                                                          \
            printf("%d: %s: %s\n", __LINE__, #condition, error.text);                              \
    } while (0)

static fp3_error error;
static fp3_recording *recording;
static double last_share;
static unsigned told, sunk;

static void tell(void *user, double share) {
    (void)user;
    const double whole = fp3_recording_share(recording, share);
    sunk += whole < last_share || whole > 1;
    last_share = whole;
    told++;
}

static void refused(fp3_recording_def def, const fp3_program *program, const fp3_params *params,
                    fp3_engine *engine, const char *message) {
    fp3_recording *made = (fp3_recording *)&def;
    CHECK(fp3_recording_open(&def, program, params, engine, &made, &error) == FP3_E_ARGUMENT);
    CHECK(!made && strstr(error.text, message));
    CHECK(access("api.csv", F_OK) != 0);
}

static void refuse(const fp3_program *program, const fp3_params *params, fp3_engine *engine) {
    static const double times[] = {1};
    static const char *const names[] = {"v", "nobody"};
    fp3_recording_def def = fp3_recording_default();
    refused(def, program, params, engine, "no file to record to");
    def.path = "api.csv";
    def.steps = (uint64_t)1 << 32;
    refused(def, program, params, engine, "4294967296 steps");
    def.steps = 9;
    def.every = 2;
    def.times = times;
    def.time_count = 1;
    refused(def, program, params, engine, "at times or after every");
    def.every = 0;
    def.time_count = 0;
    refused(def, program, params, engine, "no times");
    def.times = NULL;
    def.observed = names;
    refused(def, program, params, engine, "nothing is observed");
    def.observed_count = 2;
    refused(def, program, params, engine, "'nobody'");
}

static void record(const fp3_program *program, const fp3_params *params, fp3_engine *engine) {
    fp3_recording_def def = fp3_recording_default();
    fp3_cost cost;
    CHECK(def.steps == 1 && !def.every && !def.path);
    def.path = "api.csv";
    def.steps = 20000;
    def.every = 7001;
    /* Closed before it ran, it leaves nothing. */
    CHECK(!fp3_recording_open(&def, program, params, engine, &recording, &error));
    fp3_recording_close(&recording);
    CHECK(!recording && access("api.csv", F_OK) != 0);
    CHECK(!fp3_recording_open(&def, program, params, engine, &recording, &error));
    CHECK(!fp3_recording_run(recording, &cost, &error));
    CHECK(access("api.csv", F_OK) == 0 && cost.stats.object_steps == 3 * def.steps);
    CHECK(!cost.failure.failed && cost.stats.schedulers == 1);
    CHECK(cost.counter[0][FP3_COUNTER_RETIRED] == cost.stats.counter[FP3_COUNTER_RETIRED]);
    CHECK(told > 10 && !sunk && last_share > 0.9);
    CHECK(fp3_recording_run(recording, NULL, &error) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "one run"));
    fp3_recording_close(&recording);
    fp3_recording_close(&recording);
}

static void refuse_groups(const fp3_program *program, const fp3_params *params,
                          fp3_engine *engine) {
    const fp3_group groups[] = {{.image = program->image, .objects = 1},
                                {.image = program->image, .objects = 2}};
    fp3_recording_def def = fp3_recording_default();
    def.path = "api.csv";
    unlink("api.csv");
    CHECK(!fp3_engine_load_groups(engine, groups, 2));
    def.group = 2;
    refused(def, program, params, engine, "group 2: the engine has 2");
}

int main(int argc, char **argv) {
    fp3_program_def how = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_params *params = NULL;
    fp3_program *program = NULL;
    fp3_engine *engine = NULL;
    def.engine = "isa";
    def.config = how.compile.config = "shared_full";
    def.objects = 3;
    def.error = &error;
    def.progress = tell;
    fp3_status status = argc < 2 ? FP3_E_ARGUMENT : fp3_params_make(&params, &error);
    if (!status)
        status = fp3_program_open(argv[1], &how, &program, NULL, &error);
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_program_load(program, params, engine, &error);
    CHECK(!status);
    if (!status) {
        refuse(program, params, engine);
        record(program, params, engine);
        refuse_groups(program, params, engine);
    }
    fp3_engine_close(&engine);
    fp3_program_close(&program);
    fp3_params_free(&params);
    return fp3_exit_code(status);
}
