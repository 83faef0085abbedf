/* SPDX-License-Identifier: Apache-2.0 */
/* main.c - the processor with a memory of its own, simulated: one row of JSON.
 *
 *     alone load CONFIG OBJECTS RATE LATENCY WAITS
 *     alone chunks CONFIG IMAGE OBJECTS STEPS RATE LATENCY
 *     alone linked CONFIG SCENE STEPS RATE LATENCY [ROAM [FROM]]
 *     alone image CONFIG SCENE STEPS ADDRESS FILE [ROAM [FROM]]
 *
 * RATE: words of memory in 1,000 cycles, at least 1. WAITS: a seed for waits on each channel; 0:
 * none. ROAM: how far near objects may go in these steps. FROM: after so many steps of the engine
 * fast. */
#include "rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t number(const char *text) {
    char *end;
    const unsigned long value = strtoul(text, &end, 10);
    if (*end || end == text || value > UINT32_MAX) {
        fprintf(stderr, "alone: '%s' is no number\n", text);
        exit(2);
    }
    return (uint32_t)value;
}

/* Memory of no words never answers. */
static uint32_t rate(const char *text) {
    const uint32_t value = number(text);
    if (!value) {
        fprintf(stderr, "alone: RATE: expected 1 or more words in 1,000 cycles, found 0\n");
        exit(2);
    }
    return value;
}

static double length(const char *text) {
    char *end;
    const double value = strtod(text, &end);
    if (*end || end == text || !isfinite(value) || value < 0) {
        fprintf(stderr, "alone: ROAM: expected a length, found '%s'\n", text);
        exit(2);
    }
    return value;
}

int main(int argc, char **argv) {
    if (argc == 7 && !strcmp(argv[1], "load")) {
        measure_load(argv[2], number(argv[3]), rate(argv[4]), number(argv[5]), number(argv[6]));
        return 0;
    }
    if (argc == 8 && !strcmp(argv[1], "chunks")) {
        measure_chunks(argv[2], argv[3], number(argv[4]), number(argv[5]), rate(argv[6]),
                       number(argv[7]));
        return 0;
    }
    if (argc >= 7 && argc <= 9 && (!strcmp(argv[1], "linked") || !strcmp(argv[1], "image"))) {
        const linked_run run = {argv[3], number(argv[4]), argc > 8 ? number(argv[8]) : 0,
                                argc > 7 ? length(argv[7]) : 0};
        if (!strcmp(argv[1], "linked"))
            measure_linked(argv[2], &run, rate(argv[5]), number(argv[6]));
        else
            image_linked(argv[2], &run, number(argv[5]), argv[6]);
        return 0;
    }
    fprintf(stderr, "usage: alone load CONFIG OBJECTS RATE LATENCY WAITS | alone chunks CONFIG "
                    "IMAGE OBJECTS STEPS RATE LATENCY | alone linked CONFIG SCENE STEPS RATE "
                    "LATENCY [ROAM [FROM]] | alone image CONFIG SCENE STEPS ADDRESS FILE "
                    "[ROAM [FROM]]\n");
    return 2;
}
