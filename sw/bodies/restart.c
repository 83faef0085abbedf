/* SPDX-License-Identifier: Apache-2.0 */
/* restart.c - opens a world of bodies from a checkpoint. Nothing of the file is believed: whatever
 * the rest of this room takes for granted, such as numbers of bodies, is checked. */
#include "fields.h"

#include "base/definition.h"
#include "base/host.h"
#include "record/envelope.h"
#include "record/library_hdf5.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct {
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    const char *path;
    uint64_t step, bytes; /* of the envelope; of the file */
    fp3_error *error;
} reader;

static fp3_status foreign(const reader *r, const char *name) {
    return fp3_fail(r->error, FP3_E_ARGUMENT,
                    "%s: no checkpoint of bodies of this version: '%s' is not as expected", r->path,
                    name);
}

/* ---- tables ---- */

/* Its number; -1: there is none. */
static int find(const reader *r, const char *name, fp3_hdf5_table *table) {
    for (int i = 0; i < r->calls->count(r->file); i++)
        if (!r->calls->describe(r->file, i, table) && !strcmp(table->name, name))
            return i;
    return -1;
}

static int is_finite(const fp3_kept_field *field, const char *column, uint32_t rows) {
    const size_t count = (size_t)rows * field->count;
    int is = 1;
    for (size_t i = 0; i < count; i++) {
        float narrow = 0;
        double wide = 0;
        if (field->type == FP3_HDF5_FLOAT)
            memcpy(&narrow, column + i * sizeof narrow, sizeof narrow);
        else if (field->type == FP3_HDF5_DOUBLE)
            memcpy(&wide, column + i * sizeof wide, sizeof wide);
        is &= isfinite(narrow) && isfinite(wide);
    }
    return is;
}

static void scatter(const fp3_kept_field *field, const char *column, uint32_t rows, char *elements,
                    size_t size) {
    const size_t bytes = fp3_field_size(field);
    for (uint32_t i = 0; i < rows; i++) {
        char *to = elements + i * size + field->at;
        if (field->is_byte) {
            uint32_t word;
            memcpy(&word, column + i * bytes, sizeof word);
            *to = (char)(word > UINT8_MAX ? UINT8_MAX : word);
        } else {
            memcpy(to, column + i * bytes, bytes);
        }
    }
}

static fp3_status take_field(const reader *r, const fp3_kept_fields *of,
                             const fp3_kept_field *field, void *elements, size_t size,
                             uint32_t rows) {
    char name[FP3_FIELD_NAME];
    fp3_hdf5_table table;
    fp3_field_name(name, of, field);
    const int dataset = find(r, name, &table);
    if (dataset < 0 || table.rows != rows || table.columns != field->count ||
        table.type != field->type)
        return foreign(r, name);
    char *column = malloc((size_t)rows * fp3_field_size(field));
    const fp3_hdf5_part part = {.rows = rows, .columns = field->count};
    fp3_status status = column ? FP3_OK : fp3_no_memory(r->error);
    if (!status && r->calls->read(r->file, dataset, field->type, &part, column))
        status = fp3_hdf5_cannot_read(r->calls, r->file, r->path, r->error);
    if (!status && !field->is_any && !is_finite(field, column, rows))
        status = foreign(r, name);
    if (!status)
        scatter(field, column, rows, elements, size);
    free(column);
    return status;
}

static fp3_status take(const reader *r, const fp3_kept_fields *of, void *elements, size_t size,
                       uint32_t rows) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && rows && i < of->count; i++)
        status = take_field(r, of, &of->fields[i], elements, size, rows);
    return status;
}

/* How many elements the file has: as many as the first field, and no more than it has bytes. */
static fp3_status count(const reader *r, const fp3_kept_fields *of, uint32_t *rows) {
    char name[FP3_FIELD_NAME];
    fp3_hdf5_table table;
    size_t each = 0;
    fp3_field_name(name, of, &of->fields[0]);
    *rows = 0;
    if (find(r, name, &table) < 0)
        return FP3_OK;
    for (size_t i = 0; i < of->count; i++)
        each += fp3_field_size(&of->fields[i]);
    if (table.rows > r->bytes / each || table.rows >= FP3_NOBODY)
        return foreign(r, name);
    *rows = (uint32_t)table.rows;
    return FP3_OK;
}

static fp3_status take_part(const reader *r, fp3_bodies *bodies, int which) {
    const fp3_kept_part part = fp3_part_of(bodies, which);
    uint32_t rows;
    fp3_status status = count(r, &fp3_fields_of[which], &rows);
    if (!status)
        status = fp3_bodies_room(part.array, part.room, part.size, rows + (size_t)1, r->error);
    if (!status) {
        memset(*part.array, 0, rows * part.size);
        status = take(r, &fp3_fields_of[which], *part.array, part.size, rows);
    }
    if (!status && which != FP3_PART_BOXES && which != FP3_PART_FILTERS)
        *part.count = rows;
    if (!status && *part.count != rows)
        status = foreign(r, fp3_fields_of[which].name);
    return status;
}

/* ---- what has to be so ---- */

static int are_links(const fp3_bodies *b, const uint32_t *seen) {
    for (uint32_t i = 0; i < b->shape_count; i++)
        if (seen[i] != (b->shape[i].generation & 1))
            return 0;
    return 1;
}

/* Each shape that is there is in the chain of its body, once; ends of rings are there. */
static int are_bodies(const fp3_bodies *b, uint32_t *seen) {
    for (uint32_t i = 0; i < b->body_count; i++) {
        const fp3_body *body = &b->body[i];
        if (!fp3_body_lives(body))
            continue;
        if (body->type > FP3_STATIC || (body->rest < 0 && body->next_asleep >= b->body_count))
            return 0;
        for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = b->shape[s].next)
            if (s >= b->shape_count || b->shape[s].body != i || seen[s]++)
                return 0;
    }
    return are_links(b, seen);
}

static int is_core(const fp3_shape2 *s) {
    return s->core.count >= 1 && s->core.count <= FP3_CORNERS2;
}

static int are_shapes(const fp3_bodies *b) {
    for (uint32_t i = 0; i < b->shape_count; i++) {
        const fp3_attached *s = &b->shape[i];
        if (s->generation & 1 &&
            (!is_core(&s->given) || !is_core(&s->shape) || s->body >= b->body_count))
            return 0;
    }
    return 1;
}

static int are_touches(const fp3_bodies *b) {
    for (uint32_t k = 0; k < b->touch_count; k++) {
        const fp3_touch2 *t = &b->touch[k], *last = k ? t - 1 : NULL;
        if (t->a >= t->b || t->b >= b->shape_count || t->m.count > 2 || t->found.count > 2 ||
            t->points > 2 || t->body_a != b->shape[t->a].body || t->body_b != b->shape[t->b].body ||
            !(b->shape[t->a].generation & b->shape[t->b].generation & 1) ||
            (last && (last->a > t->a || (last->a == t->a && last->b >= t->b))))
            return 0;
    }
    return 1;
}

static int are_joints(const fp3_bodies *b) {
    for (uint32_t i = 0; i < b->joint_count; i++) {
        const fp3_joint *j = &b->joint[i];
        if (j->generation & 1 &&
            (j->a >= b->body_count || j->b >= b->body_count || j->a == j->b ||
             !fp3_body_lives(&b->body[j->a]) || !fp3_body_lives(&b->body[j->b]) ||
             (unsigned)j->def.type > FP3_GEAR || j->laws >> FP3_JOINT_LAWS))
            return 0;
    }
    return 1;
}

static void count_living(fp3_bodies *b) {
    for (uint32_t i = 0; i < b->body_count; i++) {
        b->living += (uint32_t)fp3_body_lives(&b->body[i]);
        b->body[i].slot = FP3_NOBODY;
    }
    for (uint32_t i = 0; i < b->joint_count; i++)
        b->joints += b->joint[i].generation & 1;
}

static fp3_status check(const reader *r, fp3_bodies *b) {
    char hash[FP3_KEPT_HASH];
    uint32_t *seen = calloc(b->shape_count + (size_t)1, sizeof *seen);
    if (!seen)
        return fp3_no_memory(r->error);
    const char *wrong = !are_shapes(b)         ? "shapes"
                        : !are_bodies(b, seen) ? "bodies"
                        : !are_touches(b)      ? "touches"
                        : !are_joints(b)       ? "joints"
                        : b->steps != r->step || b->free_body > b->body_count ||
                                b->free_shape > b->shape_count || b->free_joint > b->joint_count
                            ? "world"
                            : NULL;
    free(seen);
    if (wrong)
        return foreign(r, wrong);
    count_living(b);
    b->time = (double)b->steps * b->def.h;
    fp3_kept_hash(b, hash);
    char *told = r->calls->text_of(r->file, -1, "hash");
    const int is_same = told && !strcmp(told, hash);
    free(told);
    return is_same ? FP3_OK
                   : fp3_fail(r->error, FP3_E_ARGUMENT,
                              "%s: damaged: the bodies do not have the hash in the file", r->path);
}

/* ---- the file ---- */

/* What the file is of. */
static fp3_status look(const reader *r) {
    char *form = r->calls->text_of(r->file, -1, FP3_KEPT_WHAT);
    fp3_status status = FP3_OK;
    if (!form)
        status =
            fp3_fail(r->error, FP3_E_ARGUMENT,
                     "%s: a checkpoint, but not one of bodies: fp3 run goes on with it", r->path);
    else if (strcmp(form, FP3_KEPT_FORM))
        status = fp3_fail(r->error, FP3_E_ARGUMENT,
                          "%s: bodies of form %.20s, and this library reads form " FP3_KEPT_FORM,
                          r->path, form);
    free(form);
    return status;
}

static fp3_status compare_laws(const reader *r, const fp3_laws *laws) {
    char wanted[FP3_DIGEST_SIZE], *told = r->calls->text_of(r->file, -1, "laws");
    fp3_status status = fp3_kept_laws(r->calls, laws, wanted, r->error);
    if (!status && (!told || strcmp(told, wanted)))
        status = fp3_fail(r->error, FP3_E_ARGUMENT,
                          "%s: its laws of contacts and joints are others than those of this world",
                          r->path);
    free(told);
    return status;
}

/* The values of the world, as the caller gives them. */
static fp3_status open_world(const reader *r, const fp3_bodies_def *def, fp3_bodies **made) {
    fp3_bodies from = {.steps = 0};
    fp3_bodies_def own = *def;
    fp3_status status = take(r, &fp3_fields_of_world, &from, sizeof from, 1);
    if (!status && from.def.dimensions != 2)
        status = foreign(r, "world.def.dimensions");
    if (status)
        return status;
    memcpy(own.gravity, from.def.gravity, sizeof own.gravity);
    own.dimensions = 2;
    own.h = from.def.h;
    own.substeps = from.def.substeps;
    own.size = from.def.size;
    own.rest_time = from.def.rest_time;
    status = fp3_bodies_open(&own, made);
    /* The others have been multiplied by `size` already. */
    return status ? status : take(r, &fp3_fields_of_world, *made, sizeof **made, 1);
}

static fp3_status open_file(reader *r) {
    struct stat found;
    fp3_status status = fp3_library_hdf5(&r->calls, r->error);
    if (!status)
        status = fp3_envelope_open(r->calls, r->path, &r->step, r->error);
    if (!status && !(r->file = r->calls->open(r->path)))
        status = fp3_no_memory(r->error);
    r->bytes = !status && !stat(r->path, &found) ? (uint64_t)found.st_size : 0;
    return status;
}

static int are_speeds(const fp3_bodies_def *def) {
    return def->push >= 0 && def->bounce >= 0 && def->rest_speed >= 0;
}

static fp3_status read_all(reader *r, const fp3_bodies_def *def, fp3_bodies **made) {
    fp3_status status = open_file(r);
    if (!status)
        status = look(r);
    if (!status)
        status = open_world(r, def, made);
    if (!status)
        status = compare_laws(r, (*made)->laws);
    for (int i = 0; !status && i < FP3_PARTS; i++)
        status = take_part(r, *made, i);
    if (!status && !are_speeds(&(*made)->def))
        status = foreign(r, "world");
    if (status)
        return status;
    (*made)->boxes.count = (*made)->shape_count;
    (*made)->is_apart_stale = 1;
    return check(r, *made);
}

fp3_status fp3_bodies_restart(const fp3_bodies_def *def, const char *path, fp3_bodies **bodies) {
    FP3_HOST;
    reader r = {.path = path, .error = def->error};
    *bodies = NULL;
    fp3_status status = fp3_definition_check(def, sizeof *def, "fp3_bodies_def",
                                             fp3_definition_error(def, def->error));
    if (!status)
        status = read_all(&r, def, bodies);
    if (r.file)
        r.calls->close(r.file);
    if (status)
        fp3_bodies_close(bodies);
    return status;
}
