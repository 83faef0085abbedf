/* SPDX-License-Identifier: Apache-2.0 */
/* phases_print.h - what it costs that objects see each other. */
#ifndef FP3_PHASES_PRINT_H
#define FP3_PHASES_PRINT_H

#include "machine/config.h"
#include "machine/neighbours.h"

/* Lines for standard output: phases, what is published, instructions and cycles for the object and
 * for each neighbour. */
void fp3_phases_print(const fp3_image *image, const fp3_neighbourhood *around,
                      const fp3_config *config);
/* The lines with cycles alone. */
void fp3_phases_print_cycles(const fp3_image *image, const fp3_config *config);

#endif
