/* SPDX-License-Identifier: Apache-2.0 */
/* fields.h - what a world of bodies is: the arrays that are saved, and the fields of their elements
 * that a checkpoint has. */
#ifndef FP3_BODIES_FIELDS_H
#define FP3_BODIES_FIELDS_H

#include "own3.h"

#include "record/checkpoint.h"
#include "record/hdf5/fp3_hdf5.h"

/* What a step depends on; it makes other arrays anew. */
enum {
    FP3_PART_BODIES,
    FP3_PART_SHAPES,
    FP3_PART_BOXES,
    FP3_PART_FILTERS,
    FP3_PART_TOUCHES,
    FP3_PART_JOINTS,
    FP3_PART_BEGAN, /* changes of contacts, by fp3_contact_change */
    FP3_PART_ENDED,
    FP3_PART_HIT,
    FP3_PARTS_IN_PLANE,
    FP3_PART_BODIES3 = FP3_PARTS_IN_PLANE,
    FP3_PART_JOINTS3,
    FP3_PART_PATCHES,
    FP3_PARTS_SAVED,
    /* In files shapes in space name their forms by numbers. */
    FP3_PART_FORMS = FP3_PARTS_SAVED,
    FP3_PART_CORNERS,
    FP3_PART_TRIANGLES,
    FP3_PART_FORM_OF,
    FP3_PARTS
};
static inline int fp3_parts_saved(const fp3_bodies *bodies) {
    return bodies->space ? FP3_PARTS_SAVED : FP3_PARTS_IN_PLANE;
}

typedef struct {
    void **array;
    uint32_t *room, *count;
    size_t size; /* of an element */
} fp3_kept_part;
/* bodies: its pointers and counts are what is pointed to. */
fp3_kept_part fp3_part_of(fp3_bodies *bodies, int which);

/* What is counted and not kept: all arrays that are saved are there. */
void fp3_bodies_count_up(fp3_bodies *bodies);

typedef struct {
    const char *name; /* as C has it */
    size_t at;        /* bytes from the beginning of the element */
    fp3_hdf5_type type;
    uint32_t count;
    int is_byte; /* a number of 8 bits, in the file of 32 */
    int is_any;  /* numbers that are not finite are numbers, too */
} fp3_kept_field;

typedef struct {
    const char *name; /* datasets begin with it */
    const fp3_kept_field *fields;
    size_t count;
    int part;       /* of whose elements they are; -1: of fp3_bodies itself, one element */
    int dimensions; /* 2 or 3: a plane or space alone has them */
    int is_beside;  /* as many as another list says */
} fp3_kept_list;
/* In the order in which they are read: the world's own first. */
extern const fp3_kept_list fp3_kept_lists[];
extern const size_t fp3_kept_list_count;
static inline int fp3_list_is_of(const fp3_kept_list *list, unsigned dimensions) {
    return !list->dimensions || (unsigned)list->dimensions == dimensions;
}
fp3_kept_part fp3_kept_elements(fp3_bodies *bodies, const fp3_kept_list *list);

/* "bodies.v": field `field`. */
enum { FP3_FIELD_NAME = 64 };
void fp3_field_name(char name[FP3_FIELD_NAME], const fp3_kept_list *of,
                    const fp3_kept_field *field);
size_t fp3_field_size(const fp3_kept_field *field);
/* A field of all elements side by side, as a file has it. column: room for them. */
void fp3_field_gather(const fp3_kept_field *field, const void *elements, size_t size, uint32_t rows,
                      void *column);
void fp3_field_scatter(const fp3_kept_field *field, const void *column, uint32_t rows,
                       void *elements, size_t size);

/* forms.c: the forms of a world in space, as files have them. fp3_forms_number fills the last four
 * parts, and fp3_forms_make gives shapes the forms of these. FP3_E_ARGUMENT: no such forms. Others
 * than these two do not look at the parts, which the world frees when it is closed, or before. */
fp3_status fp3_forms_number(fp3_bodies *bodies);
fp3_status fp3_forms_make(fp3_bodies *bodies, fp3_error *error);
void fp3_forms_forget(fp3_bodies *bodies);

/* The attribute that no other checkpoint has, and its text, which changes with the fields. */
#define FP3_KEPT_WHAT FP3_CHECKPOINT_BODIES
#define FP3_KEPT_FORM "2"
enum { FP3_KEPT_HASH = 17 };
/* SHA-256 of the texts of all laws: others give other bits. */
fp3_status fp3_kept_laws(const fp3_hdf5_ops *calls, const fp3_bodies *bodies,
                         char text[FP3_DIGEST_SIZE], fp3_error *error);
void fp3_kept_hash(const fp3_bodies *bodies, char text[FP3_KEPT_HASH]);
/* checkpoint.c: before fields are looked at. Numbers without a meaning become 0: those behind the
 * last point of a manifold, and room for patches. Forms are numbered: fp3_forms_forget is due. */
fp3_status fp3_kept_tidy(fp3_bodies *bodies);

#endif
