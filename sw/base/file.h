/* file.h - whole files in and out. */
#ifndef FP3_FILE_H
#define FP3_FILE_H

#include <fp3/status.h>
#include <stddef.h>

/* *data is malloc'ed with a NUL after size bytes. Refuses directories and more than 64 MB. */
fp3_status fp3_file_read(const char *path, char **data, size_t *size, fp3_error *error);

/* Writes a temporary beside path and renames it, so that path holds all of data or what it held
 * before. A path that is not a regular file (a pipe, /dev/stdout) is written directly. */
fp3_status fp3_file_write(const char *path, const void *data, size_t size, fp3_error *error);

/* 1 if both paths name one existing file. */
int fp3_file_same(const char *one, const char *other);

#endif
