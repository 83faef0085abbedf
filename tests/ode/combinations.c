/* combinations.c - compiles models by integrators in every arithmetic, and tells whether each is a
 * program or is refused.
 *
 *     combinations SEED EVERY PART MODELS...
 *
 * SEED picks every EVERYth combination; 1: all. PART 0..: of these every combination with this
 * number modulo PARTS, as "0/2". Prints each combination before it compiles it, so that the last
 * line names the one that crashes, and exits with 1 where one is refused without a reason.
 */
#include <fp3/compile.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const configs[] = {"world", "many_full", "single_full"};
enum { CONFIGS = sizeof configs / sizeof *configs, FORMS = 2 };

typedef struct {
    uint32_t seed, every, part, parts;
    uint32_t count, taken, made, refused, bad;
} chance;

static int is_taken(chance *c) {
    c->seed = c->seed * 1664525u + 1013904223u;
    if ((c->seed >> 8) % c->every)
        return 0;
    return c->count++ % c->parts == c->part;
}

/* A model with steps of its own choice, or with those of its text. */
static fp3_status load(const char *path, int is_adaptive, fp3_model **model, fp3_error *error) {
    char *report = NULL;
    const fp3_adaptive_def def = fp3_adaptive_default();
    fp3_status status = fp3_model_load(path, model, &report, error);
    free(report);
    return status || !is_adaptive ? status : fp3_model_adapt(*model, &def, error);
}

/* is_clean: what failed made nothing. */
static void note(chance *c, fp3_status status, const fp3_error *error, int is_clean) {
    const int is_reason =
        (status == FP3_E_PROGRAM || status == FP3_E_LIMIT || status == FP3_E_ARGUMENT) &&
        *error->text && is_clean;
    c->made += !status;
    c->refused += status && is_reason;
    c->bad += status && !is_reason;
    printf("%s\n", status ? error->text : "made");
}

static void compile(chance *c, const fp3_model *model, const fp3_integrator *integrator,
                    fp3_arithmetic arithmetic, const char *config) {
    fp3_error error = {.text = ""};
    fp3_compiled *compiled = NULL;
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = arithmetic;
    const fp3_status status = fp3_compile(model, integrator, &def, &compiled, &error);
    note(c, status, &error, !compiled);
    fp3_compiled_free(&compiled);
}

static void compile_all(chance *c, const char *path, int is_adaptive) {
    fp3_error error = {.text = ""};
    fp3_model *model = NULL;
    const fp3_status status = load(path, is_adaptive, &model, &error);
    if (status) {
        printf("%s%s: ", path, is_adaptive ? " adaptive" : "");
        note(c, status, &error, 1);
    }
    for (unsigned i = 0; !status && fp3_integrator_name(i); i++) {
        fp3_integrator *integrator = NULL;
        if (fp3_integrator_find(fp3_integrator_name(i), &integrator, &error))
            abort();
        for (int a = 0; a < FP3_ARITHMETICS; a++)
            for (int k = 0; k < CONFIGS; k++)
                if (is_taken(c)) {
                    printf("%s %s %s %s%s: ", path, integrator->name,
                           fp3_arithmetic_of((fp3_arithmetic)a)->name, configs[k],
                           is_adaptive ? " adaptive" : "");
                    fflush(stdout);
                    compile(c, model, integrator, (fp3_arithmetic)a, configs[k]);
                }
        fp3_integrator_free(&integrator);
    }
    fp3_model_free(&model);
}

int main(int argc, char **argv) {
    chance c = {0};
    if (argc < 5 || sscanf(argv[3], "%u/%u", &c.part, &c.parts) != 2)
        return 2;
    c.seed = (uint32_t)strtoul(argv[1], NULL, 0);
    c.every = (uint32_t)strtoul(argv[2], NULL, 0);
    for (int form = 0; form < FORMS; form++)
        for (int i = 4; i < argc; i++)
            compile_all(&c, argv[i], form);
    printf("%u made, %u refused, %u bad\n", c.made, c.refused, c.bad);
    return c.bad > 0;
}
