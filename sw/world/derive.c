/* SPDX-License-Identifier: Apache-2.0 */
/* derive.c - see derive.h. */
#include "derive.h"

#include "compiler/compiled.h"
#include "compiler/inputs.h"
#include "compiler/start.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK 512 /* objects that are written at once */

/* What an input is computed from. */
typedef struct {
    uint64_t params; /* of the model, a bit each */
    uint64_t states; /* their starts, likewise */
    int has_h, is_shared;
    int is_variable; /* begins again with every start */
    int is_other;    /* the field's own place: not computed here */
    uint32_t place;
} source;

/* Inputs that are computed together, and what computes them. */
typedef struct {
    char *is_wanted, *was_wanted;
    uint32_t count;
    fp3_start *start; /* of was_wanted */
} portion;

struct fp3_derive {
    fp3_fields_def def;
    const fp3_field_table *table;
    source *sources; /* of each input */
    portion uniform,
        other, /* those that are the same for all objects; and those of marked objects */
        born;  /* all that an object has for itself */
    uint64_t params, states; /* that have changed */
    int has_h, has_restarted;
    int has_moved;             /* variables are the program's */
    int is_first;              /* not even what is always the same has been computed */
    uint64_t *marks, *newborn; /* objects, a bit each */
    int is_any_born;
    int is_all;                    /* all are marked */
    double *params_of, *starts_of; /* columns of a block */
    float *block;                  /* likewise of all inputs */
};

/* ---- open and close ---- */

static void see_variable(const variable *v, uint64_t all, source *s) {
    const int is_before =
        v->role == ROLE_BEFORE || v->role == ROLE_LOW_BEFORE || v->role == ROLE_LOST_BEFORE;
    s->is_variable = 1;
    s->is_other = v->role == ROLE_STEPS;
    s->states = is_before ? all : v->state == FP3_NONE ? 0 : (uint64_t)1 << v->state;
}

static uint64_t all_of(uint32_t count) {
    return count < 64 ? ((uint64_t)1 << count) - 1 : UINT64_MAX;
}

static int is_kept(const fp3_field_table *table, uint32_t param) {
    for (uint32_t i = 0; i < table->count; i++)
        if (table->list[i].kind == FP3_FIELD_PARAM && table->list[i].index == param)
            return table->list[i].is_kept;
    return 0;
}

static void see_sources(fp3_derive *d) {
    const fp3_compiled *c = d->def.compiled;
    const fp3_step *step = &((const fp3_compilation *)c->self)->p.step;
    uint32_t input = 0;
    for (uint32_t i = 0; i < c->input_count; i++) {
        const uint32_t param = fp3_start_param(c, i);
        d->sources[i] =
            (source){.params = c->inputs[i].params & all_of(d->table->model->param_count),
                     .has_h = c->inputs[i].has_h,
                     .is_shared = c->inputs[i].is_shared,
                     .is_other = param != FP3_NONE && !is_kept(d->table, param),
                     .place = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST)->index};
    }
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (fp3_inputs_has_variable(&step->variables[i]))
            see_variable(&step->variables[i], all_of(d->table->model->state_count),
                         &d->sources[input++]);
}

static int open_portion(portion *p, uint32_t inputs) {
    p->is_wanted = calloc(inputs + 1u, 1);
    p->was_wanted = calloc(inputs + 1u, 1);
    return p->is_wanted && p->was_wanted;
}

static void close_portion(portion *p) {
    free(p->is_wanted);
    free(p->was_wanted);
    fp3_start_close(&p->start);
}

fp3_status fp3_derive_open(const fp3_fields_def *def, const fp3_field_table *table,
                           fp3_derive **derive, fp3_error *error) {
    fp3_derive *d = *derive = calloc(1, sizeof *d);
    const uint32_t inputs = def->compiled->input_count;
    if (!d)
        return fp3_no_memory(error);
    d->def = *def;
    d->table = table;
    d->sources = calloc(inputs + 1u, sizeof *d->sources);
    d->marks = calloc(def->objects / 64 + 1, sizeof *d->marks);
    d->newborn = calloc(def->objects / 64 + 1, sizeof *d->newborn);
    d->params_of = calloc((table->model->param_count + 1u) * BLOCK, sizeof *d->params_of);
    d->starts_of = malloc((table->model->state_count + 1u) * BLOCK * sizeof *d->starts_of);
    d->block = malloc(((size_t)inputs + 1) * BLOCK * sizeof *d->block);
    if (!open_portion(&d->uniform, inputs) || !open_portion(&d->other, inputs) ||
        !open_portion(&d->born, inputs) || !d->sources || !d->marks || !d->newborn ||
        !d->params_of || !d->starts_of || !d->block) {
        fp3_derive_close(derive);
        return fp3_no_memory(error);
    }
    see_sources(d);
    for (uint32_t i = 0; i < inputs; i++)
        d->born.is_wanted[i] =
            (char)(!d->sources[i].is_other && (!d->sources[i].is_shared ||
                                               def->objects == 1)); /* who is alone has constants */
    d->is_first = 1;
    fp3_derive_restart(d);
    return FP3_OK;
}

void fp3_derive_close(fp3_derive **derive) {
    fp3_derive *d = *derive;
    if (!d)
        return;
    close_portion(&d->uniform);
    close_portion(&d->other);
    close_portion(&d->born);
    free(d->sources);
    free(d->marks);
    free(d->newborn);
    free(d->params_of);
    free(d->starts_of);
    free(d->block);
    free(d);
    *derive = NULL;
}

/* ---- what has changed ---- */

void fp3_derive_note(fp3_derive *d, const fp3_field *q, size_t first, size_t count) {
    const uint64_t bit = (uint64_t)1 << q->index;
    d->params |= q->kind == FP3_FIELD_PARAM ? bit : 0;
    d->states |= q->kind == FP3_FIELD_STATE ? bit : 0;
    d->has_h |= q->kind == FP3_FIELD_STEP;
    d->is_all |= count == d->def.objects;
    for (size_t i = first; !d->is_all && i < first + count; i++)
        d->marks[i / 64] |= (uint64_t)1 << i % 64;
}

void fp3_derive_born(fp3_derive *d, size_t object) {
    d->newborn[object / 64] |= (uint64_t)1 << object % 64;
    d->is_any_born = 1;
}

void fp3_derive_restart(fp3_derive *d) {
    d->has_restarted = d->is_all = 1;
    d->has_moved = 0;
    d->states = UINT64_MAX;
}

void fp3_derive_moved(fp3_derive *d) { d->has_moved = 1; }

/* The first object from here on with a mark, NULL: that all have, or the number of objects. */
static size_t next_marked(const fp3_derive *d, const uint64_t *marks, size_t from) {
    const size_t objects = d->def.objects;
    while (marks && from < objects && !(marks[from / 64] >> from % 64 & 1))
        from = marks[from / 64] >> from % 64 ? from + 1 : (from / 64 + 1) * 64;
    return from < objects ? from : objects;
}

/* How many from here on are marked, up to a block. */
static size_t marked_from(const fp3_derive *d, const uint64_t *marks, size_t from) {
    const size_t most = d->def.objects - from < BLOCK ? d->def.objects - from : BLOCK;
    size_t count = 0;
    while (count < most && (!marks || marks[(from + count) / 64] >> (from + count) % 64 & 1))
        count++;
    return count;
}

static int is_stale(const fp3_derive *d, const source *s) {
    return !s->is_other && !(s->is_variable && d->has_moved) &&
           (d->is_first || (s->params & d->params) || (s->states & d->states) ||
            (s->has_h && d->has_h) || (s->is_variable && d->has_restarted));
}

static int is_uniform(const fp3_derive *d, const source *s) {
    for (uint32_t i = 0; i < d->table->count; i++) {
        const fp3_field *q = &d->table->list[i];
        const uint64_t set = q->kind == FP3_FIELD_PARAM   ? s->params
                             : q->kind == FP3_FIELD_STATE ? s->states
                                                          : 0;
        if (q->column && set >> q->index & 1)
            return 0;
    }
    return 1;
}

static void choose(fp3_derive *d) {
    d->uniform.count = d->other.count = 0;
    for (uint32_t i = 0; i < d->def.compiled->input_count; i++) {
        const source *s = &d->sources[i];
        const int is_wanted = is_stale(d, s), is_one = is_wanted && is_uniform(d, s);
        d->uniform.is_wanted[i] = (char)is_one;
        d->other.is_wanted[i] = (char)(is_wanted && !is_one);
        d->uniform.count += (uint32_t)is_one;
        d->other.count += (uint32_t)(is_wanted && !is_one);
    }
}

/* What computes the portion; the one before where it is the same again. */
static fp3_status prepare(const fp3_derive *d, portion *p, size_t most, fp3_error *error) {
    const size_t size = d->def.compiled->input_count;
    if (p->start && !memcmp(p->is_wanted, p->was_wanted, size))
        return FP3_OK;
    fp3_start_close(&p->start);
    memcpy(p->was_wanted, p->is_wanted, size);
    return fp3_start_open(d->def.compiled, p->is_wanted, most, &p->start, error);
}

/* ---- computing ---- */

static void fill(const fp3_field *q, size_t first, size_t count, double *column) {
    if (q->column)
        memcpy(column, q->column + first, count * sizeof *column);
    else
        for (size_t i = 0; i < count; i++)
            column[i] = q->uniform;
}

/* What objects first .. first+count-1 have; returns h. */
static double fill_columns(fp3_derive *d, size_t first, size_t count) {
    double h = fp3_start_model(d->def.compiled)->step;
    for (uint32_t i = 0; i < d->table->count; i++) {
        const fp3_field *q = &d->table->list[i];
        if (q->kind == FP3_FIELD_STEP)
            h = q->uniform;
        else if (q->kind == FP3_FIELD_PARAM)
            fill(q, first, count, d->params_of + q->index * count);
        else if (q->kind == FP3_FIELD_STATE)
            fill(q, first, count, d->starts_of + q->index * count);
    }
    return h;
}

static fp3_status write_same(const fp3_derive *d, const source *s, float value) {
    float same[BLOCK];
    fp3_status status = FP3_OK;
    if (s->is_shared)
        return fp3_engine_write_shared_of(d->def.engine, d->def.group, s->place, 1, &value);
    for (size_t i = 0; i < BLOCK; i++)
        same[i] = value;
    for (size_t i = 0; !status && i < d->def.objects; i += BLOCK)
        status = fp3_engine_write(d->def.engine, d->def.first + i,
                                  d->def.objects - i < BLOCK ? d->def.objects - i : BLOCK, s->place,
                                  same);
    return status;
}

static fp3_status settle_uniform(fp3_derive *d, fp3_error *error) {
    const double h = fill_columns(d, 0, 1);
    fp3_status status = prepare(d, &d->uniform, 1, error);
    if (!status)
        status =
            fp3_start_values(d->uniform.start, d->params_of, d->starts_of, h, 1, d->block, error);
    for (uint32_t i = 0; !status && i < d->def.compiled->input_count; i++)
        if (d->uniform.is_wanted[i])
            status = write_same(d, &d->sources[i], d->block[i]);
    return status;
}

/* The error says which object it is only if it is one. */
static fp3_status compute_block(fp3_derive *d, const portion *p, size_t first, size_t count,
                                fp3_error *error) {
    fp3_error why;
    const double h = fill_columns(d, first, count);
    fp3_status status =
        fp3_start_values(p->start, d->params_of, d->starts_of, h, count, d->block, &why);
    if (status && (count == 1 || status == FP3_E_SYSTEM))
        return fp3_fail(error, status, "object %zu: %s", d->def.number + first, why.text);
    return status;
}

/* A block that fails is computed again, object by object, to find which one it is. */
static fp3_status compute(fp3_derive *d, const portion *p, size_t first, size_t count,
                          fp3_error *error) {
    fp3_status status = compute_block(d, p, first, count, error);
    if (!status || status == FP3_E_SYSTEM)
        return status;
    status = FP3_OK;
    for (size_t i = first; !status && i < first + count; i++)
        status = compute_block(d, p, i, 1, error);
    return status;
}

/* A configuration of one object has params among the constants. */
static fp3_status write_block(const fp3_derive *d, const portion *p, size_t first, size_t count,
                              fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < d->def.compiled->input_count; i++) {
        const source *s = &d->sources[i];
        const float *values = d->block + i * count;
        if (!p->is_wanted[i])
            continue;
        if (s->is_shared && d->def.objects > 1)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "'%s' differs between objects: the program was compiled for one object",
                            d->def.compiled->inputs[i].name);
        status =
            s->is_shared
                ? fp3_engine_write_shared_of(d->def.engine, d->def.group, s->place, 1, values)
                : fp3_engine_write(d->def.engine, d->def.first + first, count, s->place, values);
    }
    return status;
}

/* marks: NULL: all objects. */
static fp3_status settle_marked(fp3_derive *d, portion *p, const uint64_t *marks,
                                fp3_error *error) {
    fp3_status status = prepare(d, p, BLOCK, error);
    for (size_t i = next_marked(d, marks, 0); !status && i < d->def.objects;) {
        const size_t count = marked_from(d, marks, i);
        status = compute(d, p, i, count, error);
        if (!status)
            status = write_block(d, p, i, count, error);
        i = next_marked(d, marks, i + count);
    }
    return status;
}

static fp3_status settle_born(fp3_derive *d, fp3_error *error) {
    const fp3_status status =
        d->is_any_born ? settle_marked(d, &d->born, d->newborn, error) : FP3_OK;
    if (status || !d->is_any_born)
        return status;
    memset(d->newborn, 0, (d->def.objects / 64 + 1) * sizeof *d->newborn);
    d->is_any_born = 0;
    return FP3_OK;
}

fp3_status fp3_derive_settle(fp3_derive *d, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (!d->is_first && !d->params && !d->states && !d->has_h && !d->has_restarted)
        return settle_born(d, error);
    choose(d);
    if (d->uniform.count)
        status = settle_uniform(d, error);
    if (!status && d->other.count)
        status = settle_marked(d, &d->other, d->is_all ? NULL : d->marks, error);
    if (status)
        return status;
    d->params = d->states = 0;
    d->is_first = d->has_h = d->has_restarted = d->is_all = 0;
    memset(d->marks, 0, (d->def.objects / 64 + 1) * sizeof *d->marks);
    return settle_born(d, error);
}
