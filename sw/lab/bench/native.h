/* SPDX-License-Identifier: Apache-2.0 */
/* native.h - C text that is compiled and loaded while a program runs. */
#ifndef FP3_BENCH_NATIVE_H
#define FP3_BENCH_NATIVE_H

#include <fp3/status.h>

typedef struct fp3_bench_native fp3_bench_native;

/* By fp3_cc with these flags (ended by NULL, 16 at most) and those that make a shared library.
 * FP3_E_SYSTEM: there is no compiler, or it refuses the text; it has said why on standard error.
 * The caller closes *native, which is NULL on failure. */
fp3_status fp3_bench_native_open(const char *text, const char *const *flags,
                                 fp3_bench_native **native, fp3_error *error);
/* Sets *native to NULL; that it was NULL before does no harm. */
void fp3_bench_native_close(fp3_bench_native **native);

/* A function that the text defines, into *function, a pointer to it. FP3_E_SYSTEM: there is none.
 */
fp3_status fp3_bench_native_find(const fp3_bench_native *native, const char *name, void *function,
                                 fp3_error *error);

#endif
