/* SPDX-License-Identifier: Apache-2.0 */
/* family.c - see family.h. */
#include "family.h"

#include "gen/families.h"

#include <string.h>

typedef struct {
    const char *name;
    size_t family;
} member;

#define FAMILY(name, colour) {name, colour},
#define MEMBER(name, family) {name, family},
static const fp3_family of_integrators[] = {FP3_FAMILIES_OF_INTEGRATORS(FAMILY)};
static const fp3_family of_solvers[] = {FP3_FAMILIES_OF_SOLVERS(FAMILY)};
static const member integrators[] = {FP3_INTEGRATORS_IN_FAMILIES(MEMBER)};
static const member solvers[] = {FP3_SOLVERS_IN_FAMILIES(MEMBER)};
static const fp3_family other = {"other", "#888888"};

static const fp3_family *find(const member *members, size_t count, const fp3_family *families,
                              const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(members[i].name, name))
            return &families[members[i].family];
    return &other;
}

const fp3_family *fp3_family_of_integrators(size_t number) {
    const size_t count = sizeof of_integrators / sizeof *of_integrators;
    return number < count ? &of_integrators[number] : NULL;
}

const fp3_family *fp3_family_of_integrator(const char *name) {
    return find(integrators, sizeof integrators / sizeof *integrators, of_integrators, name);
}

const fp3_family *fp3_family_of_solver(const char *engine) {
    return find(solvers, sizeof solvers / sizeof *solvers, of_solvers, engine);
}
