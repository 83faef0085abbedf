/* place.h - the block of objects that code works on. Its text stands in front of that of lanes.h. */
#ifndef FP3_FAST_PLACE_H
#define FP3_FAST_PLACE_H

#define FP3_BLOCK 512 /* objects */
#define FP3_SEEN_SUBNORMAL 1u
#define FP3_SEEN_UNDERFLOW 2u
#define FP3_BEGINS 1u /* of a stretch of steps: the first part comes before it ... */
#define FP3_ENDS 2u   /* ... and the last part behind */

/* Rows have FP3_BLOCK lanes, one for each object. */
typedef struct {
    float *rows;           /* [64][FP3_BLOCK], aligned to 64 bytes: registers */
    float *const *records; /* [64]: rows of words in the store, aligned to 4 bytes */
    const int *constants;  /* [64]: bits of FP32 numbers */
    const int *table;      /* fp3_estimates */
    int *awake;            /* a row, aligned: -1, or 0 where the object sleeps */
    unsigned *
        seen; /* FP3_SEEN_*, by an executor that knows: products that were subnormal, or raised underflow */
    unsigned vectors; /* all lanes of the last one have an object's values, too */
} fp3_fast_place;

/* A list of neighbours of each object, for vectors of as many objects as the executor has lanes. A turn is one neighbour of
 * each object of a vector; where an object has none, lane `from` of the vector stands in for it: it does what that
 * one does, and nothing of it counts. */
typedef struct {
    unsigned objects;
    const unsigned *
        turn; /* of each vector: its first turn; one more behind the last. NULL: turn t of each vector is object t */
    const int *base;  /* of each turn: the neighbours are base, base + 1 ..; -1: those of `other` */
    const int *other; /* of each lane of each turn */
    const int *from;  /* likewise; the lane itself if it has a neighbour */
    const unsigned char *is_full; /* of each turn: every lane has one */
    const float *field; /* of each turn, its fields one after the other: a vector of each */
    unsigned fields;
} fp3_fast_list;

/* A phase of objects that see each other. */
typedef struct {
    const float *const *
        own; /* [64]: columns of the objects, to be loaded; the first object is first in the list */
    float *const *next; /* [64]: likewise, to be stored */
    const float *const
        *seen;            /* [64]: columns of all objects of the group, as neighbours see them */
    const int *constants; /* [64] */
    const int *table;     /* fp3_estimates */
    const fp3_fast_list *lists;
    unsigned bias; /* vector `bias` of the lists is the first of the columns */
} fp3_fast_around;

#endif
