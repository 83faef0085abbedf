/* SPDX-License-Identifier: Apache-2.0 */
/* restart.c - opens a world of bodies from a checkpoint. Nothing of the file is believed: whatever
 * the rest of this room takes for granted, such as numbers of bodies, is checked. */
#include "fields.h"
#include "past.h"

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

static fp3_status take_field(const reader *r, const fp3_kept_list *of, const fp3_kept_field *field,
                             void *elements, size_t size, uint32_t rows) {
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
        fp3_field_scatter(field, column, rows, elements, size);
    free(column);
    return status;
}

static fp3_status take(const reader *r, const fp3_kept_list *of, void *elements, size_t size,
                       uint32_t rows) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && rows && i < of->count; i++)
        status = take_field(r, of, &of->fields[i], elements, size, rows);
    return status;
}

/* How many elements the file has: as many as the first field, and no more than it has bytes. */
static fp3_status count(const reader *r, const fp3_kept_list *of, uint32_t *rows) {
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

/* A list beside another one has as many rows as that one, and may be of the same elements. */
static fp3_status take_list(const reader *r, fp3_bodies *bodies, const fp3_kept_list *list) {
    const fp3_kept_part part = fp3_kept_elements(bodies, list);
    uint32_t rows = *part.count;
    fp3_status status = list->is_beside ? FP3_OK : count(r, list, &rows);
    if (!status)
        status = fp3_bodies_room(part.array, part.room, part.size, rows + (size_t)1, r->error);
    if (!status)
        status = take(r, list, *part.array, part.size, rows);
    if (!status)
        *part.count = rows;
    return status;
}

/* The world's own are there already. */
static fp3_status take_lists(const reader *r, fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (size_t i = 1; !status && i < fp3_kept_list_count; i++)
        if (fp3_list_is_of(&fp3_kept_lists[i], bodies->def.dimensions))
            status = take_list(r, bodies, &fp3_kept_lists[i]);
    return status;
}

/* ---- what has to be so ---- */

/* Each sleeper is behind one other, so rings close. */
static int are_rings(const fp3_bodies *b, uint32_t *seen) {
    for (uint32_t i = 0; i < b->body_count; i++) {
        const fp3_body *body = &b->body[i];
        const uint32_t next = body->next_asleep;
        if (!fp3_body_lives(body) || !(body->rest < 0))
            continue;
        if (next >= b->body_count || !fp3_body_lives(&b->body[next]) || !(b->body[next].rest < 0) ||
            seen[next]++)
            return 0;
    }
    return 1;
}

static int are_links(const fp3_bodies *b, const uint32_t *seen) {
    for (uint32_t i = 0; i < b->shape_count; i++)
        if (seen[i] != (b->shape[i].generation & 1))
            return 0;
    return 1;
}

/* Each shape that is there is in the chain of its body, once. */
static int are_bodies(const fp3_bodies *b, uint32_t *seen) {
    for (uint32_t i = 0; i < b->body_count; i++) {
        const fp3_body *body = &b->body[i];
        if (!fp3_body_lives(body))
            continue;
        if (body->type > FP3_STATIC)
            return 0;
        for (uint32_t s = body->first_shape; s != FP3_NOBODY; s = b->shape[s].next)
            if (s >= b->shape_count || b->shape[s].body != i || seen[s]++)
                return 0;
    }
    return are_links(b, seen);
}

static int is_turn(const double q[4]) {
    const double square = (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
    return fabs(square - 1) < 1e-6;
}

static int are_turns(const fp3_bodies *b) {
    for (uint32_t i = 0; i < b->body_count; i++)
        if (fp3_body_lives(&b->body[i]) && b->space &&
            (!is_turn(b->space->body[i].q) || !is_turn(b->space->body[i].axes)))
            return 0;
    return 1;
}

static int is_core(const fp3_shape2 *s) {
    return s->core.count >= 1 && s->core.count <= FP3_CORNERS2;
}

static int are_shapes(const fp3_bodies *b) {
    for (uint32_t i = 0; i < b->shape_count; i++) {
        const fp3_attached *s = &b->shape[i];
        if (s->generation & 1 && (s->body >= b->body_count ||
                                  (!b->space && (!is_core(&s->given) || !is_core(&s->shape)))))
            return 0;
    }
    return 1;
}

static int is_touch(const fp3_bodies *b, const fp3_touch2 *t) {
    return t->a < t->b && t->b < b->shape_count && t->m.count <= 2 && t->found.count <= 2 &&
           t->points <= 2 && t->body_a == b->shape[t->a].body && t->body_b == b->shape[t->b].body &&
           b->shape[t->a].generation & b->shape[t->b].generation & 1;
}

/* Ascending. */
static int are_touches(const fp3_bodies *b) {
    for (uint32_t k = 0; k < b->touch_count; k++) {
        const fp3_touch2 *t = &b->touch[k], *last = k ? t - 1 : NULL;
        if (!is_touch(b, t) || (last && (last->a > t->a || (last->a == t->a && last->b >= t->b))))
            return 0;
    }
    return 1;
}

/* They stand in the order of touches, one at least for each (fp3_space_lay_patches). */
static int are_patches(fp3_bodies *b) {
    uint64_t next = 0;
    for (uint32_t k = 0; b->space && k < b->touch_count; k++) {
        fp3_touch2 *t = &b->touch[k];
        t->patch_room = t->patches ? t->patches : 1;
        if (t->first_patch != next || next + t->patch_room > b->space->patch_count)
            return 0;
        for (uint32_t i = 0; i < t->patches; i++) {
            const fp3_patch3 *p = &b->space->patch[next + i];
            if (p->a != t->a || p->b != t->b || p->m.count > 4)
                return 0;
        }
        next += t->patch_room;
    }
    return !b->space || next == b->space->patch_count;
}

static int has_direction(const double v[3]) {
    return (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2] > 1e-12;
}

static int is_joint(const fp3_bodies *b, const fp3_joint *j) {
    const unsigned type = j->def.type;
    if (!has_direction(j->def.axis) || !has_direction(j->def.axle))
        return 0;
    return j->a < b->body_count && j->b < b->body_count && j->a != j->b &&
           fp3_body_lives(&b->body[j->a]) && fp3_body_lives(&b->body[j->b]) &&
           j->def.a == fp3_bodies_handle(b, j->a) && j->def.b == fp3_bodies_handle(b, j->b) &&
           type <= FP3_BALL && type != (b->space ? FP3_GEAR : FP3_BALL) &&
           !(j->laws >> (b->space ? FP3_JOINT_LAWS3 : FP3_JOINT_LAWS));
}

static int are_joints(const fp3_bodies *b) {
    for (uint32_t i = 0; i < b->joint_count; i++)
        if (b->joint[i].generation & 1 && !is_joint(b, &b->joint[i]))
            return 0;
    return 1;
}

static int is_world(const reader *r, const fp3_bodies *b) {
    const fp3_bodies_def *def = &b->def;
    return def->push >= 0 && def->bounce >= 0 && def->rest_speed >= 0 && b->steps == r->step &&
           b->free_body <= b->body_count && b->free_shape <= b->shape_count &&
           b->free_joint <= b->joint_count && b->told <= b->change_count[FP3_CONTACT_ENDED];
}

static fp3_status check(const reader *r, fp3_bodies *b) {
    char hash[FP3_KEPT_HASH];
    uint32_t *seen = calloc(b->shape_count + (size_t)1, sizeof *seen);
    uint32_t *behind = calloc(b->body_count + (size_t)1, sizeof *behind);
    const char *wrong = NULL;
    if (seen && behind)
        wrong = !are_shapes(b)                                                   ? "shapes"
                : !are_bodies(b, seen) || !are_rings(b, behind) || !are_turns(b) ? "bodies"
                : !are_touches(b)                                                ? "touches"
                : !are_patches(b)                                                ? "patches"
                : !are_joints(b)                                                 ? "joints"
                : !is_world(r, b)                                                ? "world"
                                                                                 : NULL;
    const int is_made = seen && behind;
    free(seen);
    free(behind);
    if (!is_made)
        return fp3_no_memory(r->error);
    if (wrong)
        return foreign(r, wrong);
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

static fp3_status compare_laws(const reader *r, const fp3_bodies *bodies) {
    char wanted[FP3_DIGEST_SIZE], *told = r->calls->text_of(r->file, -1, "laws");
    fp3_status status = fp3_kept_laws(r->calls, bodies, wanted, r->error);
    if (!status && (!told || strcmp(told, wanted)))
        status = fp3_fail(r->error, FP3_E_ARGUMENT,
                          "%s: its laws of contacts and joints are others than those of this world",
                          r->path);
    free(told);
    return status;
}

/* The values of the world, as the caller gives them. */
static fp3_status open_world(const reader *r, const fp3_bodies_def *def, fp3_bodies **made) {
    const fp3_kept_list *list = &fp3_kept_lists[0];
    fp3_bodies from = {.steps = 0};
    fp3_bodies_def own = *def;
    fp3_status status = take(r, list, &from, sizeof from, 1);
    if (status)
        return status;
    memcpy(own.gravity, from.def.gravity, sizeof own.gravity);
    own.dimensions = from.def.dimensions;
    own.h = from.def.h;
    own.substeps = from.def.substeps;
    own.size = from.def.size;
    own.rest_time = from.def.rest_time;
    fp3_error why = {.text = ""};
    own.error = &why;
    status = fp3_bodies_open(&own, made);
    if (status)
        return fp3_fail(r->error, status, "%s: %s", r->path, why.text);
    (*made)->def.error = (*made)->error = def->error;
    /* The others have been multiplied by `size` already. */
    return take(r, list, *made, sizeof **made, 1);
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

static fp3_status make_forms(const reader *r, fp3_bodies *bodies) {
    fp3_error why = {.text = ""};
    if (!bodies->space)
        return FP3_OK;
    const fp3_status status = fp3_forms_make(bodies, &why);
    fp3_forms_forget(bodies);
    return status ? fp3_fail(r->error, status, "%s: %s", r->path, why.text) : FP3_OK;
}

static fp3_status read_all(reader *r, const fp3_bodies_def *def, fp3_bodies **made) {
    fp3_status status = open_file(r);
    if (!status)
        status = look(r);
    if (!status)
        status = open_world(r, def, made);
    if (!status)
        status = compare_laws(r, *made);
    if (!status)
        status = take_lists(r, *made);
    if (!status)
        status = make_forms(r, *made);
    if (status)
        return status;
    fp3_bodies_count_up(*made);
    return check(r, *made);
}

/* ---- of a run ---- */

/* Number i of a field of the world's definition. */
static double number_of(const fp3_kept_field *field, const fp3_bodies *of, uint32_t i) {
    const char *at = (const char *)of + field->at;
    double number;
    uint32_t word;
    if (field->type == FP3_HDF5_DOUBLE) {
        memcpy(&number, at + i * sizeof number, sizeof number);
        return number;
    }
    memcpy(&word, at + i * sizeof word, sizeof word);
    return word;
}

static fp3_status compare_values(const reader *r, const fp3_kept_field *field, const fp3_bodies *of,
                                 const fp3_bodies *made) {
    static const char def[] = "def.";
    for (uint32_t i = 0; i < field->count && !strncmp(field->name, def, strlen(def)); i++)
        if (number_of(field, made, i) != number_of(field, of, i))
            return fp3_fail(r->error, FP3_E_ARGUMENT,
                            "%s: of another run: its %s is %.9g, and that of the scene is %.9g",
                            r->path, field->name + strlen(def), number_of(field, made, i),
                            number_of(field, of, i));
    return FP3_OK;
}

static int read_digest(const reader *r, const char *name, fp3_digest *digest) {
    char *text = r->calls->text_of(r->file, -1, name);
    const int is_good = fp3_digest_read(text, digest);
    free(text);
    return is_good;
}

static fp3_status compare_start(const reader *r, const fp3_bodies *of, fp3_bodies_past *past,
                                const fp3_bodies *made) {
    const fp3_kept_list *list = &fp3_kept_lists[0];
    fp3_digest start;
    fp3_status status = FP3_OK;
    if (!read_digest(r, "before", &past->before) || !read_digest(r, "chain", &past->chain))
        return fp3_fail(r->error, FP3_E_ARGUMENT,
                        "%s: a world that a program has written, and no run of a scene: "
                        "fp3_bodies_restart opens it",
                        r->path);
    for (size_t i = 0; !status && i < list->count; i++)
        status = compare_values(r, &list->fields[i], of, made);
    for (int i = 0; !status && i < FP3_STARTS; i++)
        if (!read_digest(r, fp3_start_names[i], &start) ||
            !fp3_digest_same(&start, &past->start[i]))
            status = fp3_fail(r->error, FP3_E_ARGUMENT,
                              "%s: of another run: the scene makes other %s now", r->path,
                              strchr(fp3_start_names[i], ':') + 1);
    return status;
}

fp3_status fp3_bodies_go_on(const fp3_bodies_def *def, const char *path, const fp3_bodies *of,
                            fp3_bodies_past *past, fp3_bodies **bodies) {
    FP3_HOST;
    reader r = {.path = path, .error = def->error};
    *bodies = NULL;
    fp3_status status = fp3_definition_check(def, sizeof *def, "fp3_bodies_def",
                                             fp3_definition_error(def, def->error));
    if (!status)
        status = read_all(&r, def, bodies);
    if (!status && past)
        status = compare_start(&r, of, past, *bodies);
    if (r.file)
        r.calls->close(r.file);
    if (status)
        fp3_bodies_close(bodies);
    return status;
}

fp3_status fp3_bodies_restart(const fp3_bodies_def *def, const char *path, fp3_bodies **bodies) {
    return fp3_bodies_go_on(def, path, NULL, NULL, bodies);
}
