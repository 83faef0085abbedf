/* SPDX-License-Identifier: Apache-2.0 */
/* recorded.h - what is known of a recording: its columns, by name, and who sees whom. */
#ifndef FP3_VIEW_RECORDED_H
#define FP3_VIEW_RECORDED_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

#define FP3_VIEW_COLUMNS_MOST 4096
#define FP3_VIEW_RELATIONS_MOST 16
#define FP3_VIEW_VALUES_MOST (UINT64_C(1) << 28) /* more than a browser has room for */
#define FP3_VIEW_NO_COLUMN SIZE_MAX

/* What was observed of all objects. Texts are never NULL. */
typedef struct {
    char *name, *unit, *doc;
    char *velocity; /* the name of its derivative; "" if that is unknown */
    int is_wanted;
    int is_made;   /* by us: the number of the object, or the time */
    float *values; /* [snapshot][object], once they are loaded */
    int source;    /* the reader's number */
} fp3_view_column;

typedef struct {
    char *name;
    uint32_t *pairs; /* linked objects */
    size_t count;    /* of pairs */
    double reach;    /* of those near; 0: unknown */
    char *position;  /* names of what the reach is measured in, with commas; "" */
} fp3_view_relation;

/* Shapes of rigid bodies, as docs/outputs.md has them. An infinite radius is a plane. */
typedef struct {
    uint32_t object, corners, is_sensor, type; /* type: 0 moves, 2 never does */
    double radius;
    size_t first;                            /* corner */
    size_t triangle, triangles, edge, edges; /* the first of them, and how many there are */
} fp3_view_shape;

/* Two rows of the corners; of a sphere or a circle twice the same. A sharp one is drawn as a line.
 */
typedef struct {
    uint32_t ends[2];
    int is_sharp;
} fp3_view_edge;

typedef struct {
    uint32_t corners[3]; /* rows of them, anticlockwise as seen from outside */
    uint32_t rims;       /* bit k: the edge from corner k on is sharp */
} fp3_view_triangle;

typedef struct {
    uint32_t a, b, type, snapshots; /* objects; it is there in so many snapshots of the file */
    double anchor[2][3];
} fp3_view_joint;

typedef struct {
    uint64_t snapshot; /* of those that are loaded */
    double point[3], normal[3], force;
} fp3_view_contact;

typedef struct fp3_view_reader fp3_view_reader;

typedef struct {
    const char *path;
    char *model, *doc, *integrator, *engine, *configuration, *time_unit; /* "" where unknown */
    fp3_view_column *columns;
    size_t column_count;
    fp3_view_relation relations[FP3_VIEW_RELATIONS_MOST];
    size_t relation_count;
    fp3_view_shape *shapes;
    double (*corners)[3]; /* of all shapes */
    fp3_view_triangle *triangles;
    fp3_view_edge *edges;
    fp3_view_joint *joints;
    fp3_view_contact *contacts; /* snapshot by snapshot */
    size_t shape_count, triangle_count, joint_count, contact_count;
    double force_most;         /* of all contacts of the file */
    size_t objects, snapshots; /* of CSV known when it is loaded */
    uint64_t *steps;           /* of each snapshot */
    double *times;             /* likewise; NULL: there is no time */
    int has_time;
    fp3_view_reader *reader;
} fp3_view_recording;

/* FP3_VIEW_NO_COLUMN: there is none of this name. */
size_t fp3_view_find(const fp3_view_recording *r, const char *name);
/* The column of this name will be loaded. "object" is the number of each object, "time" the time of
 * each snapshot. FP3_E_ARGUMENT: there is none; the message names those that there are. */
fp3_status fp3_view_want(fp3_view_recording *r, const char *name, size_t *column, fp3_error *error);
/* "x_x [m], x_y [m], ..."; cut to the size. */
const char *fp3_view_names(const fp3_view_recording *r, char *text, size_t size);

/* A column with these texts, which belong to the recording from here on; NULL is "". FP3_E_SYSTEM:
 * out of memory. */
fp3_status fp3_view_add(fp3_view_recording *r, char *name, char *unit, int source,
                        fp3_error *error);

/* Whether that many values have room. FP3_E_ARGUMENT, and the message says what makes them fewer.
 */
fp3_status fp3_view_check_size(const fp3_view_recording *r, uint64_t snapshots, uint64_t objects,
                               fp3_error *error);

/* A wide number as the float that it is shown as; NaN stays what it is. 0: it is finite, and no
 * float is near it. */
int fp3_view_narrow(double wide, float *value);

/* Frees all but the reader. */
void fp3_view_recorded_free(fp3_view_recording *r);

#endif
