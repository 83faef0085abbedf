/* SPDX-License-Identifier: Apache-2.0 */
/* files.h - the files that a command reads and writes, checked before it does anything else.
 *
 *     fp3_files files = {0};
 *     fp3_files_read(&files, "MODEL", o.model);
 *     fp3_files_write(&files, "--output", o.output);
 *     status = fp3_files_check(&files, &error);
 */
#ifndef FP3_CLI_FILES_H
#define FP3_CLI_FILES_H

#include <fp3/scene.h>
#include <fp3/status.h>
#include <stddef.h>

#define FP3_FILES_MOST 64 /* of one command; more are refused */

typedef struct {
    struct {
        const char *what, *path;
        int is_output;
        int is_kept; /* the output in front of this one keeps its old content here */
    } list[FP3_FILES_MOST];
    size_t count;
    int is_full;
} fp3_files;

/* what: the option, or the argument's name. A path of NULL is no file. */
void fp3_files_read(fp3_files *files, const char *what, const char *path);
void fp3_files_write(fp3_files *files, const char *what, const char *path);
/* All that a group of a scene is read from, besides the scene. */
void fp3_files_read_group(fp3_files *files, const fp3_scene_group *group);
/* Where the output that was added last keeps what it replaces. The two are not compared: while
 * another process publishes, and after it was killed, both may be links of one file. */
void fp3_files_keep(fp3_files *files, const char *what, const char *path);

/* FP3_E_ARGUMENT: an output cannot be written, or is a file that is read or written by another
 * name, whatever the links; or standard input is read twice. Standard output counts, too, if it
 * goes to a file. If an output is standard output ("-"), all that the command prints goes to
 * standard error from then on. */
fp3_status fp3_files_check(const fp3_files *files, fp3_error *error);

#endif
