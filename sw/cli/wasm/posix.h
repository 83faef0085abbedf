/* SPDX-License-Identifier: Apache-2.0 */
/* posix.h - what the headers of WASI lack of POSIX and of glibc. It stands in front of every file,
 * and includes none. */
#ifndef FP3_WASM_POSIX_H
#define FP3_WASM_POSIX_H

#define F_DUPFD_CLOEXEC 1030 /* no fcntl knows it: a stream cannot be opened as a file */
#define SYNC_FILE_RANGE_WRITE 0
#define secure_getenv getenv
#define CPU_COUNT(set) 1

typedef struct {
    int is_none;
} cpu_set_t;

static inline unsigned geteuid(void) { return 0; }
static inline int sync_file_range(int file, long long from, long long count, unsigned flags) {
    (void)file, (void)from, (void)count, (void)flags;
    return 0;
}

static inline int sched_getaffinity(int process, unsigned long size, cpu_set_t *set) {
    (void)process, (void)size, (void)set;
    return 0;
}

#endif
