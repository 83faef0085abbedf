/* embedded.c - the order of the second method, and whether stages are shared between steps. */
#include "embedded.h"

#include "conditions.h"

#include <math.h>
#include <string.h>

static int is_last_row(const fp3_integrator *t) {
    const unsigned last = t->stages - 1;
    for (unsigned j = 0; j < last; j++)
        if (fabs(t->a[last][j] - t->b[j]) > FP3_CONDITION_TOLERANCE)
            return 0;
    return t->stages > 1 && t->b[last] == 0;
}

int fp3_embedded_find(fp3_integrator *table) {
    fp3_integrator other = *table;
    double worst = 0, next = 0, distance = 0;
    memcpy(other.b, table->embedded, sizeof other.b);
    for (unsigned i = 0; i < table->stages; i++)
        distance = fmax(distance, fabs(table->b[i] - table->embedded[i]));
    table->embedded_order = fp3_integrator_order(&other, &worst, &next);
    table->is_first_same_as_last = table->kind != FP3_ROSENBROCK && is_last_row(table);
    return distance >= FP3_CONDITION_TOLERANCE;
}
