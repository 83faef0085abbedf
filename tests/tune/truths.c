/* Truths at several times in one go are those of one time after the other, and so are those of a
 * path.
 *
 *     truths MODEL...            for each: its name, the largest distances, that times go upwards,
 * and how far the start of stoermer_verlet is from the truth truths MODEL NAME=VALUE... of one
 * object, and times from standard input: the states and their sizes
 */
#include "compiler/backwards.h"
#include "lab/truth/path.h"

#include <fp3/truth.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TIMES 3
#define STATES 8 /* of a model at most */
#define MANY 2500

static double farthest(const fp3_model *model, const double *params, const double *initial) {
    double rows[TIMES * STATES], sizes[STATES], one[STATES], times[TIMES], most = 0;
    fp3_error error;
    if (model->state_count > STATES)
        return INFINITY;
    for (int i = 0; i < TIMES; i++)
        times[i] = model->span * (i + 1) / 7;
    if (fp3_model_truths(model, params, initial, times, TIMES, rows, sizes, &error))
        return INFINITY;
    for (int i = 0; i < TIMES; i++) {
        if (fp3_model_truth(model, params, initial, times[i], one, &error))
            return INFINITY;
        for (uint32_t k = 0; k < model->state_count; k++)
            most = fmax(most, fabs(one[k] - rows[i * (int)model->state_count + (int)k]) / sizes[k]);
    }
    return most;
}

/* From a path at uneven times, by the truths at these. */
static double strays(const fp3_model *model, const double *params, const double *initial) {
    static double times[MANY], rows[MANY * 16];
    double sizes[16], there[16], most = 0;
    fp3_error error;
    fp3_path *path = NULL;
    uint32_t seed = 1;
    for (int i = 0; i < MANY; i++) {
        seed = seed * 1664525 + 1013904223;
        times[i] = model->span * (i + 1 - seed * 0x1p-32) / MANY;
    }
    times[MANY - 1] = model->span;
    if (fp3_model_truths(model, params, initial, times, MANY, rows, NULL, &error) ||
        fp3_path_open(model, params, initial, model->span, sizes, &path, &error))
        return INFINITY;
    for (uint32_t i = 0; i < MANY; i++) {
        fp3_path_at(path, times[i], there);
        for (uint32_t k = 0; k < model->state_count; k++)
            most = fmax(most, fabs(there[k] - rows[i * model->state_count + k]) / sizes[k]);
    }
    fp3_path_close(&path);
    return most;
}

/* What stoermer_verlet starts from, by the truth a step before the start. Events are not followed
 * back. */
static double strays_back(const fp3_model *model, const double *params, const double *initial) {
    double there[16], truth[16], most = 0;
    fp3_error error;
    fp3_backwards *back = NULL;
    if (model->event_count)
        return 0;
    if (fp3_backwards_open(model, &back, &error) ||
        fp3_backwards_go(back, params, initial, model->step, there, &error) ||
        fp3_model_truth(model, params, initial, -model->step, truth, &error))
        most = INFINITY;
    for (uint32_t k = 0; k < model->state_count; k++)
        most = fmax(most, fabs(there[k] - truth[k]) / fmax(fabs(truth[k]), fabs(initial[k])));
    fp3_backwards_close(&back);
    return most;
}

static void defaults(const fp3_model *model, double *params, double *initial) {
    for (uint32_t k = 0; k < model->param_count; k++)
        params[k] = (float)model->params[k].value;
    for (uint32_t k = 0; k < model->state_count; k++)
        initial[k] = (float)model->states[k].value;
}

static int set(const fp3_model *model, const char *text, double *params, double *initial) {
    const size_t size = strcspn(text, "=");
    for (uint32_t k = 0; k < model->param_count + model->state_count; k++) {
        const int is_param = k < model->param_count;
        const fp3_quantity *q =
            is_param ? &model->params[k] : &model->states[k - model->param_count];
        if (strlen(q->name) == size && memcmp(q->name, text, size) == 0) {
            *(is_param ? &params[k] : &initial[k - model->param_count]) =
                strtof(text + size + 1, NULL);
            return 1;
        }
    }
    return 0;
}

static int print_object(const fp3_model *model, const double *params, const double *initial) {
    static double times[MANY], rows[MANY * 16];
    double sizes[16];
    uint32_t count = 0;
    fp3_error error;
    while (count < MANY && scanf("%lf", &times[count]) == 1)
        count++;
    if (fp3_model_truths(model, params, initial, times, count, rows, sizes, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    for (uint32_t i = 0; i <= count; i++)
        for (uint32_t k = 0; k < model->state_count; k++)
            printf("%.17g%c", i < count ? rows[i * model->state_count + k] : sizes[k],
                   k + 1 < model->state_count ? ' ' : '\n');
    return 0;
}

int main(int argc, char **argv) {
    const double upwards[] = {1, 1};
    double states[32], params[16], initial[16];
    for (int i = 1; i < argc; i++) {
        char *report = NULL;
        fp3_error error;
        fp3_model *model = NULL;
        if (fp3_model_load(argv[i], &model, &report, &error))
            return 2;
        defaults(model, params, initial);
        while (i + 1 < argc && set(model, argv[i + 1], params, initial))
            i++;
        if (i + 1 == argc && i > 1 && strchr(argv[i], '='))
            return print_object(model, params, initial);
        printf("%s %.3g %.3g %d %.3g\n", model->name, farthest(model, params, initial),
               strays(model, params, initial),
               fp3_model_truths(model, params, initial, upwards, 2, states, NULL, &error),
               strays_back(model, params, initial));
        fp3_model_free(&model);
    }
    return 0;
}
