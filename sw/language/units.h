/* units.h - units of measurement: products of powers of names. */
#ifndef FP3_UNITS_H
#define FP3_UNITS_H

#include "text/token.h"

/* Powers are counted in eighths: a square root may be taken three times. */
enum { ODE_UNIT_NAMES = 16, ODE_UNIT_ONE = 8, ODE_UNIT_POWER_MAX = 1000 * ODE_UNIT_ONE };

typedef enum {
    ODE_UNIT_ANY,    /* of something without [..]: fits everything */
    ODE_UNIT_NUMBER, /* of numbers: fits everything, and is 1 as a factor */
    ODE_UNIT_KNOWN
} ode_unit_kind;

typedef struct {
    ode_unit_kind kind;
    int16_t power[ODE_UNIT_NAMES]; /* of the names of the table; 0 unless KNOWN */
} ode_unit;

typedef struct {
    char name[ODE_UNIT_NAMES][FP3_NAME_SIZE];
    unsigned count;
} ode_unit_names;

/* Multiplies *unit with the name to that power; 0: too many names, -1: too large a power. */
int fp3_ode_unit_multiply_name(ode_unit_names *names, ode_unit *unit, const char *name, int power);

int fp3_ode_unit_fits(const ode_unit *a, const ode_unit *b);
int fp3_ode_unit_is_one(const ode_unit *unit); /* fits a pure number */
/* a or b, whichever says more. They fit each other. */
ode_unit fp3_ode_unit_common(const ode_unit *a, const ode_unit *b);
/* a * b^sign; ANY where a power becomes too large. */
ode_unit fp3_ode_unit_product(const ode_unit *a, const ode_unit *b, int sign);
/* a^(numerator/denominator); 0 if it has no such power. */
int fp3_ode_unit_power(const ode_unit *a, int numerator, int denominator, ode_unit *power);

enum { ODE_UNIT_TEXT_SIZE = 80 };
/* "[kg*m/s^2]", cut to the size. */
const char *fp3_ode_unit_text(const ode_unit_names *names, const ode_unit *unit,
                              char text[ODE_UNIT_TEXT_SIZE]);

#endif
