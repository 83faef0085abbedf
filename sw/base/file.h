/* SPDX-License-Identifier: Apache-2.0 */
/* file.h - whole files in and out.
 *
 * "-" is standard input and standard output. Whoever reads a file that this is about reads it here.
 */
#ifndef FP3_FILE_H
#define FP3_FILE_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdio.h>

/* *data is malloc'ed with a NUL after size bytes. Refuses directories, more than 64 MB, and a named
 * pipe that no process writes into within 10 seconds. */
fp3_status fp3_file_read(const char *path, char **data, size_t *size, fp3_error *error);

/* A stream for a file that is read bit by bit, of any size; the caller closes it. A directory is
 * refused by the first read. Named pipes as above. */
fp3_status fp3_file_open(const char *path, FILE **file, fp3_error *error);

/* Path holds all of data or what it held before (see below). */
fp3_status fp3_file_write(const char *path, const void *data, size_t size, fp3_error *error);

/* A file that is written bit by bit: into a temporary beside path (temporary.h), which publishing
 * renames, so that path holds all of it or what it held before. An existing file keeps its mode, a
 * link stays a link. What is not a regular file (a pipe, a device, standard output) is written
 * directly. FP3_E_ARGUMENT: also if another process is writing the file. */
typedef struct fp3_output fp3_output;
fp3_status fp3_output_open(const char *path, fp3_output **output, fp3_error *error);
/* The same for a regular file that is written again and again, each time from fp3_output_begin on:
 * what it held before stays as path.1. No other process can open it until it is closed.
 * FP3_E_ARGUMENT: also if path is no regular file. */
fp3_status fp3_output_open_again(const char *path, fp3_output **output, fp3_error *error);
fp3_status fp3_output_begin(fp3_output *output, fp3_error *error);
/* path.1; the caller frees it. NULL: out of memory. */
char *fp3_output_before(const char *path);
FILE *fp3_output_stream(const fp3_output *output);
/* The name of the temporary, for a library that opens files itself; NULL: there is none. */
const char *fp3_output_temporary(const fp3_output *output);
/* Has the system begin to write to the disk what a library wrote to the temporary so far, so that
 * publishing need not wait for all of it. Does not wait itself. */
void fp3_output_begin_writing(const fp3_output *output);
/* Flushes; the first time path gets its new content, and later ones add to it. What is written
 * again and again has no stream then until it begins. */
fp3_status fp3_output_publish(fp3_output *output, fp3_error *error);
/* What was never published leaves path as it was. Sets *output to NULL, which it may be already. */
void fp3_output_close(fp3_output **output);

#endif
