/* SPDX-License-Identifier: Apache-2.0 */
/* placed.c - see placed.h. */
#include "placed.h"

#include <string.h>

const fp3_placed fp3_placed_known[] = {
    {"many", 3357, 125.85},  {"many_full", 3958, 120.09},  {"flush", 3796, 125.13},
    {"cell", 3532, 118.6},   {"fused_full", 3772, 122.29}, {"bfloat", 3178, 115.8},
    {"middle", 3635, 116.9}, {"log", 3249, 125.3},         {"lanes", 11485, 135.35},
    {"shared", 5863, 95.66}, {"dual", 6727, 148.63},       {"pairs", 4260, 119.53},
};
const size_t fp3_placed_count = sizeof fp3_placed_known / sizeof *fp3_placed_known;

const fp3_placed *fp3_placed_find(const char *config) {
    for (size_t i = 0; i < fp3_placed_count; i++)
        if (strcmp(fp3_placed_known[i].config, config) == 0)
            return &fp3_placed_known[i];
    return NULL;
}
