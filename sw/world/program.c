/* SPDX-License-Identifier: Apache-2.0 */
/* program.c - a program from a file: an image is read, assembly assembled, a model compiled. */
#include <fp3/program.h>

#include <fp3/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/definition.h"
#include "base/file.h"
#include "base/report.h"
#include "machine/neighbours.h"
#include "relations.h"

void fp3_program_set_default(fp3_program_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->adaptive = fp3_adaptive_default();
    def->compile = fp3_compile_default();
    def->alone = def->compile.config;
    def->compile.config = NULL;
}

static int ends(const char *path, const char *end) {
    const size_t size = strlen(path), length = strlen(end);
    return size > length && strcasecmp(path + size - length, end) == 0;
}

int fp3_program_is_model(const char *path) { return ends(path, ".ode"); }

int fp3_program_is_named(const char *path) {
    return fp3_program_is_model(path) || ends(path, ".s") || ends(path, ".fp3");
}

/* *report is taken from the assembly. */
static fp3_status assemble(const char *path, fp3_program *program, char **report,
                           fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    fp3_assembly *assembly = NULL;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (!status)
        status = fp3_assemble(text, size, path, &assembly, error);
    if (!status) {
        program->image = assembly->image;
        assembly->image = NULL;
    } else if (assembly) {
        *report = assembly->report;
        assembly->report = NULL;
    }
    fp3_assembly_free(&assembly);
    free(text);
    return status;
}

/* A message of the compiler about a place in a model has the form of the reader's messages: with
 * the line and a caret. */
static fp3_status tell(const char *path, const char *text, size_t size, fp3_status status,
                       const fp3_error *why, char **report, fp3_error *error) {
    const char *message = why->text + why->message;
    const fp3_location at = {why->line, why->column};
    if (at.line)
        *report = fp3_report_one(path, text, size, at, message);
    return fp3_fail_at(error, status, path, at.line, at.column, "%s", message);
}

static fp3_status compile(const char *text, size_t size, const char *name,
                          const fp3_program_def *def, fp3_program *program, char **report,
                          fp3_error *error) {
    const char *integrator = def->integrator ? def->integrator
                             : def->is_adaptive && def->adaptive.tolerance != 0
                                 ? FP3_ADAPTIVE_INTEGRATOR
                                 : FP3_FIXED_INTEGRATOR;
    fp3_error why;
    fp3_status status = fp3_model_read(text, size, name, &program->model, report, error);
    if (!status && def->is_adaptive) {
        status = fp3_model_adapt(program->model, &def->adaptive, &why);
        if (status)
            fp3_fail(error, status, "%s: %s", name, why.text);
    }
    if (!status)
        status = fp3_integrator_find(integrator, &program->integrator, error);
    if (status)
        return status;
    program->source = strdup(name);
    if (!program->source)
        return fp3_no_memory(error);
    fp3_compile_def how = def->compile;
    program->sees_others = program->model->relation_count > 0;
    if (!how.config)
        how.config = program->sees_others ? FP3_WORLD : def->alone;
    program->config = how.config;
    status = fp3_compile(program->model, program->integrator, &how, &program->compiled, &why);
    if (status)
        return tell(name, text, size, status, &why, report, error);
    program->image = program->compiled->image;
    return FP3_OK;
}

static fp3_status compile_file(const char *path, const fp3_program_def *def, fp3_program *program,
                               char **report, fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (!status)
        status = compile(text, size, path, def, program, report, error);
    free(text);
    return status;
}

static fp3_status begin(const fp3_program_def *def, fp3_program **program, fp3_error *error) {
    *program = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_program_def", error))
        return FP3_E_ARGUMENT;
    *program = calloc(1, sizeof **program);
    return *program ? FP3_OK : fp3_no_memory(error);
}

/* *said goes to the caller, or nowhere. */
static fp3_status hand_over(fp3_status status, fp3_program **program, char *said, char **report) {
    if (status)
        fp3_program_close(program);
    if (report)
        *report = said;
    else
        free(said);
    return status;
}

fp3_status fp3_program_read(const char *text, size_t size, const char *name,
                            const fp3_program_def *def, fp3_program **program, char **report,
                            fp3_error *error) {
    char *said = NULL;
    fp3_status status = begin(def, program, error);
    if (!status)
        status = compile(text, size, name, def, *program, &said, error);
    return hand_over(status, program, said, report);
}

static fp3_status look_for_others(fp3_program *program, fp3_error *error) {
    fp3_neighbourhood found;
    const fp3_status status = fp3_neighbourhood_find(program->image, &found, error);
    program->sees_others = !status && found.is_any;
    program->config = program->sees_others ? FP3_WORLD : NULL;
    return status;
}

fp3_status fp3_program_open(const char *path, const fp3_program_def *def, fp3_program **program,
                            char **report, fp3_error *error) {
    char *said = NULL;
    fp3_status status = begin(def, program, error);
    if (status)
        return hand_over(status, program, said, report);
    if (def->is_model || fp3_program_is_model(path))
        status = compile_file(path, def, *program, &said, error);
    else if (ends(path, ".s"))
        status = assemble(path, *program, &said, error);
    else
        status = fp3_image_load(path, &(*program)->image, error);
    if (!status && !(*program)->compiled)
        status = look_for_others(*program, error);
    return hand_over(status, program, said, report);
}

void fp3_program_close(fp3_program **program) {
    fp3_program *p = *program;
    if (!p)
        return;
    if (!p->compiled) /* else the image is its own */
        fp3_image_free(&p->image);
    fp3_compiled_free(&p->compiled);
    fp3_integrator_free(&p->integrator);
    fp3_model_free(&p->model);
    free(p->source);
    free(p);
    *program = NULL;
}
