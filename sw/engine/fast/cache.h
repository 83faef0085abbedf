/* SPDX-License-Identifier: Apache-2.0 */
/* cache.h - shared libraries that were compiled from a text. */
#ifndef FP3_CACHE_H
#define FP3_CACHE_H

#include <fp3/status.h>
#include <limits.h>
#include <stddef.h>

typedef struct {
    char directory[PATH_MAX]; /* "": none that can be used */
    char path[PATH_MAX];      /* of the entry for the text */
} fp3_cache;

/* Where the entry for a text belongs; the directory is made. FP3_E_ARGUMENT, FP3_E_SYSTEM: there is
 * no directory that is this user's alone; error says why. */
fp3_status fp3_cache_find(const char *text, fp3_cache *cache, fp3_error *error);
/* Whether the entry is there, this user's, whole, and of this text. */
int fp3_cache_has(const fp3_cache *cache, const char *text);
/* The text in an entry of these bytes, not ended by 0; NULL: it is none, or damaged. */
const char *fp3_cache_text(const char *data, size_t size, size_t *text_size);
/* Adds the text and a checksum to the library in file, which no other process knows. */
fp3_status fp3_cache_seal(const char *file, const char *text, fp3_error *error);
/* Seals it, and gives it the entry's name.
 * After a failure it is as if there were no cache. */
fp3_status fp3_cache_keep(const fp3_cache *cache, const char *file, const char *text,
                          fp3_error *error);

#endif
