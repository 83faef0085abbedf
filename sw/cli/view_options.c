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

enum {
    KEY_POSITION = 256,
    KEY_COLOUR,
    KEY_RANGE,
    KEY_SIZE,
    KEY_OBSERVE,
    KEY_EVERY,
    KEY_PLANE,
    KEY_BOX,
    KEY_UP,
    KEY_TITLE,
    KEY_EXACT,
    KEY_PNG,
    KEY_FILM,
    KEY_AT,
    KEY_WIDTH,
    KEY_HEIGHT,
    KEY_TURN,
    KEY_RATE
};

static const struct argp_option table[] = {
    {"output", 'o', "FILE", 0,
     "Write the page to FILE (default: the recording's name, ending in .html)", 0},
    {"position", KEY_POSITION, "NAMES", 0,
     "Where objects are: a vector, or one to three names with commas between them; object and time "
     "are names, too (default: the vector that has the unit of a length)",
     0},
    {"colour", KEY_COLOUR, "NAME", 0,
     "Colour objects by this value, or by the length of this vector (default: the speed, if it is "
     "known)",
     0},
    {"range", KEY_RANGE, "LEAST:MOST", 0,
     "Values of the first and the last colour (default: all values of the recording)", 0},
    {"size", KEY_SIZE, "RADIUS", 0,
     "Draw objects as balls of this radius, in the unit of the position, or with the value of "
     "this name as radius (default: half the reach of `near`, if the recording has it)",
     0},
    {"observe", KEY_OBSERVE, "NAMES", 0,
     "Other values of each object in the page, names with commas between them (default: all)", 0},
    {"every", KEY_EVERY, "N", 0, "Take every N-th snapshot (default 1)", 0},
    {"plane", KEY_PLANE, "AXIS=VALUE", 0,
     "Draw a wall where the position's x, y or z has this value; may be repeated", 0},
    {"box", KEY_BOX, "X0:X1,Y0:Y1,Z0:Z1", 0, "Draw the edges of a box", 0},
    {"up", KEY_UP, "AXIS", 0, "The axis of the position that points up, y or z (default y)", 0},
    {"title", KEY_TITLE, "TEXT", 0, "The title (default: the model's name)", 0},
    {"exact", KEY_EXACT, 0, 0,
     "Keep all 32 bits of each number, instead of 16 with an error that is printed", 0},
    {"png", KEY_PNG, "FILE", 0,
     "Draw a snapshot as a PNG, without a display; no page is written unless --output asks for it",
     0},
    {"film", KEY_FILM, "FILE", 0,
     "Draw all snapshots as an animated PNG (APNG), likewise; as a video if the name ends in .mp4, "
     "by ffmpeg",
     0},
    {"at", KEY_AT, "TIME", 0,
     "The time of the snapshot of --png, or near it; a recording without times: its step (default: "
     "the last)",
     0},
    {"width", KEY_WIDTH, "PIXELS", 0, "The width of --png and --film (default 1280)", 0},
    {"height", KEY_HEIGHT, "PIXELS", 0, "The height of --png and --film (default 720)", 0},
    {"turn", KEY_TURN, "AZIMUTH:ELEVATION", 0,
     "The direction of view of --png and --film, in degrees around the axis that points up, and "
     "above the plane across it (default 31.5:20, as the page at first)",
     0},
    {"rate", KEY_RATE, "N", 0,
     "Snapshots a second of --film (default 30); real: as many as a second of the recording has",
     0},
    {0},
};

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

/* 0: the key is no picture's. */
static int parse_picture(int key, char *text, struct argp_state *state, fp3_view_options *o) {
    switch (key) {
    case KEY_PNG:
        o->png = text;
        return 1;
    case KEY_FILM:
        o->film = text;
        return 1;
    case KEY_AT:
        o->at = number(state, "--at", text);
        o->has_at = 1;
        return 1;
    case KEY_WIDTH:
        o->look.width = (uint32_t)fp3_arguments_number(state, "--width", text, 16, PIXELS_MOST);
        return 1;
    case KEY_HEIGHT:
        o->look.height = (uint32_t)fp3_arguments_number(state, "--height", text, 16, PIXELS_MOST);
        return 1;
    case KEY_TURN:
        turn(state, &o->look, text);
        return 1;
    case KEY_RATE:
        o->rate = strcmp(text, "real") == 0
                      ? 0
                      : (uint16_t)fp3_arguments_number(state, "--rate", text, 1, 1000);
        return 1;
    default:
        return 0;
    }
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

static error_t parse(int key, char *text, struct argp_state *state) {
    fp3_view_options *o = state->input;
    switch (key) {
    case 'o':
        o->output = text;
        break;
    case KEY_POSITION:
        o->wishes.position = text;
        break;
    case KEY_COLOUR:
        o->wishes.colour = text;
        break;
    case KEY_RANGE:
        range(state, o, text);
        break;
    case KEY_SIZE:
        o->wishes.size = text;
        break;
    case KEY_OBSERVE:
        o->wishes.observed = text;
        break;
    case KEY_EVERY:
        o->every = fp3_arguments_number(state, "--every", text, 1, UINT32_MAX);
        break;
    case KEY_PLANE:
        plane(state, &o->page, text);
        break;
    case KEY_BOX:
        box(state, &o->page, text);
        break;
    case KEY_UP:
        o->page.up = up(state, text);
        break;
    case KEY_TITLE:
        o->page.title = text;
        break;
    case KEY_EXACT:
        o->page.is_exact = 1;
        break;
    case ARGP_KEY_ARG:
        if (o->recording)
            argp_error(state, "found '%s', expected one recording", text);
        o->recording = text;
        break;
    case ARGP_KEY_END:
        name_output(state, o);
        break;
    default:
        return parse_picture(key, text, state, o) ? 0 : ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void fp3_view_options_parse(int argc, char **argv, fp3_view_options *o) {
    static const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "RECORDING",
        .doc = "Writes a web page that shows what fp3 run --output recorded, moving: one file, "
               "which loads nothing.",
    };
    *o = (fp3_view_options){
        .every = 1, .rate = 30, .look = {1280, 720, 31.5, 20}, .page = {.up = 1}};
    fp3_arguments_parse(&argp, argc, argv, o);
}

void fp3_view_options_free(fp3_view_options *o) { free(o->own_output); }
