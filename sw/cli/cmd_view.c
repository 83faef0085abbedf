/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_view.c - fp3 view: a recording as a page that plays it, and as pictures. */
#include "cli.h"
#include "files.h"
#include "view_draw.h"

#include "base/file.h"
#include "view/recording.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define MARK "Written by fp3 view."
#define MARK_WITHIN 200 /* bytes */

/* The default name may be that of another user's page. */
static fp3_status check_own(const fp3_view_options *o, fp3_error *error) {
    char begin[MARK_WITHIN + 1] = "";
    struct stat found;
    const int is_file = o->own_output && !stat(o->own_output, &found) && S_ISREG(found.st_mode);
    FILE *file = is_file ? fopen(o->own_output, "rb") : NULL;
    if (!file)
        return FP3_OK;
    const size_t size = fread(begin, 1, MARK_WITHIN, file);
    begin[size] = 0;
    fclose(file);
    return strstr(begin, MARK) ? FP3_OK
                               : fp3_fail(error, FP3_E_ARGUMENT,
                                          "%s exists, and is no page of fp3 view: name the page "
                                          "with --output",
                                          o->own_output);
}

static fp3_status check_files(const fp3_view_options *o, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "RECORDING", o->recording);
    fp3_files_write(&files, "--output", o->output);
    fp3_files_write(&files, "--png", o->png);
    fp3_files_write(&files, "--film", o->film);
    fp3_status status = fp3_files_check(&files, error);
    return status ? status : check_own(o, error);
}

/* How exact each column of the page is. */
static void print(const fp3_view_options *o, const fp3_view_recording *r,
                  const fp3_view_scale *scales, long bytes) {
    FILE *out = stdout;
    char size[40] = ""; /* of a pipe it is unknown */
    if (bytes >= 0)
        snprintf(size, sizeof size, ", %.2f MB", (double)bytes / 1e6);
    fp3_cli_line(out, "%s: %zu objects, %zu snapshots, position %s%s", o->output, r->objects,
                 r->snapshots, o->page.axes->name, size);
    for (size_t i = 0; i < r->column_count; i++)
        if (r->columns[i].values && scales[i].bound > 0)
            fp3_cli_line(out, "%-16s kept to +-%.2g%s%s", r->columns[i].name, scales[i].bound,
                         *r->columns[i].unit ? " " : "", r->columns[i].unit);
        else if (r->columns[i].values)
            fp3_cli_line(out, "%-16s kept exactly", r->columns[i].name);
}

static fp3_status write_page(fp3_view_options *o, const fp3_view_recording *r,
                             fp3_progress *progress, fp3_error *error) {
    fp3_view_scale *scales = calloc(r->column_count, sizeof *scales);
    fp3_output *output = NULL;
    fp3_status status = scales ? fp3_output_open(o->output, &output, error) : fp3_no_memory(error);
    long bytes = 0;
    if (!status)
        status = fp3_view_page_write(&o->page, fp3_output_stream(output), scales, error);
    if (!status) {
        bytes = ftell(fp3_output_stream(output));
        status = fp3_output_publish(output, error);
    }
    fp3_progress_pause(progress);
    if (!status)
        print(o, r, scales, bytes);
    fp3_progress_resume(progress);
    fp3_output_close(&output);
    free(scales);
    return status;
}

static fp3_status set_range(const fp3_view_options *o, fp3_view_fields *fields, fp3_error *error) {
    if (!o->has_range)
        return FP3_OK;
    if (fields->colour == FP3_VIEW_NO_COLUMN)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--range: nothing is coloured, expected --colour NAME");
    fields->list[fields->colour].least = o->range[0];
    fields->list[fields->colour].most = o->range[1];
    return FP3_OK;
}

static fp3_status view(fp3_view_options *o, fp3_progress *progress, fp3_error *error) {
    fp3_view_recording *r = NULL;
    fp3_view_axes axes;
    fp3_view_fields fields = {0};
    fp3_status status = fp3_view_open(o->recording, &r, error);
    if (!status)
        status = fp3_view_choose(r, &o->wishes, &axes, error);
    o->page.recording = r;
    o->page.axes = &axes;
    o->page.fields = &fields;
    if (!status)
        status = fp3_view_page_check(&o->page, error);
    if (!status) {
        fp3_progress_say(progress, "reading");
        status = fp3_view_load(r, o->every, error);
    }
    if (!status)
        status = fp3_view_fields_find(r, &axes, &fields, error);
    if (!status)
        status = set_range(o, &fields, error);
    if (!status)
        status = fp3_view_draw(o, progress, error);
    if (!status && o->output) {
        fp3_progress_say(progress, "writing");
        status = write_page(o, r, progress, error);
    }
    fp3_view_fields_free(&fields);
    fp3_view_close(&r);
    return status;
}

int fp3_cmd_view(int argc, char **argv) {
    fp3_view_options o;
    fp3_error error = {.text = ""};
    fp3_view_options_parse(argc, argv, &o);
    fp3_status status = check_files(&o, &error);
    if (!status) {
        fp3_progress *progress = fp3_progress_begin("view", o.recording);
        status = view(&o, progress, &error);
        fp3_progress_end(&progress);
    }
    fp3_view_options_free(&o);
    return fp3_cli_end("view", status, &error, NULL);
}
