/* units.c - arithmetic with units. Derived names of the SI become what they are made of; every
 * other name is a unit of its own, since nothing is converted. */
#include "units.h"

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

/* Those that are 1 in base units: SI Brochure, 9th edition, table 4. */
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

static int set_power(ode_unit *unit, unsigned i, long power) {
    if (labs(power) > ODE_UNIT_POWER_MAX)
        return 0;
    unit->power[i] = (int16_t)power;
    return 1;
}

static int multiply_base(ode_unit_names *names, ode_unit *unit, const char *name, int power) {
    unsigned i = 0;
    while (i < names->count && strcmp(names->name[i], name))
        i++;
    if (i == ODE_UNIT_NAMES)
        return 0;
    if (i == names->count) {
        snprintf(names->name[i], sizeof names->name[i], "%s", name);
        names->count++;
    }
    return set_power(unit, i, unit->power[i] + (long)power * ODE_UNIT_ONE) ? 1 : -1;
}

int fp3_ode_unit_multiply_name(ode_unit_names *names, ode_unit *unit, const char *name, int power) {
    for (size_t i = 0; i < sizeof derived_units / sizeof *derived_units; i++) {
        const derived *d = &derived_units[i];
        if (strcmp(d->name, name))
            continue;
        for (size_t j = 0; j < sizeof d->of / sizeof *d->of && d->of[j].name; j++) {
            int result = multiply_base(names, unit, d->of[j].name, power * d->of[j].power);
            if (result != 1)
                return result;
        }
        return 1;
    }
    return multiply_base(names, unit, name, power);
}

static int same_powers(const ode_unit *a, const ode_unit *b) {
    return !memcmp(a->power, b->power, sizeof a->power);
}

int fp3_ode_unit_fits(const ode_unit *a, const ode_unit *b) {
    return a->kind != ODE_UNIT_KNOWN || b->kind != ODE_UNIT_KNOWN || same_powers(a, b);
}

int fp3_ode_unit_is_one(const ode_unit *unit) {
    const ode_unit one = {.kind = ODE_UNIT_KNOWN};
    return fp3_ode_unit_fits(unit, &one);
}

ode_unit fp3_ode_unit_common(const ode_unit *a, const ode_unit *b) {
    if (a->kind == ODE_UNIT_KNOWN || b->kind == ODE_UNIT_KNOWN)
        return a->kind == ODE_UNIT_KNOWN ? *a : *b;
    return a->kind == ODE_UNIT_ANY ? *a : *b;
}

ode_unit fp3_ode_unit_product(const ode_unit *a, const ode_unit *b, int sign) {
    ode_unit product = {.kind = ODE_UNIT_KNOWN};
    if (a->kind == ODE_UNIT_ANY || b->kind == ODE_UNIT_ANY)
        return (ode_unit){.kind = ODE_UNIT_ANY};
    if (a->kind == ODE_UNIT_NUMBER && b->kind == ODE_UNIT_NUMBER)
        return (ode_unit){.kind = ODE_UNIT_NUMBER};
    for (unsigned i = 0; i < ODE_UNIT_NAMES; i++)
        if (!set_power(&product, i, a->power[i] + (long)sign * b->power[i]))
            return (ode_unit){.kind = ODE_UNIT_ANY};
    return product;
}

int fp3_ode_unit_power(const ode_unit *a, int numerator, int denominator, ode_unit *power) {
    *power = (ode_unit){.kind = a->kind};
    for (unsigned i = 0; i < ODE_UNIT_NAMES; i++) {
        long whole = (long)a->power[i] * numerator;
        if (whole % denominator || !set_power(power, i, whole / denominator))
            return 0;
    }
    return 1;
}

static void append(char text[ODE_UNIT_TEXT_SIZE], const char *more) {
    size_t used = strlen(text);
    snprintf(text + used, ODE_UNIT_TEXT_SIZE - used, "%s", more);
}

static void append_power(char text[ODE_UNIT_TEXT_SIZE], int power) {
    char number[32];
    int whole = power % ODE_UNIT_ONE == 0;
    if (power == ODE_UNIT_ONE)
        return;
    if (whole)
        snprintf(number, sizeof number, "^%d", power / ODE_UNIT_ONE);
    else
        snprintf(number, sizeof number, "^%g", (double)power / ODE_UNIT_ONE);
    append(text, number);
}

const char *fp3_ode_unit_text(const ode_unit_names *names, const ode_unit *unit,
                              char text[ODE_UNIT_TEXT_SIZE]) {
    const char *before = "";
    strcpy(text, "[");
    for (int sign = 1; sign >= -1; sign -= 2)
        for (unsigned i = 0; i < names->count; i++) {
            if (unit->power[i] * sign <= 0)
                continue;
            append(text, sign > 0 ? before : *before ? "/" : "1/");
            append(text, names->name[i]);
            append_power(text, unit->power[i] * sign);
            before = "*";
        }
    append(text, *before ? "]" : "1]");
    return text;
}
