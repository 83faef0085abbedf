/* SPDX-License-Identifier: Apache-2.0 */
/* view_draw.c - see view_draw.h. */
#include "view_draw.h"

#include "cli.h"

#include "base/file.h"
#include "view/png.h"
#include "view/video.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAME_TIME 1e-9 /* of the time: decimals are rounded */
#define RATE_MOST 1000

/* ---- which snapshot ---- */

static double time_of(const fp3_view_recording *r, size_t snapshot) {
    return r->times ? r->times[snapshot] : (double)r->steps[snapshot];
}

/* Only what was recorded is shown, and nothing between: the nearest snapshot. */
static fp3_status find_snapshot(const fp3_view_options *o, size_t *snapshot, fp3_error *error) {
    const fp3_view_recording *r = o->page.recording;
    const size_t last = r->snapshots - 1;
    const double slack = SAME_TIME * fabs(o->at);
    *snapshot = last;
    if (!o->has_at)
        return FP3_OK;
    if (!(o->at >= time_of(r, 0) - slack && o->at <= time_of(r, last) + slack))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--at: found %.9g, expected a time from %.9g to %.9g", o->at, time_of(r, 0),
                        time_of(r, last));
    for (size_t n = last; n-- > 0;)
        if (fabs(time_of(r, n) - o->at) <= fabs(time_of(r, *snapshot) - o->at))
            *snapshot = n;
    return FP3_OK;
}

/* ---- how fast ---- */

/* Snapshots in a second of the recording; 0: it is not known how long a second is. */
static double real_rate(const fp3_view_recording *r) {
    const size_t last = r->snapshots - 1;
    const double span = r->times ? r->times[last] - r->times[0] : 0;
    return span > 0 && isfinite(span) && strcmp(r->time_unit, "s") == 0 ? (double)last / span : 0;
}

static fp3_status find_rate(const fp3_view_options *o, uint16_t *rate, fp3_error *error) {
    const double real = real_rate(o->page.recording);
    *rate = o->rate;
    if (o->rate)
        return FP3_OK;
    if (real == 0)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "--rate real: expected a recording of several snapshots whose times are in s");
    *rate = (uint16_t)floor(fmin(real, RATE_MOST + 1) + 0.5);
    if (*rate < 1 || *rate > RATE_MOST)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "--rate real: a second of the recording has %.4g snapshots, expected 1 to %d: "
            "--every takes fewer",
            real, RATE_MOST);
    return FP3_OK;
}

/* ---- drawing ---- */

typedef struct {
    const char *path;
    size_t first, count; /* snapshots */
    uint16_t rate;       /* of a film; 0: it is a picture */
} reel;

static fp3_status draw_all(const fp3_view_options *o, const reel *of, FILE *out,
                           fp3_progress *progress, fp3_error *error) {
    fp3_view_picture picture;
    fp3_view_png png = {.width = o->look.width,
                        .height = o->look.height,
                        .pictures = (uint32_t)of->count,
                        .rate = of->rate};
    fp3_status status = fp3_view_picture_make(&o->page, &o->look, &picture, error);
    if (!status)
        fp3_view_png_begin(&png, out);
    for (size_t n = 0; !status && n < of->count; n++) {
        fp3_progress_share(progress, (double)n / (double)of->count);
        fp3_view_picture_draw(&picture, of->first + n);
        status = fp3_view_png_add(&png, picture.pixels, out, error);
    }
    if (!status)
        fp3_view_png_end(out);
    fp3_view_picture_free(&picture);
    return status;
}

static void print(const fp3_view_options *o, const reel *of) {
    const fp3_view_page *page = &o->page;
    char speed[80] = "";
    if (of->rate && real_rate(page->recording) > 0)
        snprintf(speed, sizeof speed, ", %d a second: %.4g times real time", of->rate,
                 of->rate / real_rate(page->recording));
    fp3_cli_line(stdout, "%s: %" PRIu32 " x %" PRIu32 " pixels, %zu snapshot%s from time %.9g on%s",
                 of->path, o->look.width, o->look.height, of->count, of->count == 1 ? "" : "s",
                 time_of(page->recording, of->first), speed);
    if (page->fields->colour == FP3_VIEW_NO_COLUMN)
        return;
    const fp3_view_field *field = &page->fields->list[page->fields->colour];
    fp3_cli_line(stdout, "%-16s colours: from %.6g, dark, to %.6g, bright%s%s", page->axes->colour,
                 field->least, field->most, *field->unit ? ", in " : "", field->unit);
}

/* By way of a temporary file, from which ffmpeg reads. */
static fp3_status draw_video(const fp3_view_options *o, const reel *of, const char *temporary,
                             fp3_progress *progress, fp3_error *error) {
    if (!temporary)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: a video needs a regular file", of->path);
    fp3_status status = fp3_view_video_check(o->look.width, o->look.height, error);
    FILE *film = status ? NULL : tmpfile();
    if (!status && !film)
        status = fp3_fail(error, FP3_E_SYSTEM, "cannot make a temporary file");
    if (!status)
        status = draw_all(o, of, film, progress, error);
    if (!status)
        status = fp3_view_video_make(film, temporary, error);
    if (film)
        fclose(film);
    return status;
}

static fp3_status draw_file(const fp3_view_options *o, const reel *of, fp3_progress *progress,
                            fp3_error *error) {
    fp3_output *output = NULL;
    fp3_progress_say(progress, "drawing");
    fp3_status status = fp3_output_open(of->path, &output, error);
    if (!status && of->rate && fp3_view_video_is_named(of->path))
        status = draw_video(o, of, fp3_output_temporary(output), progress, error);
    else if (!status)
        status = draw_all(o, of, fp3_output_stream(output), progress, error);
    if (!status)
        status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    fp3_progress_pause(progress);
    if (!status)
        print(o, of);
    fp3_progress_resume(progress);
    return status;
}

fp3_status fp3_view_draw(const fp3_view_options *o, fp3_progress *progress, fp3_error *error) {
    size_t snapshot = 0;
    uint16_t rate = 0;
    fp3_status status = find_snapshot(o, &snapshot, error);
    if (!status && o->film)
        status = find_rate(o, &rate, error);
    if (!status && o->png)
        status = draw_file(o, &(reel){o->png, snapshot, 1, 0}, progress, error);
    if (!status && o->film)
        status =
            draw_file(o, &(reel){o->film, 0, o->page.recording->snapshots, rate}, progress, error);
    return status;
}
