/* SPDX-License-Identifier: Apache-2.0 */
/* library.h - finds and loads plugins, which libfp3 does without until they are asked for. */
#ifndef FP3_LIBRARY_H
#define FP3_LIBRARY_H

#include <fp3/status.h>

/* A library of this file name; what: what it is, for the message that there is none. If the
 * environment variable FP3_RTL_DIR is set, looks in that directory only. Otherwise looks in fp3/
 * beside this library, in ../lib/fp3/ beside the program, and where `make install` puts it. *path,
 * unless path is NULL: where it was found; the caller frees it. FP3_E_SYSTEM: there is none, or it
 * cannot be loaded. */
fp3_status fp3_library_load(const char *name, const char *what, void **library, char **path,
                            fp3_error *error);
/* Whether a library of this file name is in one of these places. */
int fp3_library_is_there(const char *name);
/* NULL: it has no such symbol. */
const void *fp3_library_symbol(void *library, const char *symbol);
/* NULL does no harm. */
void fp3_library_unload(void *library);

#endif
