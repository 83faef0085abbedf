/* SPDX-License-Identifier: Apache-2.0 */
/* family.h - which family a method belongs to: a family has one colour in every picture.
 * programs/integrators/families.toml has the list; tools/ reads it, too.
 */
#ifndef FP3_OUTPUT_FAMILY_H
#define FP3_OUTPUT_FAMILY_H

#include <stddef.h>

typedef struct {
    const char *name, *colour; /* "#0072b2" */
} fp3_family;

/* In the order of the list; NULL beyond the last. */
const fp3_family *fp3_family_of_integrators(size_t number);

/* Of an integrator, by its name, and of whoever runs steps, by the name of its engine. What is in
 * no family has one of its own: "other", grey. */
const fp3_family *fp3_family_of_integrator(const char *name);
const fp3_family *fp3_family_of_solver(const char *engine);

#endif
