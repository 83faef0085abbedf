/* Truths at several times in one go are those of one time after the other. */
#include <fp3/tune.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TIMES 3

static double farthest(const fp3_model *model, const double *params, const double *initial) {
    double rows[TIMES * 8], sizes[8], one[8], times[TIMES], most = 0;
    fp3_error error;
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

int main(int argc, char **argv) {
    const double upwards[] = {1, 1};
    double states[16];
    for (int i = 1; i < argc; i++) {
        double params[8], initial[8];
        char *report = NULL;
        fp3_error error;
        fp3_model *model = NULL;
        if (fp3_model_load(argv[i], &model, &report, &error))
            return 2;
        for (uint32_t k = 0; k < model->param_count; k++)
            params[k] = model->params[k].value;
        for (uint32_t k = 0; k < model->state_count; k++)
            initial[k] = model->states[k].value;
        printf("%s %.3g %d\n", model->name, farthest(model, params, initial),
               fp3_model_truths(model, params, initial, upwards, 2, states, NULL, &error));
        fp3_model_free(&model);
    }
    return 0;
}
