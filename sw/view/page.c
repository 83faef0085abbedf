/* SPDX-License-Identifier: Apache-2.0 */
/* page.c - see page.h. What comes from files is in one JSON text without '<', so that nothing in it
 * can end the element that it is in; the page shows it as text alone.
 */
#include "page.h"

#include "outline.h"
#include "text.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK_VALUES (1u << 20) /* of a column, in a piece that is unpacked at once */
#define DIGITS 17

/* ---- what it is about ---- */

/* A text that is no UTF-8 would be no JSON. */
static json_t *text(const char *from) {
    json_t *made = json_string(from);
    return made ? made : json_string("(no UTF-8)");
}

/* The column's number in the page, where only what is shown has one. */
static json_int_t shown(const fp3_view_recording *r, size_t column) {
    json_int_t number = 0;
    for (size_t i = 0; i < column; i++)
        number += r->columns[i].values != NULL;
    return number;
}

static json_t *shown_list(const fp3_view_recording *r, const size_t *columns, unsigned count) {
    json_t *list = json_array();
    for (unsigned k = 0; k < count; k++)
        json_array_append_new(list, json_integer(shown(r, columns[k])));
    return list;
}

static json_t *columns_of(const fp3_view_recording *r, const fp3_view_scale *scales) {
    json_t *list = json_array();
    for (size_t i = 0; i < r->column_count; i++) {
        const fp3_view_column *c = &r->columns[i];
        const fp3_view_scale *s = &scales[i];
        if (c->values)
            json_array_append_new(
                list, json_pack("{so so so sb sf sf sf sb sf sf}", "name", text(c->name), "unit",
                                text(c->unit), "doc", text(c->doc), "isFloat", s->is_float, "low",
                                s->low, "step", s->step, "bound", s->bound, "hasHoles",
                                s->has_holes, "least", s->least, "most", s->most));
    }
    return list;
}

static json_t *fields_of(const fp3_view_page *page) {
    json_t *list = json_array();
    for (size_t i = 0; i < page->fields->count; i++) {
        const fp3_view_field *f = &page->fields->list[i];
        char name[130];
        snprintf(name, sizeof name, f->count > 1 ? "|%.*s|" : "%.*s", f->length, f->name);
        json_array_append_new(list, json_pack("{so so so sf sf}", "name", text(name), "unit",
                                              text(f->unit), "columns",
                                              shown_list(page->recording, f->columns, f->count),
                                              "least", f->least, "most", f->most));
    }
    return list;
}

static json_t *relations_of(const fp3_view_recording *r) {
    json_t *list = json_array();
    for (size_t i = 0; i < r->relation_count; i++)
        json_array_append_new(list, json_pack("{so sI sf}", "name", text(r->relations[i].name),
                                              "links", (json_int_t)r->relations[i].count, "reach",
                                              r->relations[i].reach));
    return list;
}

static json_t *planes_of(const fp3_view_page *page) {
    json_t *list = json_array();
    for (unsigned i = 0; i < page->plane_count; i++)
        json_array_append_new(list, json_pack("{si sf}", "axis", (int)page->planes[i].axis, "at",
                                              page->planes[i].at));
    return list;
}

static json_t *box_of(const fp3_view_page *page) {
    json_t *list = json_array();
    for (unsigned end = 0; end < 2 && page->box_axes; end++)
        for (unsigned k = 0; k < FP3_VIEW_AXES; k++)
            json_array_append_new(list, json_real(page->box[end][k]));
    return list;
}

/* Mostly a step is first + i * every, and the last is where the run ended; and a time is a step
 * times h. */
static json_t *steps_of(const fp3_view_recording *r) {
    const uint64_t first = r->steps[0], last = r->steps[r->snapshots - 1];
    const uint64_t every = r->snapshots > 1 ? r->steps[1] - first : 1;
    size_t i = 0;
    while (i < r->snapshots && r->steps[i] == (first + i * every < last ? first + i * every : last))
        i++;
    if (i == r->snapshots && last < (UINT64_C(1) << 53))
        return json_pack("{sI sI sI}", "first", (json_int_t)first, "every", (json_int_t)every,
                         "last", (json_int_t)last);
    json_t *list = json_array();
    for (i = 0; i < r->snapshots; i++)
        json_array_append_new(list, json_integer((json_int_t)r->steps[i]));
    return list;
}

static json_t *times_of(const fp3_view_recording *r) {
    if (!r->times)
        return json_null();
    const size_t last = r->snapshots - 1;
    const double h = r->steps[last] ? r->times[last] / (double)r->steps[last] : 0;
    size_t i = 0;
    while (i < r->snapshots && r->times[i] == (double)r->steps[i] * h)
        i++;
    if (i == r->snapshots)
        return json_pack("{sf}", "h", h);
    json_t *list = json_array();
    for (i = 0; i < r->snapshots; i++)
        json_array_append_new(list, json_real(isfinite(r->times[i]) ? r->times[i] : 0));
    return list;
}

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static json_t *facts_of(const fp3_view_recording *r) {
    return json_pack("{so so so so so so}", "file", text(base_name(r->path)), "model",
                     text(r->model), "doc", text(r->doc), "integrator", text(r->integrator),
                     "engine", text(r->engine), "configuration", text(r->configuration));
}

static json_t *position_of(const fp3_view_page *page) {
    const fp3_view_axes *axes = page->axes;
    return json_pack("{so so sb}", "name", text(axes->name), "columns",
                     shown_list(page->recording, axes->columns, axes->count), "hasOneScale",
                     axes->has_one_scale);
}

static json_t *list_of(const double *numbers, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_real(numbers[i]));
    return list;
}

/* From where to where is seen at first along each axis; null: wherever objects are. */
static json_t *ends_of(const fp3_view_page *page) {
    json_t *list = json_array();
    for (unsigned k = 0; k < page->axes->count; k++) {
        double ends[2] = {page->seen[k][0], page->seen[k][1]};
        if (!page->seen_axes && page->axes->has_shapes)
            fp3_view_outline_ends(page->recording, page->axes, k, ends);
        json_array_append_new(list, list_of(ends, 2));
    }
    if (page->seen_axes || page->axes->has_shapes)
        return list;
    json_decref(list);
    return json_null();
}

/* Corners are counted from the shape's first one. */
static json_t *triangles_of(const fp3_view_recording *r, const fp3_view_shape *s) {
    json_t *list = json_array();
    for (size_t i = s->triangle; i < s->triangle + s->triangles; i++) {
        json_t *corners = json_array();
        for (int k = 0; k < 3; k++)
            json_array_append_new(
                corners, json_integer((json_int_t)(r->triangles[i].corners[k] - s->first)));
        json_array_append_new(list, corners);
    }
    return list;
}

/* Those that are round or a line. */
static json_t *edges_of(const fp3_view_recording *r, const fp3_view_shape *s) {
    json_t *list = json_array();
    for (size_t i = s->edge; i < s->edge + s->edges; i++)
        if (s->radius > 0 || r->edges[i].is_sharp)
            json_array_append_new(list,
                                  json_pack("[II]", (json_int_t)(r->edges[i].ends[0] - s->first),
                                            (json_int_t)(r->edges[i].ends[1] - s->first)));
    return list;
}

static json_t *shapes_of(const fp3_view_recording *r) {
    json_t *list = json_array();
    for (size_t i = 0; i < r->shape_count; i++) {
        const fp3_view_shape *s = &r->shapes[i];
        json_t *corners = json_array();
        for (uint32_t k = 0; k < s->corners; k++)
            json_array_append_new(corners, list_of(r->corners[s->first + k], 3));
        json_array_append_new(
            list, json_pack("{sI sb sb si sf so so so}", "object", (json_int_t)s->object,
                            "isSensor", s->is_sensor != 0, "isPlane", isinf(s->radius) != 0, "type",
                            (int)s->type, "radius", isinf(s->radius) ? 0 : s->radius, "corners",
                            corners, "triangles", triangles_of(r, s), "edges", edges_of(r, s)));
    }
    return list;
}

static json_t *joints_of(const fp3_view_recording *r) {
    json_t *list = json_array();
    for (size_t i = 0; i < r->joint_count; i++) {
        const fp3_view_joint *j = &r->joints[i];
        json_array_append_new(list, json_pack("{s[II] sI s[oo]}", "of", (json_int_t)j->a,
                                              (json_int_t)j->b, "snapshots",
                                              (json_int_t)j->snapshots, "anchors",
                                              list_of(j->anchor[0], 3), list_of(j->anchor[1], 3)));
    }
    return list;
}

static json_t *contacts_of(const fp3_view_page *page) {
    const fp3_view_recording *r = page->recording;
    json_t *list = json_array();
    for (size_t i = 0; page->has_contacts && i < r->contact_count; i++) {
        const fp3_view_contact *c = &r->contacts[i];
        const double numbers[] = {(double)c->snapshot, c->point[0],  c->point[1],  c->point[2],
                                  c->normal[0],        c->normal[1], c->normal[2], c->force};
        json_array_append_new(list, list_of(numbers, 8));
    }
    return list;
}

static json_t *bodies_of(const fp3_view_page *page) {
    const fp3_view_recording *r = page->recording;
    const fp3_view_axes *axes = page->axes;
    const int has_asleep = axes->asleep != FP3_VIEW_NO_COLUMN;
    return axes->has_shapes ? json_pack("{sf so sI si so so so}", "most", r->force_most, "turn",
                                        shown_list(r, axes->turn, axes->turns), "asleep",
                                        has_asleep ? shown(r, axes->asleep) : (json_int_t)-1,
                                        "ways", FP3_VIEW_WAYS, "shapes", shapes_of(r), "joints",
                                        joints_of(r), "contacts", contacts_of(page))
                            : json_null();
}

/* Snapshots of a piece; the first piece is one snapshot, which is there at once. */
static size_t rows_at(const fp3_view_recording *r, size_t first) {
    const size_t left = r->snapshots - first;
    const size_t most = first == 0 ? 1 : r->objects < CHUNK_VALUES ? CHUNK_VALUES / r->objects : 1;
    return left < most ? left : most;
}

static json_t *chunks_of(const fp3_view_recording *r) {
    json_t *list = json_array();
    for (size_t first = 0; first < r->snapshots; first += rows_at(r, first))
        json_array_append_new(list, json_integer((json_int_t)rows_at(r, first)));
    return list;
}

static json_t *about(const fp3_view_page *page, const fp3_view_scale *scales) {
    const fp3_view_recording *r = page->recording;
    const fp3_view_axes *axes = page->axes;
    const int has_radius = axes->radius_of != FP3_VIEW_NO_COLUMN;
    const int has_colour = page->fields->colour != FP3_VIEW_NO_COLUMN;
    const char *title = page->title ? page->title : *r->model ? r->model : base_name(r->path);
    json_t *made =
        json_pack("{so so sb so so sI sI so so so so so so so so so so sf sI sI si}", "bodies",
                  bodies_of(page), "ends", ends_of(page), "isSeen", page->seen_axes != 0, "title",
                  text(title), "facts", facts_of(r), "objects", (json_int_t)r->objects, "snapshots",
                  (json_int_t)r->snapshots, "steps", steps_of(r), "times", times_of(r), "timeUnit",
                  text(r->time_unit), "columns", columns_of(r, scales), "fields", fields_of(page),
                  "position", position_of(page), "relations", relations_of(r), "planes",
                  planes_of(page), "box", box_of(page), "chunks", chunks_of(r), "radius",
                  axes->radius, "radiusOf", has_radius ? shown(r, axes->radius_of) : -1, "colour",
                  has_colour ? (json_int_t)page->fields->colour : -1, "up", page->up);
    return made;
}

/* '<' stands in texts alone, where JSON has another spelling for it. */
static fp3_status write_about(const fp3_view_page *page, const fp3_view_scale *scales, FILE *out,
                              fp3_error *error) {
    json_t *made = about(page, scales);
    char *dumped = made ? json_dumps(made, JSON_COMPACT | JSON_REAL_PRECISION(DIGITS)) : NULL;
    for (const char *c = dumped; c && *c; c++)
        if (*c == '<')
            fputs("\\u003c", out);
        else
            fputc(*c, out);
    const int is_good = dumped != NULL;
    free(dumped);
    json_decref(made);
    return is_good ? FP3_OK : fp3_no_memory(error);
}

/* ---- numbers ---- */

static fp3_status write_rows(const fp3_view_recording *r, size_t column,
                             const fp3_view_scale *scale, size_t first, size_t rows,
                             uint32_t *codes, FILE *out, fp3_error *error) {
    const float *values = r->columns[column].values + first * r->objects;
    for (size_t i = 0; i < rows * r->objects; i++)
        codes[i] = fp3_view_code(scale, values[i]);
    return fp3_view_pack(codes, rows, r->objects, scale->is_float, out, error);
}

static fp3_status write_chunk(const fp3_view_recording *r, const fp3_view_scale *scales,
                              size_t number, size_t first, uint32_t *codes, FILE *out,
                              fp3_error *error) {
    fp3_status status = FP3_OK;
    size_t column = 0;
    for (size_t i = 0; !status && i < r->column_count; i++) {
        if (!r->columns[i].values)
            continue;
        fprintf(out, "<script type=\"text/plain\" id=\"d%zu-%zu\">", number, column++);
        status = write_rows(r, i, &scales[i], first, rows_at(r, first), codes, out, error);
        fputs("</script>\n", out);
    }
    fprintf(out, "<script>fp3.unpack(%zu)</script>\n", number);
    return status;
}

static fp3_status write_chunks(const fp3_view_recording *r, const fp3_view_scale *scales, FILE *out,
                               fp3_error *error) {
    const size_t most = r->objects > CHUNK_VALUES ? r->objects : CHUNK_VALUES;
    uint32_t *codes = malloc(most * sizeof *codes);
    fp3_status status = codes ? FP3_OK : fp3_no_memory(error);
    size_t number = 0;
    for (size_t first = 0; !status && first < r->snapshots; first += rows_at(r, first))
        status = write_chunk(r, scales, number++, first, codes, out, error);
    free(codes);
    return status;
}

static fp3_status write_links(const fp3_view_recording *r, FILE *out, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < r->relation_count; i++) {
        const fp3_view_relation *of = &r->relations[i];
        uint32_t *codes = of->count ? malloc(2 * of->count * sizeof *codes) : NULL;
        if (!of->count)
            continue;
        if (!codes)
            return fp3_no_memory(error);
        memcpy(codes, of->pairs, 2 * of->count * sizeof *codes);
        fprintf(out, "<script type=\"text/plain\" id=\"l%zu\">", i);
        status = fp3_view_pack(codes, 1, 2 * of->count, 1, out, error);
        fputs("</script>\n", out);
        free(codes);
    }
    return status;
}

/* ---- all of it ---- */

fp3_status fp3_view_page_check(const fp3_view_page *page, fp3_error *error) {
    const unsigned count = page->axes->count;
    for (unsigned i = 0; i < page->plane_count; i++)
        if (page->planes[i].axis >= count)
            return fp3_fail(error, FP3_E_ARGUMENT, "--plane: the position has no %c: it is %s",
                            "xyz"[page->planes[i].axis], page -> axes -> name);
    if (page->box_axes && page->box_axes != count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--box: the position has %u axes, found a range for %u", count,
                        page->box_axes);
    if (page->seen_axes && page->seen_axes != count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--see: the position has %u axes, found a range for %u", count,
                        page->seen_axes);
    if (page->has_contacts && !page->axes->has_shapes)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--contacts: the recording has no shapes of bodies at this position");
    return FP3_OK;
}

fp3_status fp3_view_page_write(const fp3_view_page *page, FILE *out, fp3_view_scale *scales,
                               fp3_error *error) {
    const fp3_view_recording *r = page->recording;
    const char *const scripts[] = {
        fp3_view_text_data,  fp3_view_text_camera, fp3_view_text_shaders, fp3_view_text_bodies,
        fp3_view_text_scene, fp3_view_text_plot,   fp3_view_text_app};
    for (size_t i = 0; i < r->column_count; i++)
        if (r->columns[i].values)
            scales[i] =
                fp3_view_scale_of(r->columns[i].values, r->snapshots * r->objects, page->is_exact);
    fprintf(out, "%s<style>\n%s</style>\n%s<script type=\"application/json\" id=\"about\">",
            fp3_view_text_head, fp3_view_text_style, fp3_view_text_body);
    fp3_status status = write_about(page, scales, out, error);
    fputs("</script>\n<script>\n\"use strict\";\nconst fp3 = {};\n", out);
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts; i++)
        fprintf(out, "{\n%s}\n", scripts[i]);
    fputs("</script>\n", out);
    if (!status)
        status = write_links(r, out, error);
    if (!status)
        status = write_chunks(r, scales, out, error);
    fputs("<script>fp3.end()</script>\n</body>\n</html>\n", out);
    return status;
}
