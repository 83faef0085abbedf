/* SPDX-License-Identifier: Apache-2.0 */
/* temporary.h - a folder of one process, .fp3-NAME.tmp, where new files are made before they get
 * their names.
 *
 *     fp3_temporary t;
 *     if (fp3_temporary_open("/data/.fp3-a.csv.tmp", &t)) ... errno says why
 *     int file = open("/data/.fp3-a.csv.tmp/new", O_CREAT | O_EXCL | O_NOFOLLOW | O_RDWR, 0666);
 *     ... rename("/data/.fp3-a.csv.tmp/new", "/data/a.csv");
 *     fp3_temporary_close(&t);
 *
 * The process holds a lock on its folder. The kernel releases the lock when the process ends,
 * however it ends. So a second process with the same folder is refused, and the next one finds out
 * that a folder was left behind, and takes it over.
 */
#ifndef FP3_TEMPORARY_H
#define FP3_TEMPORARY_H

/* The only names in such a folder; closing it removes both. */
#define FP3_TEMPORARY_NEW "new"
#define FP3_TEMPORARY_BEFORE "before"

#define FP3_TEMPORARY_EXTRA 9 /* bytes by which the folder's name is longer than the file's */

typedef struct {
    char *path; /* NULL: there is none */
    int folder; /* the open folder, with the lock */
} fp3_temporary;

/* <directory>/.fp3-<name>.tmp/<inside>, or the folder itself where inside is "". The caller frees
 * it; NULL: out of memory. real: <directory>/<name>, with a slash. */
char *fp3_temporary_path(const char *real, const char *inside);

/* Makes the folder, or takes over an empty or abandoned one of this user. 0, or -1 and errno:
 * EBUSY: another process has it; EEXIST: what is there is no folder of this user, or it cannot be
 * told whether somebody has it. Then *temporary is empty. */
int fp3_temporary_open(const char *path, fp3_temporary *temporary);
/* The same in a directory for files that get no name, by a name that this process never had before:
 * dlopen takes a path that it knows for the library that it has. Removes those that were left
 * behind there. */
int fp3_temporary_open_in(const char *directory, fp3_temporary *temporary);
/* Removes the folder. Leaves an empty one, which may be closed as well. */
void fp3_temporary_close(fp3_temporary *temporary);

/* For a signal handler of a command that ends: removes all folders of this process. */
void fp3_temporary_remove_all(void);

#endif
