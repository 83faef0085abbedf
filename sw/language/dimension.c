/* SPDX-License-Identifier: Apache-2.0 */
/* dimension.c - a derived unit of the SI becomes the units that it is made of. Every other name is
 * a base unit, because nothing is converted. */
#include "dimension.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name;
    struct {
        const char *name;
        int power;
    } of[4];
} derived;

/* Those with a factor of 1 in base units: SI Brochure, 9th edition, table 4. */
static const derived derived_units[] = {
    {"rad", {{0}}},
    {"sr", {{0}}},
    {"Hz", {{"s", -1}}},
    {"N", {{"kg", 1}, {"m", 1}, {"s", -2}}},
    {"Pa", {{"kg", 1}, {"m", -1}, {"s", -2}}},
    {"J", {{"kg", 1}, {"m", 2}, {"s", -2}}},
    {"W", {{"kg", 1}, {"m", 2}, {"s", -3}}},
    {"C", {{"A", 1}, {"s", 1}}},
    {"V", {{"kg", 1}, {"m", 2}, {"s", -3}, {"A", -1}}},
    {"F", {{"kg", -1}, {"m", -2}, {"s", 4}, {"A", 2}}},
    {"ohm", {{"kg", 1}, {"m", 2}, {"s", -3}, {"A", -2}}},
    {"S", {{"kg", -1}, {"m", -2}, {"s", 3}, {"A", 2}}},
    {"Wb", {{"kg", 1}, {"m", 2}, {"s", -2}, {"A", -1}}},
    {"T", {{"kg", 1}, {"s", -2}, {"A", -1}}},
    {"H", {{"kg", 1}, {"m", 2}, {"s", -2}, {"A", -2}}},
};

static int set_power(ode_dimension *d, unsigned i, long power) {
    if (labs(power) > ODE_DIMENSION_POWER_MAX)
        return 0;
    d->power[i] = (int16_t)power;
    return 1;
}

static int multiply_base(ode_dimension_names *names, ode_dimension *d, const char *name,
                         int power) {
    unsigned i = 0;
    while (i < names->count && strcmp(names->name[i], name))
        i++;
    if (i == ODE_DIMENSION_NAMES)
        return 0;
    if (i == names->count) {
        snprintf(names->name[i], sizeof names->name[i], "%s", name);
        names->count++;
    }
    return set_power(d, i, d->power[i] + (long)power * ODE_DIMENSION_ONE) ? 1 : -1;
}

int fp3_ode_dimension_multiply(ode_dimension_names *names, ode_dimension *d, const char *name,
                               int power) {
    for (size_t i = 0; i < sizeof derived_units / sizeof *derived_units; i++) {
        const derived *unit = &derived_units[i];
        if (strcmp(unit->name, name))
            continue;
        for (size_t j = 0; j < sizeof unit->of / sizeof *unit->of && unit->of[j].name; j++) {
            int result = multiply_base(names, d, unit->of[j].name, power * unit->of[j].power);
            if (result != 1)
                return result;
        }
        return 1;
    }
    return multiply_base(names, d, name, power);
}

static int same_powers(const ode_dimension *a, const ode_dimension *b) {
    return !memcmp(a->power, b->power, sizeof a->power);
}

int fp3_ode_dimension_fits(const ode_dimension *a, const ode_dimension *b) {
    return a->kind != ODE_DIMENSION_KNOWN || b->kind != ODE_DIMENSION_KNOWN || same_powers(a, b);
}

int fp3_ode_dimension_is_one(const ode_dimension *d) {
    const ode_dimension one = {.kind = ODE_DIMENSION_KNOWN};
    return fp3_ode_dimension_fits(d, &one);
}

ode_dimension fp3_ode_dimension_common(const ode_dimension *a, const ode_dimension *b) {
    if (a->kind == ODE_DIMENSION_KNOWN || b->kind == ODE_DIMENSION_KNOWN)
        return a->kind == ODE_DIMENSION_KNOWN ? *a : *b;
    return a->kind == ODE_DIMENSION_ANY ? *a : *b;
}

ode_dimension fp3_ode_dimension_product(const ode_dimension *a, const ode_dimension *b, int sign) {
    ode_dimension product = {.kind = ODE_DIMENSION_KNOWN};
    if (a->kind == ODE_DIMENSION_ANY || b->kind == ODE_DIMENSION_ANY)
        return (ode_dimension){.kind = ODE_DIMENSION_ANY};
    if (a->kind == ODE_DIMENSION_NUMBER && b->kind == ODE_DIMENSION_NUMBER)
        return (ode_dimension){.kind = ODE_DIMENSION_NUMBER};
    for (unsigned i = 0; i < ODE_DIMENSION_NAMES; i++)
        if (!set_power(&product, i, a->power[i] + (long)sign * b->power[i]))
            return (ode_dimension){.kind = ODE_DIMENSION_ANY};
    return product;
}

int fp3_ode_dimension_power(const ode_dimension *a, int numerator, int denominator,
                            ode_dimension *power) {
    *power = (ode_dimension){.kind = a->kind};
    for (unsigned i = 0; i < ODE_DIMENSION_NAMES; i++) {
        long whole = (long)a->power[i] * numerator;
        if (whole % denominator || !set_power(power, i, whole / denominator))
            return 0;
    }
    return 1;
}

static void append(char text[ODE_DIMENSION_TEXT_SIZE], const char *more) {
    size_t used = strlen(text);
    snprintf(text + used, ODE_DIMENSION_TEXT_SIZE - used, "%s", more);
}

static void append_power(char text[ODE_DIMENSION_TEXT_SIZE], int power) {
    char number[32];
    int whole = power % ODE_DIMENSION_ONE == 0;
    if (power == ODE_DIMENSION_ONE)
        return;
    if (whole)
        snprintf(number, sizeof number, "^%d", power / ODE_DIMENSION_ONE);
    else
        snprintf(number, sizeof number, "^%g", (double)power / ODE_DIMENSION_ONE);
    append(text, number);
}

const char *fp3_ode_dimension_text(const ode_dimension_names *names, const ode_dimension *d,
                                   char text[ODE_DIMENSION_TEXT_SIZE]) {
    const char *before = "";
    strcpy(text, "[");
    for (int sign = 1; sign >= -1; sign -= 2)
        for (unsigned i = 0; i < names->count; i++) {
            if (d->power[i] * sign <= 0)
                continue;
            append(text, sign > 0 ? before : *before ? "/" : "1/");
            append(text, names->name[i]);
            append_power(text, d->power[i] * sign);
            before = "*";
        }
    append(text, *before ? "]" : "1]");
    return text;
}
