/* SPDX-License-Identifier: Apache-2.0 */
/* files.c - see files.h. */
#include "files.h"

#include "base/path.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void add(fp3_files *files, const char *what, const char *path, int is_output) {
    if (!path)
        return;
    if (files->count == FP3_FILES_MOST) {
        files->is_full = 1;
        return;
    }
    files->list[files->count].what = what;
    files->list[files->count].path = path;
    files->list[files->count++].is_output = is_output;
}

void fp3_files_read(fp3_files *files, const char *what, const char *path) {
    add(files, what, path, 0);
}

void fp3_files_write(fp3_files *files, const char *what, const char *path) {
    add(files, what, path, 1);
}

void fp3_files_read_group(fp3_files *files, const fp3_scene_group *group) {
    fp3_files_read(files, "program", group->path);
    fp3_files_read(files, "integrator", group->integrator_file);
    fp3_files_read(files, "params", group->params_file);
    for (size_t k = 0; k < group->file_count; k++)
        fp3_files_read(files, "points or links", group->files[k]);
}

void fp3_files_keep(fp3_files *files, const char *what, const char *path) {
    add(files, what, path, 1);
    if (path && !files->is_full)
        files->list[files->count - 1].is_kept = 1;
}

static int stream_of(const fp3_files *files, size_t i) {
    return fp3_path_stream(files->list[i].path, files->list[i].is_output);
}

/* A device may be written by two; what is read twice is read from its beginning. */
static int are_one(const fp3_files *files, const fp3_path_id *id, size_t i, size_t j) {
    const int one = stream_of(files, i), other = stream_of(files, j);
    if (!files->list[i].is_output && !files->list[j].is_output)
        return one == STDIN_FILENO && other == STDIN_FILENO;
    if (files->list[i].is_output && files->list[j].is_output && one == other && one >= 0)
        return 1;
    return fp3_path_same(&id[i], &id[j]) &&
           (!id[i].mode || S_ISREG(id[i].mode) || S_ISFIFO(id[i].mode));
}

static int is_on_the_way(const fp3_files *files, const fp3_path_id *id, size_t out, size_t other) {
    return files->list[out].is_output &&
           fp3_path_is_temporary_of(files->list[out].path, &id[other]);
}

static int collide(const fp3_files *files, const fp3_path_id *id, size_t i, size_t j) {
    if (files->list[j].is_kept && i + 1 == j)
        return 0;
    return are_one(files, id, i, j) || is_on_the_way(files, id, i, j) ||
           is_on_the_way(files, id, j, i);
}

enum { SHOWN = 200 };

/* "--output m.s" */
static const char *shown(const fp3_files *files, size_t i, char text[SHOWN]) {
    if (files->list[i].what)
        snprintf(text, SHOWN, "%s %s", files->list[i].what, files->list[i].path);
    else
        snprintf(text, SHOWN, "standard output");
    return text;
}

static fp3_status refuse(const fp3_files *files, size_t i, size_t j, fp3_error *error) {
    char one[SHOWN], other[SHOWN];
    const size_t in = files->list[i].is_output ? j : i, out = files->list[i].is_output ? i : j;
    if (!files->list[out].is_output)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s and %s: standard input can be read once",
                        files->list[i].what, files->list[j].what);
    if (files->list[in].is_output)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s and %s are one file", shown(files, i, one),
                        shown(files, j, other));
    return fp3_fail(error, FP3_E_ARGUMENT, "%s would overwrite %s", shown(files, out, one),
                    shown(files, in, other));
}

/* Data go there, or what the command prints; the second has no name. */
static int add_standard_output(fp3_files *files) {
    struct stat found;
    for (size_t i = 0; i < files->count; i++)
        if (files->list[i].is_output && stream_of(files, i) == STDOUT_FILENO)
            return 1;
    if (!fstat(STDOUT_FILENO, &found) && S_ISREG(found.st_mode))
        fp3_files_write(files, NULL, "-");
    return 0;
}

/* Standard output has data: what is printed goes to standard error. */
static fp3_status give_up_standard_output(fp3_error *error) {
#ifdef __GLIBC__
    (void)error;
    stdout = stderr; /* a variable: printf follows it, file descriptor 1 stays */
    return FP3_OK;
#else
    return fp3_fail(error, FP3_E_ARGUMENT, "-: this system cannot print beside data: name a file");
#endif
}

fp3_status fp3_files_check(const fp3_files *files, fp3_error *error) {
    fp3_files all = *files;
    fp3_path_id id[FP3_FILES_MOST];
    int is_known[FP3_FILES_MOST] = {0};
    const int has_data = add_standard_output(&all);
    fp3_status status =
        all.is_full ? fp3_fail(error, FP3_E_ARGUMENT, "more than %d files", FP3_FILES_MOST - 1)
                    : FP3_OK;
    for (size_t i = 0; !status && i < all.count; i++) {
        if (all.list[i].is_output)
            status = fp3_path_check_output(all.list[i].path, error);
        is_known[i] = !fp3_path_identify(all.list[i].path, all.list[i].is_output, &id[i]);
    }
    for (size_t i = 0; !status && i < all.count; i++)
        for (size_t j = 0; !status && is_known[i] && j < i; j++)
            if (is_known[j] && collide(&all, id, j, i))
                status = refuse(&all, j, i, error);
    return !status && has_data ? give_up_standard_output(error) : status;
}
