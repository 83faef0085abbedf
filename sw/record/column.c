/* SPDX-License-Identifier: Apache-2.0 */
/* column.c - see column.h. */
#include "column.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_MOST 262144u       /* objects: a chunk of 1 MB of floats */
#define BLOCKS_BYTES (48u << 20) /* of all columns together */

/* What a snapshot has besides the values; the last only if objects are born and gone. */
static const char *const reserved[] = {"step", "time", "object", "life"};
#define LIFE 3

/* ---- finding ---- */

static uint32_t find_definition(const fp3_definition *list, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(list[i].name, name))
            return i;
    return FP3_NONE;
}

static void describe(const fp3_model *model, fp3_column *column) {
    const uint32_t state = model ? fp3_model_state(model, column->name) : FP3_NONE;
    if (state == FP3_NONE)
        return;
    column->unit = model->states[state].dimension;
    column->doc = model->states[state].doc;
}

static int find_state(const fp3_program *program, fp3_column *column) {
    const fp3_symbol *symbol =
        fp3_image_find(program->image, column->name, FP3_CLASS(FP3_SYMBOL_STATE));
    if (!symbol)
        return 0;
    column->reg = symbol->index;
    column->kind =
        (int)symbol->index == fp3_image_slept(program->image) ? FP3_COLUMN_SLEPT : FP3_COLUMN_STATE;
    describe(program->model, column);
    const uint32_t state =
        program->model ? fp3_model_state(program->model, column->name) : FP3_NONE;
    const int low = program->compiled ? fp3_compiled_low(program->compiled, state) : -1;
    if (low >= 0) {
        column->kind = FP3_COLUMN_SUM;
        column->low = (uint32_t)low;
    }
    return 1;
}

static int find_computed(const fp3_model *model, fp3_column *column) {
    const fp3_definition *list = model->definitions;
    uint32_t i = find_definition(list, model->definition_count, column->name);
    if (i == FP3_NONE) {
        list = model->invariants;
        i = find_definition(list, model->invariant_count, column->name);
    }
    if (i == FP3_NONE)
        return 0;
    column->kind = FP3_COLUMN_COMPUTED;
    column->expr = list[i].expr;
    column->unit = list[i].unit;
    return 1;
}

static void append(char *text, size_t size, const char *name) {
    const size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", used ? ", " : "", name);
}

static fp3_status unknown(const fp3_program *program, const char *name, fp3_error *error) {
    const fp3_model *model = program->model;
    char names[400] = "";
    if (model &&
        find_definition(model->group_invariants, model->group_invariant_count, name) != FP3_NONE)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'%s' is an invariant of all objects together, and a recording looks at "
                        "each object by itself; --check prints it",
                        name);
    for (uint32_t i = 0; i < program->image->symbol_count; i++)
        if (program->image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
            append(names, sizeof names, program->image->symbols[i].name);
    for (uint32_t i = 0; model && i < model->definition_count; i++)
        append(names, sizeof names, model->definitions[i].name);
    for (uint32_t i = 0; model && i < model->invariant_count; i++)
        append(names, sizeof names, model->invariants[i].name);
    return fp3_fail(error, FP3_E_ARGUMENT, "nothing to observe is called '%s': there %s %s%s", name,
                    strchr(names, ',') ? "are" : "is", names,
                    model ? "" : "; definitions and invariants are a model's (*.ode)");
}

static fp3_status add(const fp3_program *program, const char *name, int has_lives,
                      fp3_columns *columns, fp3_error *error) {
    fp3_column *column = &columns->list[columns->count];
    *column = (fp3_column){.unit = "", .doc = ""};
    for (size_t i = 0; i < LIFE + (size_t)has_lives; i++)
        if (!strcmp(reserved[i], name))
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "'%s' cannot be observed: a snapshot has a %s of its own", name, name);
    for (size_t i = 0; i < columns->count; i++)
        if (!strcmp(columns->list[i].name, name))
            return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is observed twice", name);
    if (strlen(name) < sizeof column->name)
        strcpy(column->name, name);
    if (!*column->name || (!find_state(program, column) &&
                           !(program->model && find_computed(program->model, column))))
        return unknown(program, name, error);
    columns->count++;
    return FP3_OK;
}

/* A model's own; `steps` and what updates lose are the compiler's. */
static fp3_status add_states(const fp3_program *program, int has_lives, fp3_columns *columns,
                             fp3_error *error) {
    const fp3_image *image = program->image;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && program->model && i < program->model->state_count; i++)
        status = add(program, program->model->states[i].name, has_lives, columns, error);
    for (uint32_t i = 0; !status && !program->model && i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
            status = add(program, image->symbols[i].name, has_lives, columns, error);
    return status ? status
           : columns->count
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "the program has no state to observe");
}

static void add_life(fp3_columns *columns) {
    fp3_column *column = &columns->list[columns->count++];
    *column = (fp3_column){
        .unit = "", .doc = "0: not born yet, 1: alive, 2: gone", .kind = FP3_COLUMN_LIFE};
    strcpy(column->name, reserved[LIFE]);
}

/* ---- room ---- */

static fp3_status make_room(const fp3_program *program, size_t objects, fp3_columns *columns,
                            fp3_error *error) {
    const size_t states = program->model ? program->model->state_count + 1u : 0;
    const int is_double = program->compiled && program->compiled->arithmetic == FP3_DOUBLE_SINGLE;
    const size_t words = is_double ? 2 * (states + 1) : states;
    const size_t most = BLOCKS_BYTES / (sizeof(double) * columns->count + sizeof(float) * words);
    fp3_status status = FP3_OK;
    const size_t room = most < BLOCK_MOST ? most : BLOCK_MOST;
    const size_t blocks = (objects + room - 1) / room;
    columns->room = (objects + blocks - 1) / blocks; /* so that the last is as full as the others */
    for (size_t i = 0; !status && i < columns->count; i++) {
        fp3_column *column = &columns->list[i];
        const size_t size = fp3_column_is_wide(column) ? sizeof(double) : sizeof(float);
        if (!(column->values = calloc(columns->room, size)))
            return fp3_no_memory(error);
        if (column->kind == FP3_COLUMN_SUM && !columns->words &&
            !(columns->words = calloc(2 * columns->room, sizeof *columns->words)))
            return fp3_no_memory(error);
        if (column->kind != FP3_COLUMN_COMPUTED)
            continue;
        if (!columns->evaluator)
            status = fp3_evaluator_open(program, columns->room, &columns->evaluator, error);
        if (!status)
            status = fp3_evaluator_add(columns->evaluator, program, column->expr, error);
    }
    return status;
}

fp3_status fp3_columns_open(const fp3_program *program, const char *const *names, size_t count,
                            size_t objects, int has_lives, fp3_columns *columns, fp3_error *error) {
    const fp3_model *model = program->model;
    /* All that has a name, each once. */
    const size_t most = program->image->symbol_count +
                        (model ? model->definition_count + model->invariant_count : 0);
    fp3_status status = FP3_OK;
    *columns = (fp3_columns){.list = calloc(most + 2, sizeof *columns->list)};
    if (!columns->list)
        return fp3_no_memory(error);
    if (!names)
        status = add_states(program, has_lives, columns, error);
    for (size_t i = 0; !status && names && i < count; i++)
        status = add(program, names[i], has_lives, columns, error);
    if (!status && !columns->count)
        status = fp3_fail(error, FP3_E_ARGUMENT, "nothing is observed");
    if (!status && has_lives)
        add_life(columns);
    return status ? status : make_room(program, objects, columns, error);
}

void fp3_columns_free(fp3_columns *columns) {
    for (size_t i = 0; i < columns->count; i++)
        free(columns->list[i].values);
    free(columns->list);
    free(columns->words);
    fp3_evaluator_free(&columns->evaluator);
    *columns = (fp3_columns){0};
}

/* ---- blocks ---- */

fp3_status fp3_columns_begin(fp3_columns *columns, const fp3_source *source, fp3_error *error) {
    return columns->evaluator ? fp3_evaluator_begin(columns->evaluator, source, error) : FP3_OK;
}

static void tell_lives(const fp3_engine *engine, size_t first, size_t count, uint32_t *stages) {
    for (size_t i = 0; i < count; i++)
        stages[i] = (uint32_t)fp3_engine_life(engine, first + i);
}

static void fill(const fp3_columns *columns, size_t i) {
    const double *values = fp3_evaluator_values(columns->evaluator, i);
    for (size_t c = 0; c < columns->count; c++)
        if (columns->list[c].kind == FP3_COLUMN_COMPUTED)
            ((double *)columns->list[c].values)[i] = values[columns->list[c].expr];
}

static fp3_status read_sum(const fp3_columns *columns, const fp3_column *column, fp3_engine *engine,
                           size_t first, size_t count) {
    float *low = columns->words + columns->room;
    fp3_status status = fp3_engine_read(engine, first, count, column->reg, columns->words);
    if (!status)
        status = fp3_engine_read(engine, first, count, column->low, low);
    for (size_t i = 0; !status && i < count; i++)
        ((double *)column->values)[i] = (double)columns->words[i] + (double)low[i];
    return status;
}

fp3_status fp3_columns_read(fp3_columns *columns, const fp3_source *source, uint64_t step,
                            size_t first, size_t count) {
    const size_t at = source->first + first;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < columns->count; i++)
        if (columns->list[i].kind == FP3_COLUMN_LIFE)
            tell_lives(source->engine, at, count, columns->list[i].values);
        else if (columns->list[i].kind == FP3_COLUMN_SUM)
            status = read_sum(columns, &columns->list[i], source->engine, at, count);
        else if (columns->list[i].kind != FP3_COLUMN_COMPUTED)
            status = fp3_engine_read(source->engine, at, count, columns->list[i].reg,
                                     columns->list[i].values);
    if (status || !columns->evaluator)
        return status;
    status = fp3_evaluator_read(columns->evaluator, source, step, first, count);
    for (size_t i = 0; !status && i < count; i++)
        fill(columns, i);
    return status;
}
