/* batch_script.c - fp3/batch.h, driven by lines of standard input.
 *
 *     build/tests/batch_script MODEL [-n OBJECTS] [-i INTEGRATOR] [-a ARITHMETIC] [-e ENGINE] [-c
 * CONFIG]
 *                              [-j THREADS] [-h H] [-t TOLERANCE] [-N NATIVE] [-m CONFIG] [-x] [-o]
 * [-f] set NAME VALUE             spread NAME FIRST LAST (every object its own, evenly between)
 *     write NAME FIRST VALUE...  double NAME FIRST VALUE...
 *     step N                     restart
 *     add COUNT                  remove WHICH... (of all handles that were given)
 *     numbers (of all handles, -1: nobody; which handle each number has; how many live)
 *     read NAME...               wide NAME... (in double); a line for each object
 *     beside STRIDE NAME...      move STRIDE NAME... (each object gets the numbers of the next one)
 *     column NAME                (where it is; "none" where there is no such place)
 *     time                       failure
 * What is refused is a line "error STATUS: TEXT". -x: MODEL is a text. -m: the same program is
 * compiled before, for this CONFIG, and handed over. -o: threads and memory are this program's own.
 * -f: a step of which objects fail is an error. -z: nobody lives at first.
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define WORDS 64

static fp3_error error;
static fp3_batch_def def;
static fp3_batch *batch;
static fp3_program *program;

static void say(fp3_status status) {
    if (status)
        printf("error %d: %s\n", (int)status, error.text);
    error.text[0] = '\0';
}

static void spread(const char *name, double first, double last) {
    double *column = calloc(def.objects, sizeof *column);
    for (size_t i = 0; i < def.objects; i++) {
        const double share = def.objects > 1 ? (double)i / (double)(def.objects - 1) : 0;
        column[i] = (1 - share) * first + share * last;
    }
    say(fp3_batch_write_double(batch, name, 0, def.objects, column));
    free(column);
}

static void write_column(char **word, int count, int is_double) {
    float single[WORDS];
    double wide[WORDS];
    for (int i = 0; i < count - 3; i++)
        single[i] = (float)(wide[i] = strtod(word[3 + i], NULL));
    const size_t first = strtoull(word[2], NULL, 10), numbers = (size_t)count - 3;
    say(is_double ? fp3_batch_write_double(batch, word[1], first, numbers, wide)
                  : fp3_batch_write(batch, word[1], first, numbers, single));
}

/* All objects; numbers between are -7. */
static void beside(char **word, int count, int is_move) {
    const size_t stride = strtoull(word[1], NULL, 10), n = def.objects;
    const char *const *names = (const char *const *)(word + 2);
    float *values = malloc((n + 1) * (stride + 1) * sizeof *values);
    for (size_t i = 0; i < (n + 1) * (stride + 1); i++)
        values[i] = -7;
    say(fp3_batch_read_strided(batch, names, (size_t)count - 2, 0, n, values, stride));
    if (is_move)
        say(fp3_batch_write_strided(batch, names, (size_t)count - 2, 0, n - 1, values + stride,
                                    stride));
    for (size_t i = 0; !is_move && i < n; i++)
        for (size_t k = 0; k < stride; k++)
            printf("%.17g%c", (double)values[i * stride + k], k + 1 < stride ? ' ' : '\n');
    free(values);
}

static void read_columns(char **word, int count, int is_double) {
    const size_t names = (size_t)count - 1;
    void *columns[WORDS];
    for (size_t i = 0; i < names; i++)
        columns[i] = calloc(def.objects, sizeof(double));
    const fp3_status status =
        is_double ? fp3_batch_read_double(batch, (const char *const *)(word + 1), names, 0,
                                          def.objects, (double *const *)columns)
                  : fp3_batch_read(batch, (const char *const *)(word + 1), names, 0, def.objects,
                                   (float *const *)columns);
    say(status);
    for (size_t object = 0; !status && object < def.objects; object++)
        for (size_t i = 0; i < names; i++)
            printf("%.17g%c",
                   is_double ? ((double *)columns[i])[object]
                             : (double)((float *)columns[i])[object],
                   i + 1 < names ? ' ' : '\n');
    for (size_t i = 0; i < names; i++)
        free(columns[i]);
}

static void look(const char *name) {
    const float *values = NULL;
    const fp3_status status = fp3_batch_column(batch, name, &values);
    say(status);
    if (!status && !values)
        puts("none");
    for (size_t object = 0; values && object < def.objects; object++)
        printf("%.17g\n", (double)values[object]);
}

static void tell_failure(void) {
    fp3_failure failure;
    char text[FP3_FAILURE_TEXT_SIZE];
    const fp3_status status = fp3_batch_failure(batch, &failure, text);
    say(status);
    if (!status)
        printf("%zu failed: %s\n", failure.failed, text);
}

/* All handles, in the order in which they were given; those of the first objects before. */
static uint64_t handles[4096];
static size_t handle_count;

static void add(size_t count) {
    const fp3_status status = fp3_batch_add(batch, count, handles + handle_count);
    say(status);
    handle_count += status ? 0 : count;
}

static void remove_those(char **word, size_t count) {
    uint64_t those[WORDS];
    for (size_t i = 0; i < count; i++)
        those[i] = handles[strtoull(word[i], NULL, 10)];
    say(fp3_batch_remove(batch, those, count));
}

/* Of each handle, and who has each number. */
static void tell_numbers(void) {
    uint32_t numbers[4096];
    uint64_t now[4096];
    fp3_batch_numbers(batch, handles, handle_count, numbers);
    for (size_t i = 0; i < handle_count; i++)
        printf(i ? " %d" : "%d", (int)numbers[i]);
    puts("");
    say(fp3_batch_handles(batch, 0, def.objects, now));
    for (size_t i = 0; i < def.objects; i++) {
        size_t which = 0;
        while (which < handle_count && handles[which] != now[i])
            which++;
        printf(i ? " %d" : "%d", which < handle_count ? (int)which : -1);
    }
    printf("\n%zu\n", fp3_batch_living(batch));
}

static void obey(char *line) {
    char *word[WORDS];
    int count = 0;
    for (char *w = strtok(line, " \n"); w && count < WORDS; w = strtok(NULL, " \n"))
        word[count++] = w;
    if (!count)
        return;
    if (!strcmp(word[0], "set"))
        say(fp3_batch_set(batch, word[1], strtod(word[2], NULL)));
    else if (!strcmp(word[0], "spread"))
        spread(word[1], strtod(word[2], NULL), strtod(word[3], NULL));
    else if (!strcmp(word[0], "write") || !strcmp(word[0], "double"))
        write_column(word, count, word[0][0] == 'd');
    else if (!strcmp(word[0], "step"))
        say(fp3_batch_run(batch, strtoull(word[1], NULL, 10)));
    else if (!strcmp(word[0], "add"))
        add(strtoull(word[1], NULL, 10));
    else if (!strcmp(word[0], "remove"))
        remove_those(word + 1, (size_t)count - 1);
    else if (!strcmp(word[0], "numbers"))
        tell_numbers();
    else if (!strcmp(word[0], "restart"))
        say(fp3_batch_restart(batch));
    else if (!strcmp(word[0], "read") || !strcmp(word[0], "wide"))
        read_columns(word, count, word[0][0] == 'w');
    else if (!strcmp(word[0], "beside") || !strcmp(word[0], "move"))
        beside(word, count, word[0][0] == 'm');
    else if (!strcmp(word[0], "column"))
        look(word[1]);
    else if (!strcmp(word[0], "time"))
        printf("%.17g\n", fp3_batch_time(batch));
    else if (!strcmp(word[0], "failure"))
        tell_failure();
    else
        abort();
}

/* The tasks that the library gave away, and bytes that it has not given back. */
static unsigned tasks;
static size_t held;

static void own_tasks(void *user, fp3_task_fn *task, void *of, uint32_t count) {
    *(unsigned *)user += count;
    for (uint32_t i = count; i-- > 0;)
        task(of, i);
}

static void *own_memory(void *user, size_t size) {
    *(size_t *)user += size;
    return aligned_alloc(64, size);
}

static void own_release(void *user, void *memory, size_t size) {
    *(size_t *)user -= size;
    free(memory);
}

static fp3_status compile_before(const char *config) {
    fp3_program_def how = fp3_program_default();
    how.integrator = def.integrator;
    how.is_adaptive = def.adaptive != NULL;
    if (def.adaptive)
        how.adaptive = *def.adaptive;
    how.compile = def.compile;
    how.compile.config = config;
    const fp3_status status = fp3_program_open(def.model, &how, &program, NULL, &error);
    def.model = NULL;
    def.compiled = status ? NULL : program->compiled;
    return status;
}

int main(int argc, char **argv) {
    fp3_adaptive_def adaptive = fp3_adaptive_default();
    char line[1024];
    const char *before = NULL;
    int option, is_text = 0;
    def = fp3_batch_default();
    def.error = &error;
    def.may_fail = 1;
    while ((option = getopt(argc, argv, "n:i:a:e:c:j:h:t:N:m:xofz")) != -1)
        switch (option) {
        case 'n':
            def.objects = strtoull(optarg, NULL, 10);
            break;
        case 'i':
            def.integrator = optarg;
            break;
        case 'N':
            def.native = optarg;
            break;
        case 'o':
            def.tasks = own_tasks;
            def.tasks_user = &tasks;
            def.allocator = (fp3_allocator){own_memory, own_release, &held};
            break;
        case 'a':
            def.compile.arithmetic = fp3_arithmetic_find(optarg);
            break;
        case 'e':
            def.engine = optarg;
            break;
        case 'c':
            def.compile.config = optarg;
            break;
        case 'j':
            def.threads = (uint32_t)strtoul(optarg, NULL, 10);
            break;
        case 'h':
            def.h = strtod(optarg, NULL);
            break;
        case 't':
            adaptive.tolerance = strtod(optarg, NULL);
            def.adaptive = &adaptive;
            break;
        case 'f':
            def.may_fail = 0;
            break;
        case 'z':
            def.is_empty = 1;
            break;
        case 'x':
            is_text = 1;
            break;
        case 'm':
            before = optarg;
            break;
        default:
            return 2;
        }
    def.model = is_text ? NULL : argv[optind];
    def.text = is_text ? argv[optind] : NULL;
    def.text_size = is_text ? strlen(argv[optind]) : 0;
    fp3_status status = before ? compile_before(before) : FP3_OK;
    if (!status)
        status = fp3_batch_open(&def, &batch);
    say(status);
    if (!status && !def.is_empty && def.objects <= sizeof handles / sizeof *handles) {
        handle_count = def.objects;
        say(fp3_batch_handles(batch, 0, handle_count, handles));
    }
    while (!status && fgets(line, sizeof line, stdin))
        obey(line);
    fp3_batch_close(&batch);
    fp3_program_close(&program);
    if (held || (def.tasks && !status && !tasks))
        printf("%zu bytes held, %u tasks\n", held, tasks);
    return status ? 1 : 0;
}
