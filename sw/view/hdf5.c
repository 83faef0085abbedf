/* SPDX-License-Identifier: Apache-2.0 */
/* hdf5.c - a recording in HDF5: a dataset of each name, links and reaches beside them. */
#include "edges.h"
#include "reader.h"

#include "base/path.h"
#include "record/library_hdf5.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_VALUES (1u << 20) /* that are read at once */

typedef struct {
    fp3_view_reader reader;
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    int step, time; /* datasets; -1: there is none */
    uint64_t rows;  /* snapshots of the file */
} hdf5;

static fp3_status failed(const fp3_view_recording *r, fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    return fp3_hdf5_cannot_read(self->calls, self->file, r->path, error);
}

static void hdf5_close(fp3_view_reader *reader) {
    hdf5 *self = (hdf5 *)reader;
    if (self->file)
        self->calls->close(self->file);
    free(self);
}

/* ---- what there is ---- */

static fp3_status add_column(fp3_view_recording *r, int dataset, const fp3_hdf5_table *table,
                             fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    if (r->column_count && table->columns != r->objects)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: '%s' has %" PRIu64 " objects, and '%s' has %zu",
                        r->path, table->name, table->columns, r->columns[0].name, r->objects);
    r->objects = table->columns;
    fp3_status status = fp3_view_add(
        r, strdup(table->name), self->calls->text_of(self->file, dataset, "units"), dataset, error);
    if (status)
        return status;
    fp3_view_column *column = &r->columns[r->column_count - 1];
    char *doc = self->calls->text_of(self->file, dataset, "description");
    char *velocity = self->calls->text_of(self->file, dataset, "velocity");
    if (doc) {
        free(column->doc);
        column->doc = doc;
    }
    if (velocity) {
        free(column->velocity);
        column->velocity = velocity;
    }
    return FP3_OK;
}

/* "links:springs" */
static const char *behind(const char *name, const char *what) {
    const size_t length = strlen(what);
    return !strncmp(name, what, length) && name[length] == ':' ? name + length + 1 : NULL;
}

static fp3_status check_pairs(const fp3_view_recording *r, const fp3_view_relation *of,
                              fp3_error *error) {
    for (size_t i = 0; i < 2 * of->count; i++)
        if (of->pairs[i] >= r->objects)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "%s: link %zu of '%s' names object %" PRIu32 ", and there are %zu",
                            r->path, i / 2, of->name, of->pairs[i], r->objects);
    return FP3_OK;
}

static fp3_status add_links(fp3_view_recording *r, int dataset, const fp3_hdf5_table *table,
                            fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    if (r->relation_count == FP3_VIEW_RELATIONS_MOST || table->columns != 2 || !table->rows ||
        table->rows > FP3_VIEW_VALUES_MOST)
        return FP3_OK;
    fp3_view_relation *of = &r->relations[r->relation_count++];
    of->name = strdup(behind(table->name, "links"));
    of->position = strdup("");
    of->count = table->rows;
    of->pairs = malloc(2 * of->count * sizeof *of->pairs);
    if (!of->name || !of->position || !of->pairs)
        return fp3_no_memory(error);
    const fp3_hdf5_part part = {.rows = of->count, .columns = 2};
    if (self->calls->read(self->file, dataset, FP3_HDF5_UINT32, &part, of->pairs))
        return failed(r, error);
    return FP3_OK;
}

/* Of a relation that has no dataset, so the attributes are looked for by the relation's name. */
static fp3_status add_near(fp3_view_recording *r, const char *name, double reach,
                           fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    char attribute[300];
    if (r->relation_count == FP3_VIEW_RELATIONS_MOST)
        return FP3_OK;
    fp3_view_relation *of = &r->relations[r->relation_count++];
    snprintf(attribute, sizeof attribute, "position:%s", name);
    of->reach = reach;
    of->name = strdup(name);
    of->position = self->calls->text_of(self->file, -1, attribute);
    if (!of->position)
        of->position = strdup("");
    return of->name && of->position ? FP3_OK : fp3_no_memory(error);
}

static fp3_status note(fp3_view_recording *r, int dataset, fp3_error *error) {
    hdf5 *self = (hdf5 *)r->reader;
    fp3_hdf5_table table;
    if (self->calls->describe(self->file, dataset, &table))
        return failed(r, error);
    if (!strcmp(table.name, "step") && !table.columns)
        self->step = dataset;
    else if (!strcmp(table.name, "time") && !table.columns)
        self->time = dataset;
    else if (behind(table.name, "links"))
        return add_links(r, dataset, &table, error);
    else if (table.columns && !strchr(table.name, ':'))
        return add_column(r, dataset, &table, error);
    return FP3_OK;
}

/* All have as many snapshots as there are steps. */
static fp3_status check_rows(const fp3_view_recording *r, fp3_error *error) {
    hdf5 *self = (hdf5 *)r->reader;
    fp3_hdf5_table table;
    if (self->step < 0 || !r->column_count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: no recording: expected a dataset 'step' and one of [snapshot][object] "
                        "for each name, as fp3 run --output writes them",
                        r->path);
    if (self->calls->describe(self->file, self->step, &table))
        return failed(r, error);
    self->rows = table.rows;
    for (size_t i = 0; i < r->column_count + (self->time >= 0); i++) {
        const int dataset = i < r->column_count ? r->columns[i].source : self->time;
        if (self->calls->describe(self->file, dataset, &table))
            return failed(r, error);
        if (table.rows != self->rows)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "%s: '%s' has %" PRIu64 " snapshots, and 'step' has %" PRIu64, r->path,
                            table.name, table.rows, self->rows);
    }
    return FP3_OK;
}

/* ---- rigid bodies ---- */

/* A table by its name, or no rows; the caller frees *data. */
static fp3_status read_table(const fp3_view_recording *r, const char *name, uint64_t columns,
                             fp3_hdf5_type type, void **data, size_t *rows, fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    const size_t size = type == FP3_HDF5_DOUBLE ? sizeof(double) : sizeof(uint32_t);
    fp3_hdf5_table table;
    *data = NULL;
    *rows = 0;
    for (int i = 0; i < self->calls->count(self->file); i++) {
        if (self->calls->describe(self->file, i, &table))
            return failed(r, error);
        if (strcmp(table.name, name) != 0)
            continue;
        if (table.columns != columns || table.rows > FP3_VIEW_VALUES_MOST)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "%s: '%s' has %" PRIu64 " columns, expected %" PRIu64, r->path, name,
                            table.columns, columns);
        const fp3_hdf5_part part = {.rows = table.rows, .columns = columns};
        *rows = table.rows;
        if (!(*data = malloc((table.rows + 1) * columns * size)))
            return fp3_no_memory(error);
        return self->calls->read(self->file, i, type, &part, *data) ? failed(r, error) : FP3_OK;
    }
    return FP3_OK;
}

static fp3_status unfit(const fp3_view_recording *r, const char *name, size_t row,
                        fp3_error *error) {
    return fp3_fail(error, FP3_E_ARGUMENT, "%s: row %zu of '%s' fits no other table of the file",
                    r->path, row, name);
}

/* Two tables with as many rows. */
static fp3_status read_two(const fp3_view_recording *r, const char *const names[2],
                           const uint64_t columns[2], uint32_t **words, double **numbers,
                           size_t *rows, fp3_error *error) {
    size_t others = 0;
    fp3_status status =
        read_table(r, names[0], columns[0], FP3_HDF5_UINT32, (void **)words, rows, error);
    *numbers = NULL;
    if (!status)
        status =
            read_table(r, names[1], columns[1], FP3_HDF5_DOUBLE, (void **)numbers, &others, error);
    return status || others == *rows ? status : unfit(r, names[1], others, error);
}

static fp3_status take_shapes(fp3_view_recording *r, const uint32_t *words, const double *radii,
                              size_t rows, size_t corners, fp3_error *error) {
    size_t first = 0;
    if (rows && !(r->shapes = calloc(rows, sizeof *r->shapes)))
        return fp3_no_memory(error);
    for (size_t i = 0; i < rows; i++, words += 4) {
        r->shapes[i] = (fp3_view_shape){.object = words[0],
                                        .corners = words[1],
                                        .is_sensor = words[2],
                                        .type = words[3],
                                        .radius = radii[i],
                                        .first = first};
        if (words[0] >= r->objects || !words[1] || words[1] > corners - first || !(radii[i] >= 0) ||
            (isinf(radii[i]) && words[1] != 2))
            return unfit(r, "shapes:of", i, error);
        first += words[1];
    }
    r->shape_count = rows;
    return first == corners ? FP3_OK : unfit(r, "shapes:corners", first, error);
}

/* Each has its corners in one shape, and shapes follow each other. */
static fp3_status take_triangles(fp3_view_recording *r, const uint32_t (*rows)[3],
                                 fp3_error *error) {
    size_t i = 0;
    if (!(r->triangles = malloc((r->triangle_count + 1) * sizeof *r->triangles)))
        return fp3_no_memory(error);
    for (size_t k = 0; k < r->shape_count; k++) {
        fp3_view_shape *s = &r->shapes[k];
        s->triangle = i;
        for (; i < r->triangle_count && rows[i][0] - s->first < s->corners; i++) {
            r->triangles[i] = (fp3_view_triangle){{rows[i][0], rows[i][1], rows[i][2]}, 0};
            if (rows[i][1] - s->first >= s->corners || rows[i][2] - s->first >= s->corners)
                return unfit(r, "shapes:triangles", i, error);
        }
        s->triangles = i - s->triangle;
    }
    return i == r->triangle_count ? FP3_OK : unfit(r, "shapes:triangles", i, error);
}

static fp3_status read_triangles(fp3_view_recording *r, fp3_error *error) {
    uint32_t *rows = NULL;
    fp3_status status = read_table(r, "shapes:triangles", 3, FP3_HDF5_UINT32, (void **)&rows,
                                   &r->triangle_count, error);
    if (!status)
        status = take_triangles(r, (const uint32_t(*)[3])rows, error);
    free(rows);
    return status ? status : fp3_view_edges_find(r, error);
}

static fp3_status read_shapes(fp3_view_recording *r, fp3_error *error) {
    uint32_t *words = NULL;
    double *radii = NULL;
    size_t rows = 0, corners = 0;
    fp3_status status = read_two(r, (const char *const[]){"shapes:of", "shapes:radius"},
                                 (const uint64_t[]){4, 1}, &words, &radii, &rows, error);
    if (!status)
        status = read_table(r, "shapes:corners", 3, FP3_HDF5_DOUBLE, (void **)&r->corners, &corners,
                            error);
    for (size_t i = 0; !status && i < 3 * corners; i++)
        if (!isfinite(r->corners[i / 3][i % 3]))
            status = unfit(r, "shapes:corners", i / 3, error);
    if (!status)
        status = take_shapes(r, words, radii, rows, corners, error);
    if (!status)
        status = read_triangles(r, error);
    free(words);
    free(radii);
    return status;
}

static fp3_status read_joints(fp3_view_recording *r, fp3_error *error) {
    uint32_t *words = NULL;
    double *anchors = NULL;
    fp3_status status =
        read_two(r, (const char *const[]){"joints:of", "joints:anchors"}, (const uint64_t[]){4, 6},
                 &words, &anchors, &r->joint_count, error);
    if (!status && r->joint_count && !(r->joints = calloc(r->joint_count, sizeof *r->joints)))
        status = fp3_no_memory(error);
    for (size_t i = 0; !status && i < r->joint_count; i++) {
        const uint32_t *w = words + 4 * i;
        r->joints[i] = (fp3_view_joint){.a = w[0], .b = w[1], .type = w[2], .snapshots = w[3]};
        memcpy(r->joints[i].anchor, anchors + 6 * i, sizeof r->joints[i].anchor);
        if (w[0] >= r->objects || w[1] >= r->objects)
            status = unfit(r, "joints:of", i, error);
    }
    free(words);
    free(anchors);
    return status;
}

/* Of every N-th snapshot. */
static fp3_status load_contacts(fp3_view_recording *r, uint64_t every, fp3_error *error) {
    uint32_t *words = NULL;
    double *points = NULL;
    size_t rows = 0;
    fp3_status status = read_two(r, (const char *const[]){"contacts:of", "contacts:points"},
                                 (const uint64_t[]){3, 7}, &words, &points, &rows, error);
    if (!status && rows && !(r->contacts = calloc(rows, sizeof *r->contacts)))
        status = fp3_no_memory(error);
    for (size_t i = 0; !status && i < rows; i++) {
        const double *p = points + 7 * i;
        r->force_most = p[6] > r->force_most ? p[6] : r->force_most;
        if (words[3 * i] % every == 0)
            r->contacts[r->contact_count++] = (fp3_view_contact){
                words[3 * i] / every, {p[0], p[1], p[2]}, {p[3], p[4], p[5]}, p[6]};
    }
    free(words);
    free(points);
    return status;
}

static void read_texts(fp3_view_recording *r) {
    const hdf5 *self = (const hdf5 *)r->reader;
    r->model = self->calls->text_of(self->file, -1, "model");
    r->doc = self->calls->text_of(self->file, -1, "description");
    r->integrator = self->calls->text_of(self->file, -1, "integrator");
    r->engine = self->calls->text_of(self->file, -1, "engine");
    r->configuration = self->calls->text_of(self->file, -1, "configuration");
    if (self->time >= 0)
        r->time_unit = self->calls->text_of(self->file, self->time, "units");
}

typedef struct {
    fp3_view_recording *r;
    fp3_error *error;
    fp3_status status;
} near_search;

static void note_near(void *user, const char *attribute, double value) {
    near_search *search = user;
    const char *name = behind(attribute, "reach");
    if (name && value > 0 && !search->status)
        search->status = add_near(search->r, name, value, search->error);
}

static fp3_status look(fp3_view_recording *r, fp3_error *error) {
    hdf5 *self = (hdf5 *)r->reader;
    near_search search = {r, error, FP3_OK};
    const int count = self->calls->count(self->file);
    fp3_status status = count < 0 ? failed(r, error) : FP3_OK;
    for (int i = 0; !status && i < count; i++)
        status = note(r, i, error);
    if (!status)
        status = check_rows(r, error);
    for (size_t i = 0; !status && i < r->relation_count; i++)
        status = check_pairs(r, &r->relations[i], error);
    if (!status)
        status = read_shapes(r, error);
    if (!status)
        status = read_joints(r, error);
    if (!status && self->calls->numbers(self->file, note_near, &search))
        status = failed(r, error);
    read_texts(r);
    r->has_time = self->time >= 0;
    return status ? status : search.status;
}

/* ---- values ---- */

static fp3_status refuse_wide(const fp3_view_recording *r, const fp3_view_column *column,
                              fp3_error *error) {
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "%s: '%s' has numbers beyond the range of FP32: leave it out with --observe",
                    r->path, column->name);
}

/* `rows` snapshots from `row` on: floats as they are, others by double. */
static fp3_status read_rows(const fp3_view_recording *r, const fp3_view_column *column,
                            uint64_t row, uint64_t rows, float *to, fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    const fp3_hdf5_part part = {.row = row, .rows = rows, .columns = r->objects};
    const size_t count = rows * r->objects;
    int is_good = 1;
    double *wide = malloc(count * sizeof *wide);
    if (!wide)
        return fp3_no_memory(error);
    const int result = self->calls->read(self->file, column->source, FP3_HDF5_DOUBLE, &part, wide);
    for (size_t i = 0; !result && i < count; i++)
        is_good &= fp3_view_narrow(wide[i], &to[i]);
    free(wide);
    return result ? failed(r, error) : is_good ? FP3_OK : refuse_wide(r, column, error);
}

static fp3_status load_column(const fp3_view_recording *r, fp3_view_column *column, uint64_t every,
                              fp3_error *error) {
    const uint64_t most = every > 1 || r->objects > BLOCK_VALUES ? 1 : BLOCK_VALUES / r->objects;
    fp3_status status = FP3_OK;
    column->values = malloc(r->snapshots * r->objects * sizeof *column->values);
    if (!column->values)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", r->path);
    for (uint64_t n = 0; !status && n < r->snapshots;) {
        const uint64_t rows = r->snapshots - n < most ? r->snapshots - n : most;
        status = read_rows(r, column, n * every, rows, column->values + n * r->objects, error);
        n += rows;
    }
    return status;
}

/* Every N-th of a list of all snapshots, in its own place. */
static void thin(void *list, size_t size, uint64_t count, uint64_t every) {
    char *bytes = list;
    for (uint64_t i = 0; i < count && every > 1; i++)
        memcpy(bytes + i * size, bytes + i * every * size, size);
}

static fp3_status load_times(fp3_view_recording *r, uint64_t every, fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    const fp3_hdf5_part part = {.rows = self->rows};
    r->steps = malloc(self->rows * sizeof *r->steps);
    r->times = r->has_time ? malloc(self->rows * sizeof *r->times) : NULL;
    if (!r->steps || (r->has_time && !r->times))
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", r->path);
    if (self->calls->read(self->file, self->step, FP3_HDF5_UINT64, &part, r->steps) ||
        (r->has_time &&
         self->calls->read(self->file, self->time, FP3_HDF5_DOUBLE, &part, r->times)))
        return failed(r, error);
    thin(r->steps, sizeof *r->steps, r->snapshots, every);
    if (r->times)
        thin(r->times, sizeof *r->times, r->snapshots, every);
    return FP3_OK;
}

static fp3_status hdf5_load(fp3_view_recording *r, uint64_t every, fp3_error *error) {
    const hdf5 *self = (const hdf5 *)r->reader;
    r->snapshots = self->rows / every + (self->rows % every != 0);
    if (!r->snapshots || !r->objects)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: the recording has no snapshot", r->path);
    fp3_status status = fp3_view_check_size(r, r->snapshots, r->objects, error);
    if (!status)
        status = load_times(r, every, error);
    if (!status)
        status = load_contacts(r, every, error);
    for (size_t i = 0; i < r->joint_count; i++) /* in so many of those that are loaded */
        r->joints[i].snapshots = (uint32_t)((r->joints[i].snapshots + every - 1) / every);
    for (size_t i = 0; !status && i < r->column_count; i++)
        if (r->columns[i].is_wanted && !r->columns[i].is_made)
            status = load_column(r, &r->columns[i], every, error);
    return status;
}

/* ---- opening ---- */

/* HDF5 itself says too little of a file that is not there. */
static fp3_status check_there(const char *path, fp3_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return fp3_path_fail(error, path, "cannot open");
    fclose(file);
    return FP3_OK;
}

fp3_status fp3_view_hdf5_open(fp3_view_recording *r, fp3_error *error) {
    hdf5 *self = calloc(1, sizeof *self);
    if (!self)
        return fp3_no_memory(error);
    self->reader = (fp3_view_reader){hdf5_load, hdf5_close};
    self->step = self->time = -1;
    r->reader = &self->reader;
    fp3_status status = check_there(r->path, error);
    if (!status)
        status = fp3_library_hdf5(&self->calls, error);
    if (!status && !(self->file = self->calls->open(r->path)))
        status = fp3_no_memory(error);
    return status ? status : look(r, error);
}
