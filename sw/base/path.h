/* SPDX-License-Identifier: Apache-2.0 */
/* path.h - which file a path is, and whether it can be written, before anything is read or written.
 */
#ifndef FP3_PATH_H
#define FP3_PATH_H

#include <fp3/status.h>
#include <limits.h>
#include <sys/stat.h>

/* The process's own stream of this name ("-", "/dev/stdout" and so on), or -1. Opened by name, a
 * stream that is redirected to a file would begin at the start of the file again, or replace it. */
int fp3_path_stream(const char *path, int is_output);

/* The path behind all links, also of a file that does not exist yet in a directory that does; the
 * caller frees it. NULL: errno says why. */
char *fp3_path_resolve(const char *path);

/* A name in a file, from where that file is; the caller frees it. NULL: out of memory. */
char *fp3_path_beside(const char *file, const char *name);

/* Two paths with equal ids are one file: device and inode of a file, or of the directory of a file
 * that does not exist yet, with its name. */
typedef struct {
    dev_t device;
    ino_t inode;
    mode_t mode; /* 0: it does not exist */
    char name[NAME_MAX + 1];
} fp3_path_id;
/* 0, or -1 if there is no such file and no directory for it. */
int fp3_path_identify(const char *path, int is_output, fp3_path_id *id);
int fp3_path_same(const fp3_path_id *a, const fp3_path_id *b);
/* Whether writing the file `output` makes or removes the file of id on the way: it is in its
 * temporary (temporary.h). */
int fp3_path_is_temporary_of(const char *output, const fp3_path_id *id);

/* FP3_E_ARGUMENT: a file cannot be written there; error says why, beginning with path. Nothing is
 * opened or changed. */
fp3_status fp3_path_check_output(const char *path, fp3_error *error);

/* Whether a directory is behind no other user's door: it and all directories above it belong to
 * this user or root, and no other user may write to them, except where users can only remove their
 * own files (the sticky bit). real: the directory behind all links. FP3_E_ARGUMENT: it is not, or
 * there is none; error says which. */
fp3_status fp3_path_check_private(const char *path, char real[PATH_MAX], fp3_error *error);

/* "path: what: why" with the reason that errno has: a missing or forbidden file is the caller's
 * mistake, FP3_E_ARGUMENT; a failing device is not, FP3_E_SYSTEM. */
fp3_status fp3_path_fail(fp3_error *error, const char *path, const char *what);

#endif
