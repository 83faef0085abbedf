/* SPDX-License-Identifier: Apache-2.0 */
/* unit.c - see unit.h. */
#include "unit.h"

#include <stddef.h>
#include <string.h>

int fp3_unit_is_length(const char *unit) {
    static const char *const lengths[] = {"m",   "mm",  "um", "nm", "pm", "cm", "dm",
                                          "km",  "Mm",  "Gm", "AU", "au", "ly", "pc",
                                          "kpc", "Mpc", "ft", "in", "mi", "yd", "nmi"};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        if (!strcmp(unit, lengths[i]))
            return 1;
    return 0;
}
