/* SPDX-License-Identifier: Apache-2.0 */
/* dimension.h - what a quantity is measured in: a product of powers of units. */
#ifndef FP3_ODE_DIMENSION_H
#define FP3_ODE_DIMENSION_H

#include <fp3/image.h>
#include <stdint.h>

/* Powers are counted in eighths, so that a square root can be taken three times. */
enum {
    ODE_DIMENSION_NAMES = 16,
    ODE_DIMENSION_ONE = 8,
    ODE_DIMENSION_POWER_MAX = 1000 * ODE_DIMENSION_ONE
};

typedef enum {
    ODE_DIMENSION_ANY,    /* of something declared without [..]: fits everything */
    ODE_DIMENSION_NUMBER, /* of numbers: fits everything, and is 1 as a factor */
    ODE_DIMENSION_KNOWN
} ode_dimension_kind;

typedef struct {
    ode_dimension_kind kind;
    int16_t power[ODE_DIMENSION_NAMES]; /* of the base units; 0 unless KNOWN */
} ode_dimension;

/* The base units of a model, in the order of their first use. */
typedef struct {
    char name[ODE_DIMENSION_NAMES][FP3_NAME_SIZE];
    unsigned count;
} ode_dimension_names;

/* Multiplies *dimension with a unit to that power. 0: there are too many base units, -1: the power
 * becomes too large. */
int fp3_ode_dimension_multiply(ode_dimension_names *names, ode_dimension *dimension,
                               const char *name, int power);

int fp3_ode_dimension_fits(const ode_dimension *a, const ode_dimension *b);
int fp3_ode_dimension_is_one(const ode_dimension *dimension); /* fits a pure number */
/* Of two that fit each other, the one that says more. */
ode_dimension fp3_ode_dimension_common(const ode_dimension *a, const ode_dimension *b);
/* a * b^sign; ANY if a power becomes too large. */
ode_dimension fp3_ode_dimension_product(const ode_dimension *a, const ode_dimension *b, int sign);
/* a^(numerator/denominator); 0 if there is no such power. */
int fp3_ode_dimension_power(const ode_dimension *a, int numerator, int denominator,
                            ode_dimension *power);

enum { ODE_DIMENSION_TEXT_SIZE = 80 };
/* "[kg*m/s^2]", cut to the size. */
const char *fp3_ode_dimension_text(const ode_dimension_names *names, const ode_dimension *dimension,
                                   char text[ODE_DIMENSION_TEXT_SIZE]);

#endif
