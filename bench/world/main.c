/* main.c - build/bench/world: a scene by engine fast, beside a loop written by hand; tools/world.py
 * runs it.
 *
 *     world --scene net.scene --loop net --steps 20 --repeats 9 --json FILE
 *
 * All take turns; the figure is the shortest time. Everyone must end with the words of the loop by
 * hand.
 */
#include "runner.h"

#include "base/file.h"

#include <argp.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *json, *scene, *loop;
    uint64_t steps, before;
    unsigned repeats, threads;
    int is_flipped;
} options;

enum { MOST_THREADS = 64 };

/* ---- turns ---- */

static fp3_status take_turns(const options *o, runner *all, unsigned count, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < count; i++) /* what is needed once */
        status = runner_go(&all[i], o->before, error);
    for (unsigned i = 0; i < count; i++)
        all[i].seconds = 0;
    for (unsigned n = 0; !status && n < o->repeats; n++)
        for (unsigned i = 0; !status && i < count; i++)
            status = runner_go(&all[i], o->steps, error);
    for (unsigned i = 0; !status && i < count; i++)
        status = runner_read(&all[i], error);
    return status;
}

static json_t *row_of(const options *o, const runner *r, const runner *first) {
    const double ns = 1e9 * r->seconds / ((double)o->steps * (double)r->now.objects);
    const double hand = 1e9 * first->seconds / ((double)o->steps * (double)r->now.objects);
    json_t *row = json_pack(
        "{s:s, s:s, s:I, s:I, s:I, s:f, s:I}", "engine", r->loop ? "hand" : "fast", "variant",
        r->loop ? r->loop->kind : "", "threads", (json_int_t)r->threads, "objects",
        (json_int_t)r->now.objects, "steps", (json_int_t)(o->before + o->steps * o->repeats),
        "ns_per_object_step", ns, "words_differing", (json_int_t)runner_differ(r, first));
    if (row && first->loop)
        json_object_set_new(row, "ratio_to_hand", json_real(ns / hand));
    return row;
}

static fp3_status write_rows(const options *o, const runner *all, unsigned count,
                             fp3_error *error) {
    json_t *rows = json_array();
    for (unsigned i = 0; i < count; i++)
        json_array_append_new(rows, row_of(o, &all[i], &all[0]));
    char *text = json_dumps(rows, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    const fp3_status status =
        text ? fp3_file_write(o->json, text, strlen(text), error) : fp3_no_memory(error);
    free(text);
    json_decref(rows);
    return status;
}

static fp3_status measure(const options *o, fp3_error *error) {
    runner all[MOST_THREADS + 1] = {{0}};
    unsigned count = 0;
    fp3_scene *scene = NULL;
    fp3_status status = fp3_scene_open(o->scene, NULL, &scene, error);
    if (!status && o->loop)
        status = runner_open_hand(&all[count++], scene, o->loop, error);
    for (unsigned n = 1; !status && n <= o->threads; n++)
        status = runner_open_fast(&all[count++], scene, n, error);
    if (!status)
        status = take_turns(o, all, count, error);
    if (!status && o->is_flipped)
        all[0].now.v[0][0] = -all[0].now.v[0][0] - 1;
    if (!status)
        status = write_rows(o, all, count, error);
    for (unsigned i = 0; i < count; i++)
        runner_close(&all[i]);
    fp3_scene_close(&scene);
    return status;
}

/* ---- the command ---- */

enum {
    KEY_JSON = 256,
    KEY_SCENE,
    KEY_LOOP,
    KEY_STEPS,
    KEY_BEFORE,
    KEY_REPEATS,
    KEY_THREADS,
    KEY_FLIP
};

static const struct argp_option table[] = {
    {"json", KEY_JSON, "FILE", 0, "Where the figures go", 0},
    {"scene", KEY_SCENE, "FILE", 0, "What is run", 0},
    {"loop", KEY_LOOP, "NAME", 0,
     "By hand, too: net, stars or balls, which the scene's model has to be", 0},
    {"steps", KEY_STEPS, "N", 0, "In a turn (default: 20)", 0},
    {"before", KEY_BEFORE, "N", 0, "Steps before the first turn, which are not timed (default: 1)",
     0},
    {"repeats", KEY_REPEATS, "N", 0, "Turns (default: 9)", 0},
    {"threads", KEY_THREADS, "N", 0, "Of engine fast, 1 to N (default: 2)", 0},
    {"flip", KEY_FLIP, NULL, 0, "Change a word of the first one's, which must be told", 0},
    {0},
};

static uint64_t number(const char *text, uint64_t most, struct argp_state *state) {
    char *end;
    const uint64_t found = strtoull(text, &end, 10);
    if (*end || !found || found > most)
        argp_error(state, "found '%s', expected an integer from 1 to %llu", text,
                   (unsigned long long)most);
    return found;
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case KEY_JSON:
        o->json = text;
        break;
    case KEY_SCENE:
        o->scene = text;
        break;
    case KEY_LOOP:
        o->loop = text;
        break;
    case KEY_STEPS:
        o->steps = number(text, 1000000, state);
        break;
    case KEY_BEFORE:
        o->before = number(text, 100000000, state);
        break;
    case KEY_REPEATS:
        o->repeats = (unsigned)number(text, 1000, state);
        break;
    case KEY_THREADS:
        o->threads = (unsigned)number(text, MOST_THREADS, state);
        break;
    case KEY_FLIP:
        o->is_flipped = 1;
        break;
    case ARGP_KEY_END:
        if (!o->json || !o->scene)
            argp_error(state, "expected --json and --scene");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int main(int argc, char **argv) {
    static const struct argp argp = {.options = table,
                                     .parser = parse,
                                     .doc = "Time of a scene on engine fast, beside a loop written "
                                            "by hand, and words that differ."};
    options o = {.steps = 20, .before = 1, .repeats = 9, .threads = 2};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    fp3_error error = {.text = ""};
    const fp3_status status = measure(&o, &error);
    if (status)
        fprintf(stderr, "world: %s\n", error.text);
    return fp3_exit_code(status);
}
