/* SPDX-License-Identifier: Apache-2.0 */
/* raster.h - balls, lines and areas as pixels.
 *
 * Which pixels are drawn, and in what colour, is decided in whole numbers and by sums, products and
 * quotients in double, so they are the same on every machine. A picture is drawn twice as wide and
 * high, and each pixel is the mean of four.
 */
#ifndef FP3_VIEW_RASTER_H
#define FP3_VIEW_RASTER_H

#include <fp3/status.h>
#include <stdint.h>

#define FP3_VIEW_PART 16 /* of a pixel of the drawing, in which places are counted */
#define FP3_VIEW_FINE 2  /* pixels of the drawing along a pixel of the picture */
#define FP3_VIEW_DEPTH_MOST (1 << 28)

typedef struct {
    uint8_t red, green, blue;
} fp3_view_ink;

/* In parts of a pixel; depth grows away from the eye. */
typedef struct {
    int32_t x, y, depth;
} fp3_view_place;

typedef struct {
    int32_t width, height; /* of the drawing, in pixels */
    fp3_view_ink *pixels;
    int32_t *depths;
    uint32_t *veils; /* the last veil over each pixel */
    uint32_t veil;   /* which one is drawn: it covers a pixel once */
} fp3_view_raster;

/* The caller frees *raster, after a failure too. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_view_raster_make(uint32_t width, uint32_t height, fp3_view_raster *raster,
                                fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_view_raster_free(fp3_view_raster *raster);

void fp3_view_raster_clear(fp3_view_raster *raster, fp3_view_ink ink);
/* A ball of this radius in parts of a pixel, whose light comes from the left above. deep: its
 * radius as a depth. */
void fp3_view_raster_ball(fp3_view_raster *raster, fp3_view_place at, int32_t radius, int32_t deep,
                          fp3_view_ink ink);
/* A line that lets 256 - cover parts of 256 through. */
void fp3_view_raster_line(fp3_view_raster *raster, fp3_view_place from, fp3_view_place to,
                          fp3_view_ink ink, uint32_t cover);

/* Of a plane as seen: at (x, y), in parts, the depth is first + rest / (one + right x + down y). */
typedef struct {
    double first, rest, one, right, down;
} fp3_view_slope;

/* How an area is drawn: with a rim of this width within it, in parts of a pixel, along the edges
 * from the corners of these bits. */
typedef struct {
    fp3_view_ink ink, rim;
    int32_t width;
    uint64_t rims;
    uint32_t cover; /* 256 hides what is behind; else 256 - cover parts of 256 come through */
} fp3_view_paint;

/* A convex area, anticlockwise or clockwise, where nothing nearer to the eye was drawn. At most
 * FP3_VIEW_AREA_MOST corners; of more nothing is drawn. */
#define FP3_VIEW_AREA_MOST 64
void fp3_view_raster_area(fp3_view_raster *raster, const fp3_view_place *corners, unsigned count,
                          const fp3_view_slope *slope, const fp3_view_paint *paint);
/* A pixel of the drawing. */
void fp3_view_raster_put(fp3_view_raster *raster, int32_t column, int32_t row, double depth,
                         fp3_view_ink ink, uint32_t cover);
/* An ink in a light from 0 to 256. */
fp3_view_ink fp3_view_lit(fp3_view_ink ink, uint32_t light);
/* The picture: 3 bytes of each pixel. */
void fp3_view_raster_take(const fp3_view_raster *raster, uint8_t *pixels);

#endif
