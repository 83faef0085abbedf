/* SPDX-License-Identifier: Apache-2.0 */
/* linked.h - links that are kept, by the names of their relations. */
#ifndef FP3_BATCH_LINKED_H
#define FP3_BATCH_LINKED_H

#include <fp3/engine.h>
#include <fp3/image.h>

typedef struct fp3_linked {
    struct fp3_linked *next;
    char relation[FP3_NAME_SIZE];
    fp3_links links; /* a NaN in a column: the model's default */
    char *place;     /* where they were given, for messages: "cloth.scene:12"; NULL: nowhere */
} fp3_linked;

/* Copies links to the list, as the only links of the relation or behind earlier ones. place may be
 * NULL. FP3_E_ARGUMENT: an unknown name, or a field that is not finite; the list is then unchanged.
 */
fp3_status fp3_linked_put(fp3_linked **list, const char *relation, const fp3_links *links,
                          int is_more, const char *place, fp3_error *error);
/* Links of an object without stays[object] are gone. */
void fp3_linked_drop(fp3_linked *list, const uint8_t *stays);
/* The links of these pairs, of which either end may be `a`, are gone from the first of the list.
 * FP3_E_ARGUMENT: a pair has no link, or occurs twice; the list is then unchanged. */
fp3_status fp3_linked_remove(fp3_linked *list, const uint32_t *a, const uint32_t *b, size_t count,
                             fp3_error *error);
/* All of another list, or its first. */
fp3_status fp3_linked_copy(const fp3_linked *from, fp3_linked **list, fp3_error *error);
fp3_status fp3_linked_copy_one(const fp3_linked *from, fp3_linked **list, fp3_error *error);
/* NULL: there are none. */
const fp3_linked *fp3_linked_find(const fp3_linked *list, const char *relation);
/* Leaves NULL, which may be freed as well. */
void fp3_linked_free(fp3_linked **list);

#endif
