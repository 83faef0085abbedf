/* hooks.c - threads and memory of the caller's, versions, and engines side by side: the results are
 * those of an engine alone.
 *
 *     hooks   prints "ok"; under -fsanitize=thread it is a test of what threads share, too
 */
#include <fp3/engine.h>
#include <fp3/image.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS = 20000, STEPS = 40, THREADS = 3 };

/* x falls like a body in air; y shows what it passes. */
static const char source[] =
    ".state x y\n.param k\nstep:\nmul r9, k, x\nsub x, x, r9\nadd y, y, x\n";

static void expect(int is_kept, const char *what) {
    if (is_kept)
        return;
    printf("expected: %s\n", what);
    exit(1);
}

/* ---- hooks ---- */

typedef struct {
    unsigned calls, tasks;
    size_t held, most; /* bytes */
} counts;

typedef struct {
    fp3_task_fn *task;
    void *of;
    uint32_t number;
} job;

static void *work(void *user) {
    const job *j = user;
    j->task(j->of, j->number);
    return NULL;
}

/* The last number first, each in a thread of its own. */
static void in_threads(void *user, fp3_task_fn *task, void *of, uint32_t count) {
    pthread_t threads[THREADS];
    job jobs[THREADS];
    counts *c = user;
    c->calls++;
    c->tasks += count;
    expect(count >= 1 && count <= THREADS, "no more tasks than threads");
    for (uint32_t i = count; i-- > 0;) {
        jobs[i] = (job){task, of, i};
        expect(!pthread_create(&threads[i], NULL, work, &jobs[i]), "a thread");
    }
    for (uint32_t i = 0; i < count; i++)
        pthread_join(threads[i], NULL);
}

static void *allocate(void *user, size_t size) {
    counts *c = user;
    c->held += size;
    c->most = c->held > c->most ? c->held : c->most;
    void *memory = aligned_alloc(64, size);
    return memory ? memset(memory, 0xa5, size) : NULL; /* whatever is in it */
}

static void release(void *user, void *memory, size_t size) {
    ((counts *)user)->held -= size;
    free(memory);
}

/* ---- runs ---- */

typedef struct {
    const fp3_image *image;
    fp3_engine_def def;
    fp3_error error;
    float x[OBJECTS], y[OBJECTS];
} ships;

static void run(ships *s) {
    fp3_engine *engine = NULL;
    s->def.error = &s->error;
    s->error.text[0] = '\0';
    fp3_status status = fp3_engine_open(&s->def, &engine);
    for (uint32_t i = 0; i < OBJECTS; i++)
        s->x[i] = 1 + (float)i / OBJECTS;
    const uint32_t x = s->image->symbols[0].index, y = s->image->symbols[1].index;
    status = status ? status : fp3_engine_load(engine, s->image);
    status = status ? status : fp3_engine_write(engine, 0, OBJECTS, x, s->x);
    status = status ? status : fp3_engine_set(engine, "k", 0.01f);
    status = status ? status : fp3_engine_run(engine, 1, NULL);
    status = status ? status : fp3_engine_run(engine, STEPS, NULL);
    status = status ? status : fp3_engine_run(engine, STEPS, NULL);
    status = status ? status : fp3_engine_read(engine, 0, OBJECTS, x, s->x);
    status = status ? status : fp3_engine_read(engine, 0, OBJECTS, y, s->y);
    fp3_engine_close(&engine);
    expect(!status, s->error.text);
}

static void *run_in_thread(void *s) {
    run(s);
    return NULL;
}

static int is_same(const ships *a, const ships *b) {
    return !memcmp(a->x, b->x, sizeof a->x) && !memcmp(a->y, b->y, sizeof a->y);
}

static ships *make(const fp3_image *image, uint32_t threads) {
    ships *s = calloc(1, sizeof *s);
    expect(s != NULL, "memory");
    s->image = image;
    s->def = fp3_engine_default();
    s->def.engine = "fast";
    s->def.config = "many_full";
    s->def.objects = OBJECTS;
    s->def.threads = threads;
    s->def.is_interpreted = 1; /* there threads are worth while sooner */
    return s;
}

/* ---- versions ---- */

static void check_version(const fp3_engine_def *def) {
    uint32_t number = 0;
    unsigned a, b, c;
    fp3_engine *engine = NULL;
    fp3_engine_def other = *def;
    fp3_error error = {.text = ""};
    expect(!strcmp(fp3_version(&number), FP3_VERSION), "the version of the headers");
    expect(sscanf(FP3_VERSION, "%u.%u.%u", &a, &b, &c) == 3, "three numbers");
    expect(number == 10000 * a + 100 * b + c && fp3_version(NULL), "the number of the version");
    other.error = &error;
    other.cookie += 8; /* a definition of 8 bytes more */
    expect(fp3_engine_open(&other, &engine) == FP3_E_ARGUMENT && !engine &&
               strstr(error.text, "headers of another version"),
           "a definition of another version is refused");
}

int main(void) {
    fp3_assembly *program = NULL;
    fp3_error error = {.text = ""};
    expect(!fp3_assemble(source, sizeof source - 1, "hooks.s", &program, &error), error.text);
    const fp3_image *image = program->image;
    ships *alone = make(image, 1), *hooked = make(image, THREADS), *a = make(image, 2),
          *b = make(image, 2);
    counts c = {0};
    run(alone);
    hooked->def.tasks = in_threads;
    hooked->def.tasks_user = &c;
    hooked->def.allocator = (fp3_allocator){allocate, release, &c};
    run(hooked);
    expect(is_same(alone, hooked), "the caller's threads change no bit");
    expect(c.calls == 3 && c.tasks > c.calls, "the caller's threads take part");
    expect(c.most >= 3 * OBJECTS * sizeof(float) && !c.held,
           "columns are the caller's memory, and given back");

    pthread_t threads[2];
    expect(!pthread_create(&threads[0], NULL, run_in_thread, a) &&
               !pthread_create(&threads[1], NULL, run_in_thread, b),
           "threads");
    pthread_join(threads[0], NULL);
    pthread_join(threads[1], NULL);
    expect(is_same(alone, a) && is_same(alone, b), "two engines at once are as one alone");
    check_version(&alone->def);
    free(alone);
    free(hooked);
    free(a);
    free(b);
    fp3_assembly_free(&program);
    puts("ok");
    return 0;
}
