/* spoiled.c - the stress suite finds an integrator that does not do what its table says.
 *
 *     spoiled INTEGRATOR SECTION FACTOR
 *
 * Runs one section in its quick form by an integrator of which one coefficient (the last of A, the
 * first substep, a slope of a recurrence) is multiplied by a factor, beside the theory of its
 * table. Prints how many results there are, and how many do not hold. Exit code 1: something went
 * wrong.
 */
#include "lab/stress/suite.h"

#include <stdio.h>
#include <stdlib.h>

static double factor;

/* The library would refuse a table like that, so it is changed behind its back. */
static void spoil(fp3_integrator *integrator) {
    if (integrator->kind == FP3_SPLITTING)
        integrator->substeps[0].coefficient *= factor;
    else if (integrator->kind == FP3_CHEBYSHEV)
        integrator->recurrence.slope[1] *= factor;
    else
        integrator->a[integrator->stages - 1][integrator->stages - 2] *= factor;
}

int main(int argc, char **argv) {
    if (argc != 4)
        return 1;
    const char *const integrators[] = {argv[1], NULL};
    const fp3_stress_options options = {
        .is_quick = 1, .integrators = integrators, .section = argv[2], .spoil = spoil};
    fp3_verdicts verdicts = {0};
    fp3_error error;
    factor = strtod(argv[3], NULL);
    const fp3_status status = fp3_stress_suite(&options, &verdicts, &error);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    else
        printf("%zu results, %zu do not hold\n", verdicts.count, fp3_verdicts_failed(&verdicts));
    fp3_verdicts_free(&verdicts);
    return status ? 1 : 0;
}
