/* SPDX-License-Identifier: Apache-2.0 */
/* tune_machines.c - see tune_machines.h. */
#include "tune_machines.h"

#include "json.h"
#include "machine/config.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- which ones ---- */

static fp3_status add(fp3_tune_machines *m, const char *config, fp3_error *error) {
    for (size_t i = 0; i < m->count; i++)
        if (strcmp(m->list[i].config, config) == 0)
            return fp3_fail(error, FP3_E_ARGUMENT, "found configuration '%s' twice", config);
    if (m->count == FP3_TUNE_MACHINES_MOST)
        return fp3_fail(error, FP3_E_ARGUMENT, "found more than %d configurations",
                        FP3_TUNE_MACHINES_MOST);
    m->list[m->count++] =
        (fp3_tune_machine){.config = config, .hardware = fp3_placed_find(config), .cost = INFINITY};
    return FP3_OK;
}

static int is_other(const fp3_config *config, const char *than) {
    return !fp3_config_computes_as(config, fp3_config_find(than));
}

static fp3_status add_all(fp3_tune_machines *m, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < fp3_placed_count; i++) {
        const fp3_config *config = fp3_config_find(fp3_placed_known[i].config);
        if (is_other(config, m->list[0].config) && is_other(config, "many_full"))
            status = add(m, config->name, error);
    }
    return status;
}

static fp3_status add_one(fp3_tune_machines *m, const char *name, fp3_error *error) {
    const fp3_config *config;
    const fp3_status status = fp3_config_choose(name, &config, error);
    if (status)
        return status;
    if (!is_other(config, m->list[0].config))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "configuration '%s' computes as '%s' does: expected another arithmetic",
                        name, m->list[0].config);
    return add(m, config->name, error);
}

static fp3_status check_figures(const fp3_tune_machines *m, fp3_error *error) {
    for (size_t i = 0; m->count > 1 && i < m->count; i++)
        if (!m->list[i].hardware)
            return fp3_fail(
                error, FP3_E_ARGUMENT,
                "LUTs and clock of configuration '%s' are not known, so its cost is not known",
                m->list[i].config);
    return FP3_OK;
}

fp3_status fp3_tune_machines_find(fp3_tune_machines *m, const char *config,
                                  const char *const *asked, size_t count, fp3_error *error) {
    *m = (fp3_tune_machines){0};
    fp3_status status = add(m, config, error);
    for (size_t i = 0; !status && i < count; i++)
        status = strcmp(asked[i], "all") == 0 ? add_all(m, error) : add_one(m, asked[i], error);
    return status ? status : check_figures(m, error);
}

/* ---- the work ---- */

static const fp3_tune_row *row_of(const fp3_tune_machine *machine) {
    const fp3_tuning *t = machine->tuning;
    return t && t->best < t->row_count ? &t->rows[t->best] : NULL;
}

/* The smallest error that was found, if the tolerance was not met. */
static double error_of(const fp3_tune_machine *machine) {
    const fp3_tuning *t = machine->tuning;
    double lowest = INFINITY;
    if (row_of(machine))
        return isfinite(t->error_held_out) ? t->error_held_out : row_of(machine)->error;
    for (size_t i = 0; t && i < t->row_count; i++)
        lowest = fmin(lowest, t->rows[i].lowest);
    return lowest;
}

static double cost_of(const fp3_tune_machine *machine) {
    if (!machine->tuning->is_met || !machine->hardware)
        return INFINITY;
    return machine->hardware->luts * row_of(machine)->cycles * 1e3 / machine->hardware->mhz;
}

fp3_status fp3_tune_machines_tune(fp3_tune_machines *m, fp3_tune_def *def, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < m->count; i++) {
        def->config = m->list[i].config;
        m->list[i].why.text[0] = '\0';
        status = fp3_tune(def, &m->list[i].tuning, error);
        if (status == FP3_E_PROGRAM && i) {
            m->list[i].why = *error;
            status = FP3_OK;
        } else if (!status)
            m->list[i].cost = cost_of(&m->list[i]);
        if (!status && m->list[i].cost < m->list[m->best].cost)
            m->best = i;
    }
    def->config = m->list[m->best].config;
    return status;
}

void fp3_tune_machines_free(fp3_tune_machines *m) {
    for (size_t i = 0; i < m->count; i++)
        fp3_tuning_free(&m->list[i].tuning);
}

/* ---- what is said ---- */

static void print_row(const fp3_tune_machine *machine) {
    const fp3_tune_row *row = row_of(machine);
    if (machine->tuning)
        printf("%-16s %9.2e ", machine->config, error_of(machine));
    if (!machine->tuning)
        printf("%-16s %9s %12s %7d %8.2f %12s  left out: %s\n", machine->config, "-", "-",
               machine->hardware->luts, machine->hardware->mhz, "-", machine->why.text);
    else if (!isfinite(machine->cost))
        printf("%12s %7d %8.2f %12s  %s\n", "-", machine->hardware->luts, machine->hardware->mhz,
               "-", "misses the tolerance");
    else
        printf("%12.1f %7d %8.2f %12.4g  %s, %s\n", row->cycles, machine->hardware->luts,
               machine->hardware->mhz, machine->cost, row->integrator,
               fp3_arithmetic_of(row->arithmetic)->name);
}

/* The cheapest of the others; NULL: none meets the tolerance. */
static const fp3_tune_machine *second_of(const fp3_tune_machines *m) {
    const fp3_tune_machine *second = NULL;
    for (size_t i = 0; i < m->count; i++)
        if (i != m->best && isfinite(m->list[i].cost) &&
            (!second || m->list[i].cost < second->cost))
            second = &m->list[i];
    return second;
}

static void print_reason(const fp3_tune_machines *m) {
    const fp3_tune_machine *best = &m->list[m->best], *second = second_of(m);
    if (!isfinite(best->cost))
        printf("%-16s none meets the tolerance\n", "configuration");
    else if (!second)
        printf("%-16s %s: no other meets the tolerance\n", "configuration", best->config);
    else
        printf("%-16s %s costs least: %.3f of the LUTs of %s, %.3f of the cycles and %.3f of the "
               "clock make %.3f of its LUT ns\n",
               "configuration", best->config, (double)best->hardware->luts / second->hardware->luts,
               second->config, row_of(best)->cycles / row_of(second)->cycles,
               best->hardware->mhz / second->hardware->mhz, best->cost / second->cost);
}

void fp3_tune_machines_print(const fp3_tune_machines *m) {
    if (m->count == 1)
        return;
    printf("%-16s %9s %12s %7s %8s %12s\n", "configuration", "error", "cycles", "LUT4", "MHz",
           "LUT ns");
    for (size_t i = 0; i < m->count; i++)
        print_row(&m->list[i]);
    print_reason(m);
}

json_t *fp3_tune_machines_json(const fp3_tune_machines *m) {
    json_t *list = json_array();
    for (size_t i = 0; m->count > 1 && i < m->count; i++) {
        const fp3_tune_machine *machine = &m->list[i];
        const fp3_tune_row *row = row_of(machine);
        json_array_append_new(
            list,
            json_pack("{s:s, s:b, s:s, s:o, s:o, s:o, s:o, s:i, s:f, s:o}", "config",
                      machine->config, "met", machine->tuning && machine->tuning->is_met, "why",
                      machine->why.text, "error", fp3_json_number(error_of(machine)), "integrator",
                      row ? json_string(row->integrator) : json_null(), "arithmetic",
                      row ? json_string(fp3_arithmetic_of(row->arithmetic)->name) : json_null(),
                      "cycles", row ? fp3_json_number(row->cycles) : json_null(), "lut4",
                      machine->hardware->luts, "mhz", machine->hardware->mhz, "lut_ns",
                      fp3_json_number(machine->cost)));
    }
    return list;
}
