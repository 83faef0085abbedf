/* pictures.h - one simulated fp3_pictures, for pictures.c; pictures_shim.cpp is the only file that
 * knows Verilator.
 */
#ifndef PICTURES_H
#define PICTURES_H

#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The processor behind it. */
typedef struct {
    /* 1: refused. How many of its cycles it took: *cycles. */
    int (*access)(int is_write, uint32_t address, uint32_t *data, uint64_t *cycles);
    /* A cycle without an access. */
    void (*rest)(void);
} pictures_processor;

typedef struct pictures pictures;

/* seed: of how long the processor's bus lets each channel wait; 0: never. */
pictures *pictures_open(const pictures_processor *processor, uint64_t seed);
void pictures_close(pictures *p);
void pictures_clock(pictures *p, uint64_t cycles);
/* The host. 1: refused; -1: it is never answered. */
int pictures_access(pictures *p, int is_write, uint32_t address, uint32_t *data);
/* Writes so many pixels from the next first pixel of a picture on: red, green, blue, and bit 0
 * visible, 1 hsync, 2 vsync. Returns the cycles of the last pixel but one; all others must have as
 * many, else 0. */
uint64_t pictures_frame(pictures *p, FILE *to, uint64_t pixels);

#ifdef __cplusplus
}
#endif
#endif
