/* SPDX-License-Identifier: Apache-2.0 */
#include "parser.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* A table of an integrator is read coefficient by coefficient, each by a parser of its own, and to
 * clear what is seldom used would take longer than to read it. */
ode_parser *fp3_ode_make(void) {
    ode_parser *p = malloc(sizeof *p);
    if (p)
        memset(p, 0, offsetof(ode_parser, definitions));
    return p;
}
