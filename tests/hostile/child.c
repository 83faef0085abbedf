/* child.c - a process that has an engine forks, and both go on with it: each has its own from then
 * on.
 *
 *     child PROGRAM ENGINE
 *
 * Ends with 1 if the child does not come to the values of its parent within 20 seconds, or an
 * engine has a thread before its first run.
 */
#include <dirent.h>
#include <fp3/program.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static fp3_error error;

static int run(fp3_engine *engine, float *v) {
    return fp3_engine_run(engine, 5, NULL) || fp3_engine_get(engine, 0, "v", v);
}

static int count_threads(void) {
    DIR *tasks = opendir("/proc/self/task");
    int count = 0;
    for (const struct dirent *task; tasks && (task = readdir(tasks));)
        count += task->d_name[0] != '.';
    if (tasks)
        closedir(tasks);
    return count;
}

int main(int argc, char **argv) {
    fp3_program_def how = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_program *program = NULL;
    fp3_params *params = NULL;
    fp3_engine *engine = NULL;
    float v = 0, of_child = 0;
    int ends[2], state = 1;
    how.compile.config = def.config = "many_full";
    def.engine = argc == 3 ? argv[2] : "";
    def.objects = 2;
    def.is_interpreted = 1;
    def.error = &error;
    if (argc != 3 || pipe(ends) || fp3_program_open(argv[1], &how, &program, NULL, &error) ||
        fp3_params_make(&params, &error) || fp3_engine_open(&def, &engine) ||
        fp3_program_load(program, params, engine, &error) || run(engine, &v)) {
        printf("%s\n", error.text);
        return 1;
    }
    const int threads = count_threads();
    const pid_t child = fork();
    if (!child) {
        alarm(20);
        const int failed = run(engine, &of_child);
        fp3_engine_close(&engine);
        return failed || write(ends[1], &of_child, sizeof of_child) != sizeof of_child;
    }
    const int failed = run(engine, &v);
    waitpid(child, &state, 0);
    if (state || read(ends[0], &of_child, sizeof of_child) != sizeof of_child)
        of_child = -1;
    fp3_engine_close(&engine);
    fp3_params_free(&params);
    fp3_program_close(&program);
    printf("%d threads, %s\n", threads, !failed && v == of_child ? "the same" : "not the same");
    return failed || v != of_child;
}
