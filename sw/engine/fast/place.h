/* SPDX-License-Identifier: Apache-2.0 */
/* place.h - the block of objects that code works on. Its text stands in front of that of lanes.h.
 */
#ifndef FP3_FAST_PLACE_H
#define FP3_FAST_PLACE_H

#define FP3_FAST_NAME "fp3_stretch" /* the function of a program's native code */
#define FP3_BLOCK 512               /* objects */
#define FP3_SEEN_SUBNORMAL 1u
#define FP3_SEEN_UNDERFLOW 2u
#define FP3_BEGINS 1u /* of a stretch of steps: the first part comes before it ... */
#define FP3_ENDS 2u   /* ... and the last part behind */

/* Behind the two tables of estimates (machine/estimate.h) stand numbers that computing them takes:
 * one in memory is had by all lanes at once, while one in the code is made anew each time. */
enum {
    FP3_AT_RCP_LEAST = 2048, /* number, and how far above it one may be */
    FP3_AT_RSQRT_LEAST,
    FP3_AT_ABOVE,
    FP3_AT_RCP_END, /* of an interval of the table: all bits below it */
    FP3_AT_RSQRT_END,
    FP3_AT_NEXT,
    FP3_AT_HALF_OF_NEXT,
    FP3_AT_RCP_CUT,
    FP3_AT_RSQRT_CUT,
    FP3_AT_RSQRT_ODD, /* a bit more that is cut from an estimate of an odd exponent */
    FP3_AT_HALF,      /* and a margin */
    FP3_AT_ONE,       /* and a margin */
    FP3_TABLE
};
static inline void fp3_table_finish(int table[FP3_TABLE]) {
    const int numbers[FP3_TABLE - FP3_AT_RCP_LEAST] = {
        0x00800000,     0x01000000, 251 << 23, 0x1fff, 0x3fff,     1,
        1 - 0x00800000, ~0x3fff,    0x1fff,    0x2000, 0x3f000004, 0x3f800002};
    for (int i = FP3_AT_RCP_LEAST; i < FP3_TABLE; i++)
        table[i] = numbers[i - FP3_AT_RCP_LEAST];
}

/* Rows have FP3_BLOCK lanes, one for each object. */
typedef struct {
    float *rows; /* [65][FP3_BLOCK], aligned to 64 bytes: registers, and what a neighbour gives */
    float *const *records; /* [64]: rows of words in the store, aligned to 4 bytes */
    const int *constants;  /* [64]: bits of FP32 numbers */
    const int *table;      /* [FP3_TABLE] */
    const int *objects;    /* [FP3_BLOCK], with a seed: the numbers of the objects */
    unsigned seed;         /* of draws (machine/storage.h); 0: stores round to nearest */
    int *awake;            /* a row, aligned: -1, or 0 where the object sleeps */
    unsigned *seen;   /* FP3_SEEN_*, by an executor that knows: products that were subnormal, or
                         raised underflow */
    unsigned vectors; /* all lanes of the last one have an object's values, too */
} fp3_fast_place;

/* A list of neighbours of each object, for vectors of as many objects as native code has lanes. A
 * turn is one neighbour of each object of a vector, or of some: for the others another pair stands
 * in, which is in the list of theirs anyway. The tape has for each vector that has turns
 *     0; or 1 and a row of lanes: which object stands in for each. Itself, but for one that has no
 * neighbour at all and for each turn base, others, kind   the neighbours are base, base + 1 .., and
 * for those that have none others, others + 1 ..; base < 0: they are those of a row that follows
 *     neighbours           a row, if base < 0
 *     fields               a row of each; with FP3_TURN_SAME one word of each. Of a list whose
 * fields are written: a row, where in `field` those of each lane's entry begin Turns come
 * FP3_TURNS_BESIDE at a time; the last of them may be padding. */
#define FP3_TURN_HEAD 3 /* words */
#define FP3_TURN_SAME 1 /* all with the same fields */
/* Of the first of them: in all every object has a neighbour, from base on, with the same fields. */
#define FP3_TURN_PLAIN 2
#define FP3_TURN_TAKES 16 /* from this bit on: a bit for each lane that has a neighbour */
#define FP3_TURNS_BESIDE 3
typedef struct {
    unsigned objects;    /* that have lists */
    unsigned first, end; /* without a tape: turn t is object t of these, but for oneself */
    /* Of each vector: where its turns begin on the tape; one more behind the last. NULL: there is
     * no tape. */
    const unsigned long *start;
    const int *tape;
    int *field; /* of a list whose fields are written: all of them */
} fp3_fast_list;

/* A phase of objects that see each other. */
typedef struct {
    const float *const *
        own; /* [64]: columns of the objects, to be loaded; the first object is first in the list */
    float *const *next; /* [64]: likewise, to be stored */
    const float *const
        *seen;            /* [64]: columns of all objects of the group, as neighbours see them */
    const int *constants; /* [64] */
    const int *table;     /* [FP3_TABLE] */
    const fp3_fast_list *lists;
    float *records; /* of each object of the group what neighbours read, word by word, FP3_RECORD
                       floats of each; it has whole vectors. Phase number `phases` of a program
                       makes them of `own`, and the others read them where neighbours do not stand
                       side by side */
    unsigned bias;  /* vector `bias` of the lists is the first of the columns */
} fp3_fast_around;

#endif
