/* SPDX-License-Identifier: Apache-2.0 */
#include "unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dimension_read.h"

int fp3_units_fit(const char *one, const char *other) {
    char text[2 * ODE_DIMENSION_SOURCE_SIZE + 8], read[ODE_DIMENSION_SOURCE_SIZE];
    ode_dimension a, b;
    if (!*one || !*other || strcmp(one, other) == 0)
        return 1;
    ode_parser *p = fp3_ode_make();
    if (!p)
        return -1;
    snprintf(text, sizeof text, "[%s] [%s]", one, other);
    fp3_ode_open(&p->in, text, strlen(text), "");
    fp3_ode_dimension_read(p, &a, read);
    fp3_ode_dimension_read(p, &b, read);
    const int fits = fp3_ode_dimension_fits(&a, &b);
    free(p);
    return fits;
}
