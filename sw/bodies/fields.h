/* SPDX-License-Identifier: Apache-2.0 */
/* fields.h - what a checkpoint keeps of a world of bodies: arrays, and the fields of an element. */
#ifndef FP3_BODIES_FIELDS_H
#define FP3_BODIES_FIELDS_H

#include "own.h"

#include "record/hdf5/fp3_hdf5.h"
#include "record/state.h"

/* What a step depends on; it makes other arrays anew. */
enum {
    FP3_PART_BODIES,
    FP3_PART_SHAPES,
    FP3_PART_BOXES,
    FP3_PART_FILTERS,
    FP3_PART_TOUCHES,
    FP3_PART_JOINTS,
    FP3_PART_APART,
    FP3_PARTS
};

typedef struct {
    void **array;
    uint32_t *room, *count;
    size_t size; /* of an element */
} fp3_kept_part;
fp3_kept_part fp3_part_of(fp3_bodies *bodies, int which);

typedef struct {
    const char *name; /* as C has it */
    size_t at;        /* bytes from the beginning of the element */
    fp3_hdf5_type type;
    uint32_t count;
    int is_byte; /* a number of 8 bits, in the file of 32 */
    int is_any;  /* numbers that are not finite are numbers, too */
} fp3_kept_field;

typedef struct {
    const char *name;
    const fp3_kept_field *fields;
    size_t count;
} fp3_kept_fields;
extern const fp3_kept_fields fp3_fields_of[FP3_PARTS];
/* Of fp3_bodies itself: one element. */
extern const fp3_kept_fields fp3_fields_of_world;

/* "bodies.v": field `field`. */
enum { FP3_FIELD_NAME = 64 };
void fp3_field_name(char name[FP3_FIELD_NAME], const fp3_kept_fields *of,
                    const fp3_kept_field *field);
size_t fp3_field_size(const fp3_kept_field *field);

/* The attribute that no checkpoint of a run has, and its text, which changes with the fields. */
#define FP3_KEPT_WHAT "bodies"
#define FP3_KEPT_FORM "1"
enum { FP3_KEPT_HASH = 17 };
/* SHA-256 of the texts of all laws: others give other bits. */
fp3_status fp3_kept_laws(const fp3_hdf5_ops *calls, const fp3_laws *laws,
                         char text[FP3_DIGEST_SIZE], fp3_error *error);
void fp3_kept_hash(const fp3_bodies *bodies, char text[FP3_KEPT_HASH]);

#endif
