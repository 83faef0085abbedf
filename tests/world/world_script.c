/* world_script.c - runs objects that see each other, as the lines of standard input say.
 *
 *     world_script ENGINE[@CONFIG] THREADS MODEL INTEGRATOR plain|compensated < LINES
 *
 *     objects N                 first
 *     state NAME V0 V1 ...      or param NAME: a value for each object
 *     set NAME OBJECT V
 *     shared NAME V
 *     links NAME A B F1 F2 ...  one entry: object A has the neighbour B
 *     near NAME REACH SKIN X..  with the names of the position's states
 *     none NAME                 no entries
 *     all NAME
 *     live FIRST COUNT BORN GONE    GONE 0: never
 *     load MODEL                another program: objects keep what their registers hold, and lists
 *                               are gone
 *     run STEPS
 *     go STEPS                  an error is printed, and is not the end
 *     print NAME ...            a line of words for each state
 *     flags STEPS               run, and what that raised
 *     failure                   "none", or which
 */
#include <engine/common/inside.h>
#include <fp3/compile.h>
#include <fp3/engine.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE (1 << 20)
#define LISTS 8

typedef struct {
    char name[FP3_NAME_SIZE];
    uint32_t *from, *to;
    float *fields;
    size_t count, each;
} links;

typedef struct {
    fp3_error error;
    fp3_model *model;
    fp3_compiled *compiled;
    fp3_engine *engine;
    size_t objects;
    links lists[LISTS];
    size_t list_count;
} world;

static void need(world *w, fp3_status status) {
    if (!status)
        return;
    printf("error %s\n", w->error.text);
    exit(fp3_exit_code(status));
}

static const char *config = "world";

static void compile(world *w, const char *model, const char *name, int is_compensated) {
    char *report = NULL;
    fp3_integrator *integrator = NULL;
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = is_compensated ? FP3_COMPENSATED : FP3_PLAIN;
    fp3_status status = fp3_model_load(model, &w->model, &report, &w->error);
    if (report)
        fputs(report, stdout);
    free(report);
    need(w, status);
    need(w, fp3_integrator_find(name, &integrator, &w->error));
    need(w, fp3_compile(w->model, integrator, &def, &w->compiled, &w->error));
    fp3_integrator_free(&integrator);
}

/* All objects at first have the model's values. */
static void open(world *w, const char *engine, unsigned threads) {
    const int is_interpreted = strcmp(engine, "interpreter") == 0;
    double params[64] = {0}, initial[64] = {0};
    float inputs[128];
    fp3_engine_def def = fp3_engine_default();
    def.engine = is_interpreted ? "fast" : engine;
    def.is_interpreted = is_interpreted;
    def.config = config;
    def.objects = (uint32_t)w->objects;
    def.threads = threads;
    def.error = &w->error;
    need(w, fp3_engine_open(&def, &w->engine));
    need(w, fp3_engine_load(w->engine, w->compiled->image));
    for (uint32_t i = 0; i < w->model->param_count; i++)
        params[i] = w->model->params[i].value;
    for (uint32_t i = 0; i < w->model->state_count; i++)
        initial[i] = w->model->states[i].value;
    need(w, fp3_compiled_inputs(w->compiled, params, initial, w->model->step, inputs, &w->error));
    for (uint32_t i = 0; i < w->compiled->input_count; i++)
        need(w, fp3_engine_set(w->engine, w->compiled->inputs[i].name, inputs[i]));
}

static void write(world *w, const char *name) {
    const fp3_symbol *s = fp3_image_find(w->compiled->image, name, FP3_CLASSES_OBJECT);
    float *column = calloc(w->objects, sizeof *column);
    for (size_t i = 0; i < w->objects; i++)
        column[i] = strtof(strtok(NULL, " \n"), NULL);
    need(w, s ? fp3_engine_write(w->engine, 0, w->objects, s->index, column)
              : fp3_fail(&w->error, FP3_E_ARGUMENT, "no '%s'", name));
    free(column);
}

static void set(world *w, const char *name) {
    const fp3_symbol *s = fp3_image_find(w->compiled->image, name, FP3_CLASSES_OBJECT);
    const size_t object = strtoul(strtok(NULL, " \n"), NULL, 10);
    const float value = strtof(strtok(NULL, " \n"), NULL);
    need(w, s ? fp3_engine_write(w->engine, object, 1, s->index, &value)
              : fp3_fail(&w->error, FP3_E_ARGUMENT, "no '%s'", name));
}

static void add_link(world *w, const char *name) {
    links *l = w->lists;
    while (l < w->lists + w->list_count && strcmp(l->name, name) != 0)
        l++;
    if (l == w->lists + w->list_count) {
        snprintf(l->name, sizeof l->name, "%s", name);
        w->list_count++;
    }
    l->from = realloc(l->from, (l->count + 1) * sizeof *l->from);
    l->to = realloc(l->to, (l->count + 1) * sizeof *l->to);
    l->fields = realloc(l->fields, (l->count + 1) * 16 * sizeof *l->fields);
    l->from[l->count] = (uint32_t)strtoul(strtok(NULL, " \n"), NULL, 10);
    l->to[l->count] = (uint32_t)strtoul(strtok(NULL, " \n"), NULL, 10);
    l->each = 0;
    for (const char *word = strtok(NULL, " \n"); word; word = strtok(NULL, " \n"))
        l->fields[l->count * 16 + l->each++] = strtof(word, NULL);
    l->count++;
}

/* In the order of the lines. */
static void give(world *w, const links *l) {
    uint32_t *begin = calloc(w->objects + 1, sizeof *begin),
             *other = calloc(l->count + 1, sizeof *other);
    float *fields = calloc(l->count * l->each + 1, sizeof *fields);
    size_t at = 0;
    for (uint32_t i = 0; i < w->objects; i++) {
        for (size_t k = 0; k < l->count; k++) {
            if (l->from[k] != i)
                continue;
            other[at] = l->to[k];
            memcpy(&fields[at * l->each], &l->fields[k * 16], l->each * sizeof *fields);
            at++;
        }
        begin[i + 1] = (uint32_t)at;
    }
    const fp3_neighbours n = {.begin = begin, .other = other, .fields = fields};
    need(w, fp3_engine_set_neighbours(w->engine, 0, l->name, &n));
    free(begin);
    free(other);
    free(fields);
}

/* One entry, of the last object, without all that belongs to it. */
static void give_part(world *w, const char *name) {
    const uint32_t other = 0;
    const int has_other = strcmp(strtok(NULL, " \n"), "fields") == 0;
    uint32_t *begin = calloc(w->objects + 1, sizeof *begin);
    begin[w->objects] = 1;
    need(w, fp3_engine_set_neighbours(
                w->engine, 0, name,
                &(fp3_neighbours){.begin = begin, .other = has_other ? &other : NULL}));
    free(begin);
}

static void give_near(world *w, const char *name) {
    fp3_near near = {.reach = strtod(strtok(NULL, " \n"), NULL)};
    near.skin = strtod(strtok(NULL, " \n"), NULL);
    for (const char *word = strtok(NULL, " \n"); word && near.dimensions < 3;
         word = strtok(NULL, " \n"))
        near.position[near.dimensions++] = word;
    need(w, fp3_engine_set_near(w->engine, 0, name, &near));
}

static void run(world *w, uint64_t steps, fp3_stats *stats) {
    for (size_t i = 0; i < w->list_count; i++)
        give(w, &w->lists[i]);
    for (size_t i = 0; i < w->list_count; i++) {
        free(w->lists[i].from);
        free(w->lists[i].to);
        free(w->lists[i].fields);
        w->lists[i] = (links){0};
    }
    w->list_count = 0;
    need(w, fp3_engine_run(w->engine, steps, stats));
}

static void print(world *w, const char *name) {
    const fp3_symbol *s = fp3_image_find(w->compiled->image, name, FP3_CLASSES_OBJECT);
    uint32_t *column = calloc(w->objects, sizeof *column);
    need(w, s ? fp3_engine_read_words(w->engine, 0, w->objects, s->index, column)
              : fp3_fail(&w->error, FP3_E_ARGUMENT, "no '%s'", name));
    for (size_t i = 0; i < w->objects; i++)
        printf("%s%08x", i ? " " : "", column[i]);
    printf("\n");
    free(column);
}

static void say_failure(world *w) {
    fp3_failure failure;
    char text[FP3_FAILURE_TEXT_SIZE] = "none";
    need(w, fp3_engine_failure(w->engine, 0, w->objects, &failure));
    if (failure.failed)
        fp3_engine_failure_text(w->engine, &failure, text);
    printf("%s\n", text);
}

static void load(world *w, const char *model) {
    fp3_compiled_free(&w->compiled);
    fp3_model_free(&w->model);
    compile(w, model, "euler", 0);
    need(w, fp3_engine_load(w->engine, w->compiled->image));
    need(w, fp3_engine_set(w->engine, "h", (float)w->model->step));
}

static void give_none(world *w, const char *name) {
    uint32_t *begin = calloc(w->objects + 1, sizeof *begin), other = 0;
    const float field = 0;
    need(w, fp3_engine_set_neighbours(
                w->engine, 0, name,
                &(fp3_neighbours){.begin = begin, .other = &other, .fields = &field}));
    free(begin);
}

static void live(world *w, const char *first) {
    const size_t from = strtoul(first, NULL, 10), count = strtoul(strtok(NULL, " \n"), NULL, 10);
    const uint64_t born = strtoull(strtok(NULL, " \n"), NULL, 10);
    const uint64_t gone = strtoull(strtok(NULL, " \n"), NULL, 10);
    need(w, fp3_engine_live(w->engine, from, count, born, gone ? gone : FP3_FOREVER));
}

static void obey(world *w, char *line, const char *engine, unsigned threads) {
    const char *what = strtok(line, " \n"), *name = strtok(NULL, " \n");
    if (!what)
        return;
    if (strcmp(what, "objects") == 0) {
        w->objects = strtoul(name, NULL, 10);
        open(w, engine, threads);
    } else if (strcmp(what, "state") == 0 || strcmp(what, "param") == 0) {
        write(w, name);
    } else if (strcmp(what, "set") == 0) {
        set(w, name);
    } else if (strcmp(what, "shared") == 0) {
        need(w, fp3_engine_set(w->engine, name, strtof(strtok(NULL, " \n"), NULL)));
    } else if (strcmp(what, "links") == 0) {
        add_link(w, name);
    } else if (strcmp(what, "without") == 0) {
        give_part(w, name);
    } else if (strcmp(what, "near") == 0) {
        give_near(w, name);
    } else if (strcmp(what, "all") == 0) {
        need(w, fp3_engine_set_neighbours(w->engine, 0, name, &(fp3_neighbours){0}));
    } else if (strcmp(what, "none") == 0) {
        give_none(w, name);
    } else if (strcmp(what, "live") == 0) {
        live(w, name);
    } else if (strcmp(what, "load") == 0) {
        load(w, name);
    } else if (strcmp(what, "run") == 0) {
        run(w, strtoull(name, NULL, 10), NULL);
    } else if (strcmp(what, "go") == 0) {
        if (fp3_engine_run(w->engine, strtoull(name, NULL, 10), NULL))
            printf("error %s\n", w->error.text);
    } else if (strcmp(what, "flags") == 0) {
        fp3_stats stats;
        run(w, strtoull(name, NULL, 10), &stats);
        printf("%02x\n", (unsigned)stats.flags);
    } else if (strcmp(what, "failure") == 0) {
        say_failure(w);
    } else {
        for (; name; name = strtok(NULL, " \n"))
            print(w, name);
    }
}

int main(int argc, char **argv) {
    static char line[LINE];
    static world w;
    if (argc != 6)
        return 2;
    char *at = strchr(argv[1], '@');
    if (at) {
        *at = '\0';
        config = at + 1;
    }
    compile(&w, argv[3], argv[4], strcmp(argv[5], "compensated") == 0);
    while (fgets(line, sizeof line, stdin))
        obey(&w, line, argv[1], (unsigned)strtoul(argv[2], NULL, 10));
    fp3_engine_close(&w.engine);
    fp3_compiled_free(&w.compiled);
    fp3_model_free(&w.model);
    return 0;
}
