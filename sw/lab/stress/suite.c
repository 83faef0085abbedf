/* SPDX-License-Identifier: Apache-2.0 */
/* suite.c - see suite.h. */
#include "suite.h"

#include "sections.h"

#include <string.h>

typedef fp3_status section_fn(const fp3_trial *trial, fp3_error *error);

static const struct {
    const char *name;
    section_fn *run;
    const char *by; /* once, by this integrator; NULL: by every one */
} sections[] = {
    {"stability", fp3_section_stability, NULL},
    {"steps", fp3_section_steps, NULL},
    {"events", fp3_section_events, NULL},
    {"drift", fp3_section_drift, NULL},
    {"reversal", fp3_section_reversal, NULL},
    {"chance", fp3_section_chance, NULL},
    {"stagnation", fp3_section_stagnation, "euler"},
    {"subnormal", fp3_section_subnormal, "euler"},
    {"failures", fp3_section_failures, "euler"},
    {"chaos", fp3_section_chaos, "rk4"},
};
enum { SECTIONS = sizeof sections / sizeof *sections };

static const char *const few[] = {"rk4", "dopri5", "verlet", NULL};

/* By one integrator. */
static fp3_status try(const fp3_stress_options *options, unsigned section, const char *name,
                      fp3_verdicts *verdicts, fp3_error *error) {
    fp3_integrator *integrator = NULL, *spoiled = NULL;
    fp3_trial trial = {.options = options, .verdicts = verdicts};
    if (options->say)
        options->say(options->say_user, sections[section].name, name);
    fp3_status status = fp3_integrator_find(name, &integrator, error);
    trial.integrator = trial.run = integrator;
    if (!status && options->spoil)
        status = fp3_integrator_find(name, &spoiled, error);
    if (!status && options->spoil) {
        options->spoil(spoiled);
        trial.run = spoiled;
    }
    if (!status)
        status = sections[section].run(&trial, error);
    fp3_integrator_free(&integrator);
    fp3_integrator_free(&spoiled);
    return status;
}

static const char *integrator_of(const fp3_stress_options *options, unsigned number) {
    return options->integrators ? options->integrators[number]
           : options->is_quick  ? few[number]
                                : fp3_integrator_name(number);
}

static fp3_status run_section(const fp3_stress_options *options, unsigned section,
                              fp3_verdicts *verdicts, fp3_error *error) {
    const char *name;
    fp3_status status = FP3_OK;
    if (sections[section].by)
        return try(options, section, sections[section].by, verdicts, error);
    for (unsigned i = 0; !status && (name = integrator_of(options, i)); i++)
        status = try(options, section, name, verdicts, error);
    return status;
}

/* What there is instead; a section or an arithmetic. */
static fp3_status no_such(const char *kind, const char *name, unsigned count,
                          const char *(*name_of)(unsigned), fp3_error *error) {
    char names[256] = "";
    for (unsigned i = 0; i < count; i++) {
        strcat(names, i ? ", " : "");
        strcat(names, name_of(i));
    }
    return fp3_fail(error, FP3_E_ARGUMENT, "no %s '%s': there are %s", kind, name, names);
}

static const char *section_name(unsigned i) { return sections[i].name; }
static const char *arithmetic_name(unsigned i) { return fp3_lab_name(&fp3_lab_arithmetics[i]); }

static fp3_status check_arithmetics(const char *const *names, fp3_error *error) {
    for (; names && *names; names++) {
        unsigned i = 0;
        while (i < fp3_lab_arithmetic_count && strcmp(*names, arithmetic_name(i)) != 0)
            i++;
        if (i == fp3_lab_arithmetic_count)
            return no_such("arithmetic", *names, i, arithmetic_name, error);
    }
    return FP3_OK;
}

fp3_status fp3_stress_suite(const fp3_stress_options *options, fp3_verdicts *verdicts,
                            fp3_error *error) {
    fp3_status status = check_arithmetics(options->arithmetics, error);
    int is_found = status || !options->section;
    for (unsigned i = 0; !status && i < SECTIONS; i++)
        if (!options->section || !strcmp(options->section, sections[i].name)) {
            is_found = 1;
            status = run_section(options, i, verdicts, error);
        }
    return is_found ? status : no_such("section", options->section, SECTIONS, section_name, error);
}
