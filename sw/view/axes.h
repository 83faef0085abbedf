/* SPDX-License-Identifier: Apache-2.0 */
/* axes.h - which values of a recording say where an object is, how large it is and what colour it
 * has. */
#ifndef FP3_VIEW_AXES_H
#define FP3_VIEW_AXES_H

#include "recorded.h"

#define FP3_VIEW_AXES 3

/* Names as the user gave them; NULL: he did not. */
typedef struct {
    const char *position; /* a vector, or one to three names with commas */
    const char *colour;   /* a name, or a vector: its length */
    const char *size;     /* a radius in the position's unit, or a name */
    const char *observed; /* names with commas that are shown, too; NULL: all */
} fp3_view_wishes;

typedef struct {
    size_t columns[FP3_VIEW_AXES]; /* of the recording */
    unsigned count;
    int has_one_scale; /* all in one unit: a metre is as long along each */
    char name[FP3_VIEW_AXES * 64];
    double radius;      /* in the unit of the position; 0: unknown */
    size_t radius_of;   /* column that has each object's; or FP3_VIEW_NO_COLUMN */
    int has_shapes;     /* the recording has shapes, and this is where their bodies are: */
    size_t turn[4];     /* columns: the angle, or in space a quaternion */
    unsigned turns;     /* how many */
    size_t asleep;      /* column: below 0 of one that sleeps; or none */
    const char *colour; /* a field's name; NULL: none */
    char speed[64];     /* the default field of colours; "" */
} fp3_view_axes;

/* Before the recording is loaded: chooses, and wants all that is shown. FP3_E_ARGUMENT: nothing can
 * be a position, or there is no such name; the message says what there is. */
fp3_status fp3_view_choose(fp3_view_recording *r, const fp3_view_wishes *wishes,
                           fp3_view_axes *axes, fp3_error *error);

/* Components "name_x", "name_y" and, maybe, "name_z" of a vector: how many there are, 0 if it is
 * none. */
unsigned fp3_view_vector(const fp3_view_recording *r, const char *name, size_t length,
                         size_t columns[FP3_VIEW_AXES]);
/* Whether the column is the first component of a vector: the length of the vector's name, else 0.
 */
size_t fp3_view_begins_vector(const fp3_view_recording *r, size_t column);

#endif
