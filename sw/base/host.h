/* SPDX-License-Identifier: Apache-2.0 */
/* host.h - the thread of a caller, with the locale and the arithmetic that the library counts on.
 *
 * A host may write 0,5 for 0.5, round upwards, or flush small numbers to zero (as one does that is
 * linked with -ffast-math). A call that computes, reads or writes numbers begins with FP3_HOST:
 * until it returns, the thread has the locale "C" and the arithmetic that C begins with; then the
 * caller's again.
 */
#ifndef FP3_HOST_H
#define FP3_HOST_H

#include "fpu.h"

#include <fenv.h>
#include <langinfo.h>
#include <locale.h>
#include <string.h>

typedef struct {
    locale_t c, locale; /* "C", and the caller's; 0: the caller's has the point of "C" */
    fenv_t arithmetic;
    int has_arithmetic; /* 0: the caller's is that of C */
} fp3_host;

/* To change either takes a microsecond, so a mode that is right already is left alone: checking
 * costs a few ns. */
static inline fp3_host fp3_host_enter(void) {
    fp3_host host = {.locale = (locale_t)0};
    host.has_arithmetic = (fp3_fpu_get() & FP3_FPU_MODES) != FP3_FPU_OF_C ||
                          fegetround() != FE_TONEAREST; /* that of the x87, which printf asks */
    if (strcmp(nl_langinfo(RADIXCHAR), ".") != 0) {
        host.c = newlocale(LC_ALL_MASK, "C", (locale_t)0); /* built in: cannot fail */
        host.locale = uselocale(host.c);
    }
    if (host.has_arithmetic) {
        fegetenv(&host.arithmetic);
        fesetenv(FE_DFL_ENV);
    }
    return host;
}

static inline void fp3_host_leave(const fp3_host *host) {
    if (host->has_arithmetic)
        fesetenv(&host->arithmetic);
    if (!host->c)
        return;
    uselocale(host->locale);
    freelocale(host->c);
}

#define FP3_HOST                                                                                   \
    __attribute__((cleanup(fp3_host_leave), unused)) const fp3_host fp3_host_of_call =             \
        fp3_host_enter()

#endif
