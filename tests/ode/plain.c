/* plain - what plain C in FP32 reaches on a model, beside the compiler's program.
 *
 *     plain MODEL.ode STEPS    the smallest error of each by rk4 with up to that number of steps, and at
 *                              which step: one line
 *
 * The loop is the one that somebody writes by hand: floats, the functions of the host's libm, the sums
 * of the textbook. Its steps and the truth are those of fp3/convergence.h.
 */
#include <fp3/convergence.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    const fp3_model *model;
    const double *params;
    float *values, *stage, *slope[4];
    float t;
} loop;

static float evaluate(const loop *l, const fp3_expr *e, const float *states) {
    const float a = e->operand[0] == FP3_NONE ? 0 : l->values[e->operand[0]];
    const float b = e->operand[1] == FP3_NONE ? 0 : l->values[e->operand[1]];
    const float c = e->operand[2] == FP3_NONE ? 0 : l->values[e->operand[2]];
    switch (e->op) {
    case FP3_EXPR_NUMBER:
        return (float)e->number;
    case FP3_EXPR_STATE:
        return states[e->index];
    case FP3_EXPR_PARAM:
        return (float)l->params[e->index];
    case FP3_EXPR_TIME:
        return l->t;
    case FP3_EXPR_NEGATE:
        return -a;
    case FP3_EXPR_ADD:
        return a + b;
    case FP3_EXPR_SUB:
        return a - b;
    case FP3_EXPR_MUL:
        return a * b;
    case FP3_EXPR_DIV:
        return a / b;
    case FP3_EXPR_POWER:
        return powf(a, b);
    case FP3_EXPR_SQRT:
        return sqrtf(a);
    case FP3_EXPR_SIN:
        return sinf(a);
    case FP3_EXPR_COS:
        return cosf(a);
    case FP3_EXPR_EXP:
        return expf(a);
    case FP3_EXPR_LOG:
        return logf(a);
    case FP3_EXPR_MIN:
        return a < b ? a : b;
    case FP3_EXPR_MAX:
        return b < a ? a : b;
    case FP3_EXPR_ABS:
        return fabsf(a);
    case FP3_EXPR_LESS:
        return a < b;
    case FP3_EXPR_LESS_EQUAL:
        return a <= b;
    case FP3_EXPR_AND:
        return a != 0 && b != 0;
    case FP3_EXPR_OR:
        return a != 0 || b != 0;
    case FP3_EXPR_SELECT:
        return a != 0 ? b : c;
    default: /* closed forms and invariants, which no derivative reads */
        return NAN;
    }
}

static void evaluate_all(loop *l, const float *states) {
    for (uint32_t i = 0; i < l->model->expr_count; i++)
        l->values[i] = evaluate(l, &l->model->exprs[i], states);
}

static void derive(loop *l, const float *states, float *slope) {
    evaluate_all(l, states);
    for (uint32_t i = 0; i < l->model->state_count; i++)
        slope[i] = l->values[l->model->states[i].derivative];
}

static void fire(loop *l, float *y) {
    const fp3_model *m = l->model;
    for (uint32_t i = 0; i < m->event_count; i++) {
        const fp3_event *e = &m->events[i];
        evaluate_all(l, y);
        for (uint32_t j = e->first; l->values[e->condition] != 0 && j < e->first + e->count; j++)
            y[m->assignments[j].state] = l->values[m->assignments[j].expr];
    }
}

static void step(loop *l, float h, uint64_t number, float *y) {
    static const float part[4] = {0, 0.5f, 0.5f, 1};
    const uint32_t count = l->model->state_count;
    for (int k = 0; k < 4; k++) {
        for (uint32_t i = 0; i < count; i++)
            l->stage[i] = k ? y[i] + part[k] * h * l->slope[k - 1][i] : y[i];
        l->t = ((float)number + part[k]) * h;
        derive(l, l->stage, l->slope[k]);
    }
    for (uint32_t i = 0; i < count; i++)
        y[i] += h / 6 * (l->slope[0][i] + 2 * l->slope[1][i] + 2 * l->slope[2][i] + l->slope[3][i]);
    l->t = (float)(number + 1) * h;
    fire(l, y);
}

/* As fp3_convergence.error. */
static double error_at(loop *l, const fp3_ladder *ladder, unsigned rung, float *y) {
    const uint32_t count = l->model->state_count;
    double sum = 0;
    unsigned terms = 0;
    uint64_t made = 0;
    for (uint32_t i = 0; i < count; i++)
        y[i] = (float)ladder->initial[i];
    for (unsigned look = 0; look < FP3_LOOKS; look++) {
        for (; made < ladder->steps[rung] * (look + 1) / FP3_LOOKS; made++)
            step(l, ladder->h[rung], made, y);
        for (uint32_t i = 0; i < count; i++)
            if (ladder->scale[i] > 0) {
                const double d = (y[i] - ladder->truth[rung][look * count + i]) / ladder->scale[i];
                sum += d * d;
                terms++;
            }
    }
    return sqrt(sum / terms);
}

static void *room(size_t count) {
    void *made = calloc(count + 1, sizeof(float));
    if (!made)
        abort();
    return made;
}

static void report(const fp3_model *model, const fp3_ladder *ladder, const fp3_convergence *ours) {
    loop l = {.model = model, .params = ladder->params, .values = room(model->expr_count)};
    float *y = room(model->state_count);
    double floor = INFINITY;
    unsigned best = 0;
    l.stage = room(model->state_count);
    for (int k = 0; k < 4; k++)
        l.slope[k] = room(model->state_count);
    for (unsigned i = 0; i < ladder->count; i++) {
        const double error = error_at(&l, ladder, i, y);
        if (error < floor) {
            floor = error;
            best = i;
        }
    }
    printf("%s plain %.3e at %g ours %.3e at %g ratio %.2f\n", model->name, floor,
           (double)ladder->h[best], ours->floor, (double)ladder->h[ours->best],
           ours->floor / floor);
    free(l.values);
    free(l.stage);
    for (int k = 0; k < 4; k++)
        free(l.slope[k]);
    free(y);
}

int main(int argc, char **argv) {
    fp3_error error = {""};
    fp3_model *model = NULL;
    fp3_integrator *rk4 = NULL;
    fp3_compiled *program = NULL;
    fp3_ladder *ladder = NULL;
    fp3_convergence ours;
    char *text = NULL;
    const fp3_compile_def def = fp3_compile_default();
    if (argc != 3)
        return 2;
    fp3_status status = fp3_model_load(argv[1], &model, &text, &error);
    if (!status)
        status = fp3_integrator_find("rk4", &rk4, &error);
    if (!status)
        status = fp3_compile(model, rk4, &def, &program, &error);
    if (!status)
        status = fp3_ladder_open(model, 0, strtoul(argv[2], NULL, 10), &ladder, &error);
    if (!status)
        status = fp3_converge(ladder, program, program->order, &ours, &error);
    if (!status)
        report(model, ladder, &ours);
    else
        fprintf(stderr, "%s\n", text ? text : error.text);
    fp3_ladder_close(&ladder);
    fp3_compiled_free(&program);
    fp3_integrator_free(&rk4);
    fp3_model_free(&model);
    free(text);
    return fp3_exit_code(status);
}
