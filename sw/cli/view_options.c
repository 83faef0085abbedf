/* SPDX-License-Identifier: Apache-2.0 */
/* view_options.c - see view_options.h. */
#include "view_options.h"

#include "arguments.h"

#include <fp3/model.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PIXELS_MOST 8192 /* of a picture's side */

/* ---- walls ---- */

static double number(struct argp_state *state, const char *option, const char *text) {
    double value = 0;
    fp3_error error;
    if (fp3_constant_read(text, &value, &error))
        argp_error(state, "%s: '%s' is no number: %s", option, text, error.text);
    if (!isfinite(value))
        argp_error(state, "%s: found '%s', expected a finite number", option, text);
    return value;
}

static void plane(struct argp_state *state, fp3_view_page *page, const char *text) {
    if (!*text || !strchr("xyz", text[0]) || text[1] != '=')
        argp_error(state, "--plane: found '%s', expected x, y or z, = and a number", text);
    if (page->plane_count == FP3_VIEW_PLANES_MOST)
        argp_error(state, "--plane: %d planes at most", FP3_VIEW_PLANES_MOST);
    page->planes[page->plane_count++] =
        (fp3_view_plane){(unsigned)(text[0] - 'x'), number(state, "--plane", text + 2)};
}

static void box(struct argp_state *state, fp3_view_page *page, char *text) {
    unsigned k = 0;
    for (char *part; (part = strsep(&text, ",")); k++) {
        char *colon = strchr(part, ':');
        if (k == FP3_VIEW_AXES || !colon)
            argp_error(state, "--box: found '%s', expected X0:X1,Y0:Y1,Z0:Z1", part);
        *colon = 0;
        page->box[0][k] = number(state, "--box", part);
        page->box[1][k] = number(state, "--box", colon + 1);
        if (page->box[0][k] > page->box[1][k])
            argp_error(state, "--box: found %s:%s, expected the smaller number first", part,
                       colon + 1);
    }
    page->box_axes = k;
}

static void see(struct argp_state *state, fp3_view_page *page, char *text) {
    unsigned k = 0;
    for (char *part; (part = strsep(&text, ",")); k++) {
        char *colon = strchr(part, ':');
        if (k == FP3_VIEW_AXES || !colon)
            argp_error(state, "--see: found '%s', expected X0:X1,Y0:Y1,Z0:Z1", part);
        *colon = 0;
        page->seen[k][0] = number(state, "--see", part);
        page->seen[k][1] = number(state, "--see", colon + 1);
        if (!(page->seen[k][0] < page->seen[k][1]))
            argp_error(state, "--see: found %s:%s, expected the smaller number first", part,
                       colon + 1);
    }
    page->seen_axes = k;
}

static void range(struct argp_state *state, fp3_view_options *o, char *text) {
    char *colon = strchr(text, ':');
    if (!colon)
        argp_error(state, "--range: found '%s', expected LEAST:MOST", text);
    *colon = 0;
    o->range[0] = number(state, "--range", text);
    o->range[1] = number(state, "--range", colon + 1);
    o->has_range = 1;
    if (!(o->range[0] < o->range[1]))
        argp_error(state, "--range: found %s:%s, expected the smaller number first", text,
                   colon + 1);
}

static int up(struct argp_state *state, const char *text) {
    if (strcmp(text, "y") != 0 && strcmp(text, "z") != 0)
        argp_error(state, "--up: found '%s', expected y or z", text);
    return text[0] - 'x';
}

/* ---- pictures ---- */

static void turn(struct argp_state *state, fp3_view_look *look, char *text) {
    char *colon = strchr(text, ':');
    if (!colon)
        argp_error(state, "--turn: found '%s', expected AZIMUTH:ELEVATION", text);
    *colon = 0;
    look->azimuth = number(state, "--turn", text);
    look->elevation = number(state, "--turn", colon + 1);
    if (look->elevation < -90 || look->elevation > 90)
        argp_error(state, "--turn: found an elevation of %s, expected -90 to 90", colon + 1);
}

/* ---- all ---- */

static void name_output(struct argp_state *state, fp3_view_options *o) {
    if (!o->recording)
        argp_error(state, "expected a recording");
    if (o->has_at && !o->png)
        argp_error(state, "--at: expected --png FILE, which shows that time");
    if (o->output || o->png || o->film)
        return;
    if (!strcmp(o->recording, "-"))
        argp_error(state, "expected --output FILE for a recording from the standard input");
    const char *slash = strrchr(o->recording, '/'), *dot = strrchr(o->recording, '.');
    const size_t length =
        dot && (!slash || dot > slash + 1) ? (size_t)(dot - o->recording) : strlen(o->recording);
    if (asprintf(&o->own_output, "%.*s.html", (int)length, o->recording) < 0)
        argp_failure(state, 1, 0, "out of memory");
    o->output = o->own_output;
}

static void take_range(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    range(state, o, text);
}

static void take_plane(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    plane(state, &o->page, text);
}

static void take_box(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    box(state, &o->page, text);
}

static void take_see(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    see(state, &o->page, text);
}

static void take_up(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    o->page.up = up(state, text);
}

static void take_at(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    o->at = number(state, "--at", text);
    o->has_at = 1;
}

static void take_turn(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    turn(state, &o->look, text);
}

static void take_rate(void *user, struct argp_state *state, char *text) {
    fp3_view_options *o = user;
    o->rate = strcmp(text, "real") == 0
                  ? 0
                  : (uint16_t)fp3_arguments_number(state, "--rate", text, 1, 1000);
}

static void end(void *user, struct argp_state *state) {
    fp3_view_options *o = user;
    name_output(state, o);
}

static const fp3_option table[] = {
    {"output", 'o', "FILE",
     "Write the page to FILE (default: the recording's name, ending in .html)",
     FP3_TEXT(fp3_view_options, output)},
    {"position", 0, "NAMES",
     "Where objects are: a vector, or one to three names with commas between them; object and time "
     "are names, too (default: the vector that has the unit of a length)",
     FP3_TEXT(fp3_view_options, wishes.position)},
    {"colour", 0, "NAME",
     "Colour objects by this value, or by the length of this vector (default: the speed, if it is "
     "known)",
     FP3_TEXT(fp3_view_options, wishes.colour)},
    {"range", 0, "LEAST:MOST",
     "Values of the first and the last colour (default: all values of the recording)",
     FP3_CALL(take_range)},
    {"size", 0, "RADIUS",
     "Draw objects as balls of this radius, in the unit of the position, or with the value of "
     "this name as radius (default: half the reach of `near`, if the recording has it)",
     FP3_TEXT(fp3_view_options, wishes.size)},
    {"observe", 0, "NAMES",
     "Other values of each object in the page, names with commas between them (default: all)",
     FP3_TEXT(fp3_view_options, wishes.observed)},
    {"every", 0, "N", "Take every N-th snapshot (default 1)",
     FP3_NUMBER(fp3_view_options, every, 1, UINT32_MAX)},
    {"plane", 0, "AXIS=VALUE",
     "Draw a wall where the position's x, y or z has this value; may be repeated",
     FP3_CALL(take_plane), .is_repeated = 1},
    {"box", 0, "X0:X1,Y0:Y1,Z0:Z1", "Draw the edges of a box", FP3_CALL(take_box)},
    {"see", 0, "X0:X1,Y0:Y1,Z0:Z1",
     "What is seen at first, of each axis of the position (default: all that moves)",
     FP3_CALL(take_see)},
    {"contacts", 0, NULL,
     "Of bodies: draw where they touch, with forces as lines; fp3 run --observe contacts records "
     "them",
     FP3_FLAG(fp3_view_options, page.has_contacts)},
    {"up", 0, "AXIS", "The axis of the position that points up, y or z (default y)",
     FP3_CALL(take_up)},
    {"title", 0, "TEXT", "The title (default: the model's name)",
     FP3_TEXT(fp3_view_options, page.title)},
    {"exact", 0, NULL,
     "Keep all 32 bits of each number, instead of 16 with an error that is printed",
     FP3_FLAG(fp3_view_options, page.is_exact)},
    {"png", 0, "FILE",
     "Draw a snapshot as a PNG, without a display; no page is written unless --output asks for it",
     FP3_TEXT(fp3_view_options, png)},
    {"film", 0, "FILE",
     "Draw all snapshots as an animated PNG (APNG), likewise; as a video if the name ends in .mp4, "
     "by ffmpeg",
     FP3_TEXT(fp3_view_options, film)},
    {"at", 0, "TIME",
     "The time of the snapshot of --png, or near it; a recording without times: its step (default: "
     "the last)",
     FP3_CALL(take_at)},
    {"width", 0, "PIXELS", "The width of --png and --film (default 1280)",
     FP3_NUMBER(fp3_view_options, look.width, 16, PIXELS_MOST)},
    {"height", 0, "PIXELS", "The height of --png and --film (default 720)",
     FP3_NUMBER(fp3_view_options, look.height, 16, PIXELS_MOST)},
    {"turn", 0, "AZIMUTH:ELEVATION",
     "The direction of view of --png and --film, in degrees around the axis that points up, and "
     "above the plane across it (default 31.5:20, as the page at first)",
     FP3_CALL(take_turn)},
    {"rate", 0, "N",
     "Snapshots a second of --film (default 30); real: as many as a second of the recording has",
     FP3_CALL(take_rate)},
    {0},
};

void fp3_view_options_parse(int argc, char **argv, fp3_view_options *o) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(fp3_view_options, recording, "recording"),
        .end = end,
        .forms = "RECORDING",
        .doc = "Writes a web page that shows what fp3 run --output recorded, moving: one file, "
               "which loads nothing.",
    };
    *o = (fp3_view_options){
        .every = 1, .rate = 30, .look = {1280, 720, 31.5, 20}, .page = {.up = 1}};
    fp3_arguments_parse(&command, argc, argv, o);
}

void fp3_view_options_free(fp3_view_options *o) { free(o->own_output); }
