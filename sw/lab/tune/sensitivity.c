/* SPDX-License-Identifier: Apache-2.0 */
/* sensitivity.c - see sensitivity.h. */
#include "sensitivity.h"

#include <fp3/truth.h>

#include "machine/config.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TIMES 64

typedef struct {
    const fp3_sample *sample;
    const fp3_config *config;
    double *params, *initial;
    double times[TIMES], *states; /* TIMES rows */
} mover;

/* From a number to the next; of logarithms, from its logarithm to the next. */
static double last_place(const fp3_config *config, double x) {
    int exponent;
    frexp(x, &exponent);
    return config->logarithmic ? fabs(x) * M_LN2 * 0x1p-23
                               : ldexp(1, exponent - 1 - (int)config->fraction);
}

/* With the numbers as they now are. FP3_OK and 0: they have no truth. */
static fp3_status look(const mover *m, double *moves, fp3_error *error) {
    const fp3_model *model = m->sample->model;
    const fp3_status status =
        fp3_model_truths(model, m->params, m->initial, m->times, TIMES, m->states, NULL, error);
    *moves = 0;
    for (size_t i = 0; !status && i < TIMES; i++)
        *moves = fmax(*moves, fp3_sample_error(m->sample, 0, m->times[i],
                                               m->states + i * model->state_count));
    return status == FP3_E_SYSTEM ? status : FP3_OK;
}

static fp3_status move_all(const mover *m, double *numbers, const fp3_quantity *list,
                           uint32_t count, char name[FP3_NAME_SIZE], double *most,
                           fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < count; i++) {
        const double is = numbers[i];
        double moves;
        if (is == 0)
            continue;
        numbers[i] = is + last_place(m->config, is);
        status = look(m, &moves, error);
        numbers[i] = is;
        if (status || !(moves > *most))
            continue;
        *most = moves;
        strcpy(name, list[i].name);
    }
    return status;
}

static double *copy(const double *from, size_t count) {
    double *to = calloc(count + 1, sizeof *to);
    return to ? memcpy(to, from, count * sizeof *to) : NULL;
}

fp3_status fp3_sensitivity_find(const fp3_sample *sample, const char *config,
                                char name[FP3_NAME_SIZE], double *moves, fp3_error *error) {
    const fp3_model *model = sample->model;
    mover m = {.sample = sample,
               .config = fp3_config_find(config),
               .params = copy(sample->params, model->param_count),
               .initial = copy(sample->initial, model->state_count),
               .states = calloc(TIMES * (model->state_count + 1u), sizeof *m.states)};
    fp3_status status = m.params && m.initial && m.states ? FP3_OK : fp3_no_memory(error);
    for (int i = 0; i < TIMES; i++)
        m.times[i] = sample->span * (i + 1) / TIMES;
    name[0] = '\0';
    *moves = 0;
    if (!status)
        status = move_all(&m, m.params, model->params, model->param_count, name, moves, error);
    if (!status)
        status = move_all(&m, m.initial, model->states, model->state_count, name, moves, error);
    free(m.params);
    free(m.initial);
    free(m.states);
    return status;
}
