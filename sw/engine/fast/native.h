/* SPDX-License-Identifier: Apache-2.0 */
/* native.h - the C of a program, compiled once and kept in a cache.
 *
 * The cache is the directory FP3_CACHE_DIR, or fp3 in XDG_CACHE_HOME, or .cache/fp3 at home;
 * without one a program is compiled anew by each process. An entry is a shared library with the
 * text that it was compiled from and a checksum behind it, written beside its name and renamed: two
 * processes may make it at the same time, and one that is damaged or has another text is made
 * again. A directory is not used where another user can write to it or to one above it, and neither
 * is an entry that is not this user's. FP3_CC names the compiler; the default is cc.
 */
#ifndef FP3_NATIVE_H
#define FP3_NATIVE_H

#include "place.h"
#include "plan.h"

/* So many steps, the first of them before + 1; parts: FP3_BEGINS, FP3_ENDS. */
typedef void fp3_fast_stretch(const fp3_fast_place *place, unsigned parts, unsigned steps,
                              unsigned before);

/* Vectors first .. end - 1 of the lists make a phase. */
typedef void fp3_fast_around_fn(const fp3_fast_around *around, unsigned phase, unsigned first,
                                unsigned end);

typedef struct {
    void *library;
    fp3_fast_stretch *stretch;  /* of a program without neighbours */
    fp3_fast_around_fn *around; /* of one with neighbours */
    char no_cache[112]; /* why what was compiled now is not kept; "": it is, or nothing was */
} fp3_fast_native;

/* kind: of the processor, for -march; may_compile: 0: only what is in the cache. The caller closes
 * *native. FP3_E_SYSTEM: there is no native code, and error says why; *native is {0}. */
fp3_status fp3_fast_native_open(const fp3_fast_plan *plan, const char *kind, int may_compile,
                                fp3_fast_native *native, fp3_error *error);

/* ---- a file that is shipped: an entry of the cache under a name of the caller's ---- */

typedef struct {
    char name[16];
} fp3_fast_kind;

/* Compiles what fp3_fast_native_open would load. FP3_E_SYSTEM. */
fp3_status fp3_fast_native_write(const fp3_fast_plan *plan, const char *path, const char *kind,
                                 fp3_error *error);
/* The kind of processor that a file is for. FP3_E_SYSTEM: it cannot be read. FP3_E_ARGUMENT: it is
 * damaged, no such file, or made by another version. */
fp3_status fp3_fast_native_kind(const char *path, fp3_fast_kind *kind, fp3_error *error);
/* FP3_E_ARGUMENT: also if it is of another program. The caller closes *native. */
fp3_status fp3_fast_native_load(const fp3_fast_plan *plan, const char *path, const char *kind,
                                fp3_fast_native *native, fp3_error *error);
/* Leaves {0}, which may be closed as well. */
void fp3_fast_native_close(fp3_fast_native *native);

#endif
