/* SPDX-License-Identifier: Apache-2.0 */
/* progress.h - on a terminal, one line that says that a command goes on, and how far it is. */
#ifndef FP3_CLI_PROGRESS_H
#define FP3_CLI_PROGRESS_H

/* Every call takes NULL, and does nothing. */
typedef struct fp3_progress fp3_progress;

/* NULL unless standard error is a terminal, and if somebody types the input there (NULL: none may).
 * The line appears there after two seconds; a thread of its own keeps it fresh, so that whoever
 * works need not say anything. */
fp3_progress *fp3_progress_begin(const char *command, const char *input);
/* Removes the line. Sets *progress to NULL, which it may be already. */
void fp3_progress_end(fp3_progress **progress);

/* What is done now; its share is unknown at first. */
__attribute__((format(printf, 2, 3))) void fp3_progress_say(fp3_progress *progress,
                                                            const char *format, ...);
/* How much of it is done, 0 to 1: an fp3_progress_fn of fp3/engine.h. */
void fp3_progress_share(void *progress, double share);

/* Between the two the terminal is free for other lines. */
void fp3_progress_pause(fp3_progress *progress);
void fp3_progress_resume(fp3_progress *progress);

#endif
