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

#endif
