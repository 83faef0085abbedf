/* SPDX-License-Identifier: Apache-2.0 */
/* obj.c - see obj.h. */
#include "obj.h"

#include "base/rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\r"

/* The next word of a line; its text is empty behind the last one. */
static fp3_token next_word(const fp3_rows *rows, const char **rest) {
    const char *word = *rest + strspn(*rest, BLANKS);
    const size_t length = strcspn(word, BLANKS);
    *rest = word + length;
    return (fp3_token){
        .text = word,
        .length = length,
        .location = {.line = rows->number, .column = (unsigned)(word - rows->line) + 1},
        .kind = length ? FP3_TOKEN_NUMBER : FP3_TOKEN_END};
}

static int make_room(void **list, size_t *room, size_t wanted, size_t size) {
    if (wanted <= *room)
        return 1;
    const size_t grown = wanted > 2 * *room ? wanted : 2 * *room;
    if (!fp3_rows_grow(list, grown, size))
        return 0;
    *room = grown;
    return 1;
}

static fp3_status take_point(fp3_obj *mesh, const fp3_rows *rows, const char *rest,
                             fp3_error *error) {
    fp3_status status = FP3_OK;
    if (!make_room((void **)&mesh->point, &mesh->point_room, mesh->points + 1,
                   3 * sizeof *mesh->point))
        return fp3_no_memory(error);
    for (int k = 0; !status && k < 3; k++) {
        const fp3_token word = next_word(rows, &rest);
        double *to = &mesh->point[3 * mesh->points + (size_t)k];
        status = word.length ? fp3_rows_number(rows, word, to, error)
                             : fp3_rows_wrong(rows, word, "three numbers of a point", error);
        if (!status && !isfinite(*to))
            status = fp3_rows_wrong(rows, word, "a finite number", error);
    }
    mesh->points++;
    return status;
}

/* A point by its number: that before the first slash. */
static fp3_status take_corner(const fp3_obj *mesh, const fp3_rows *rows, fp3_token word,
                              uint32_t *corner, fp3_error *error) {
    const char *slash = memchr(word.text, '/', word.length);
    fp3_token number = word;
    double found = 0;
    if (slash)
        number.length = (size_t)(slash - word.text);
    fp3_status status = fp3_rows_number(rows, number, &found, error);
    if (status)
        return status;
    const double at = found < 0 ? (double)mesh->points + found : found - 1;
    if (floor(found) != found || found == 0 || !(at >= 0 && at < (double)mesh->points))
        return fp3_rows_wrong(rows, number,
                              "the number of a point above, from 1 on, or from -1 back", error);
    *corner = (uint32_t)at;
    return FP3_OK;
}

static fp3_status take_face(fp3_obj *mesh, const fp3_rows *rows, const char *rest,
                            fp3_error *error) {
    uint32_t corner[3];
    size_t count = 0;
    fp3_status status = FP3_OK;
    fp3_token word = next_word(rows, &rest);
    for (; !status && word.length; word = next_word(rows, &rest), count++) {
        status = take_corner(mesh, rows, word, &corner[count < 3 ? count : 2], error);
        if (status || count < 2)
            continue;
        if (!make_room((void **)&mesh->triangle, &mesh->triangle_room, mesh->triangles + 1,
                       sizeof *mesh->triangle))
            return fp3_no_memory(error);
        memcpy(mesh->triangle[mesh->triangles++], corner, sizeof corner);
        corner[1] = corner[2];
    }
    return !status && count < 3
               ? fp3_rows_wrong(rows, word, "three corners of a face, or more", error)
               : status;
}

/* Whether a backslash at the end says that the next line goes on. */
static int is_continued(const fp3_rows *rows, fp3_token *last) {
    size_t end = strlen(rows->line);
    while (end && strchr(BLANKS "\n", rows->line[end - 1]))
        end--;
    if (!end || rows->line[end - 1] != '\\')
        return 0;
    *last = (fp3_token){.text = rows->line + end - 1,
                        .length = 1,
                        .location = {.line = rows->number, .column = (unsigned)end},
                        .kind = FP3_TOKEN_NAME};
    return 1;
}

static fp3_status take_line(fp3_obj *mesh, const fp3_rows *rows, fp3_error *error) {
    static const char *const others[] = {"vt", "vn", "vp",     "o",      "g", "s",
                                         "l",  "p",  "usemtl", "mtllib", NULL};
    const char *rest = rows->line;
    const fp3_token word = next_word(rows, &rest);
    fp3_token last;
    if (is_continued(rows, &last))
        return fp3_rows_wrong(rows, last, "all of a statement in one line", error);
    if (fp3_token_is(word, "v"))
        return take_point(mesh, rows, rest, error);
    if (fp3_token_is(word, "f"))
        return take_face(mesh, rows, rest, error);
    for (size_t i = 0; others[i]; i++)
        if (fp3_token_is(word, others[i]))
            return FP3_OK;
    return fp3_rows_wrong(rows, word, "v, f, or another word of Wavefront's format", error);
}

fp3_status fp3_obj_read(const char *path, fp3_obj *mesh, fp3_error *error) {
    fp3_rows rows = {0};
    int is_there = 1;
    fp3_status status = fp3_rows_open(&rows, path, error);
    while (!status && !(status = fp3_rows_next(&rows, &is_there, error)) && is_there)
        status = take_line(mesh, &rows, error);
    fp3_rows_close(&rows);
    return status;
}

void fp3_obj_free(fp3_obj *mesh) {
    free(mesh->point);
    free(mesh->triangle);
    *mesh = (fp3_obj){0};
}
