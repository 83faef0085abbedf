/* SPDX-License-Identifier: Apache-2.0 */
/* linked.c - see linked.h. */
#include "linked.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const fp3_linked *fp3_linked_find(const fp3_linked *list, const char *relation) {
    while (list && strcmp(list->relation, relation) != 0)
        list = list->next;
    return list;
}

static void free_links(const fp3_links *links) {
    for (size_t i = 0; i < links->field_count; i++) {
        free((void *)links->names[i]);
        free((void *)links->fields[i]);
    }
    free((void *)links->names);
    free((void *)links->fields);
    free((void *)links->a);
    free((void *)links->b);
}

void fp3_linked_free(fp3_linked **list) {
    while (*list) {
        fp3_linked *next = (*list)->next;
        free_links(&(*list)->links);
        free((*list)->place);
        free(*list);
        *list = next;
    }
}

/* ---- putting ---- */

static size_t column_of(const fp3_links *links, const char *name) {
    size_t i = 0;
    while (i < links->field_count && strcmp(links->names[i], name) != 0)
        i++;
    return i;
}

static fp3_status check(const char *relation, const fp3_links *links, fp3_error *error) {
    if (!fp3_name_valid(relation))
        return fp3_fail(error, FP3_E_ARGUMENT, "'%s' is no name", relation);
    for (size_t i = 0; i < links->field_count; i++) {
        if (!fp3_name_valid(links->names[i]) || column_of(links, links->names[i]) < i)
            return fp3_fail(
                error, FP3_E_ARGUMENT, "links of '%s': field '%s' %s", relation, links->names[i],
                column_of(links, links->names[i]) < i ? "has two columns" : "is no name");
        for (size_t k = 0; k < links->count; k++)
            if (!isfinite((float)links->fields[i][k]))
                return fp3_fail(error, FP3_E_ARGUMENT,
                                "links of '%s': link %zu has %s = %g, expected a finite number",
                                relation, k, links->names[i], links->fields[i][k]);
    }
    return FP3_OK;
}

/* Two sets of objects, one behind the other. */
static uint32_t *joined(const uint32_t *first, size_t count, const uint32_t *more, size_t added) {
    uint32_t *made = malloc((count + added + 1) * sizeof *made);
    if (made && count)
        memcpy(made, first, count * sizeof *made);
    if (made && added)
        memcpy(made + count, more, added * sizeof *made);
    return made;
}

/* Likewise; those of a set without the column are NaN. */
static double *joined_fields(const fp3_links *first, const fp3_links *more, const char *name) {
    const size_t of = column_of(first, name), in = column_of(more, name);
    double *made = malloc((first->count + more->count + 1) * sizeof *made);
    for (size_t i = 0; made && i < first->count; i++)
        made[i] = of < first->field_count ? first->fields[of][i] : NAN;
    for (size_t i = 0; made && i < more->count; i++)
        made[first->count + i] = in < more->field_count ? more->fields[in][i] : NAN;
    return made;
}

static int join(const fp3_links *first, const fp3_links *more, fp3_links *made) {
    const size_t most = first->field_count + more->field_count;
    const char **names = calloc(most + 1, sizeof *names);
    const double **fields = calloc(most + 1, sizeof *fields);
    *made = (fp3_links){.count = first->count + more->count,
                        .a = joined(first->a, first->count, more->a, more->count),
                        .b = joined(first->b, first->count, more->b, more->count),
                        .names = names,
                        .fields = fields};
    int is_good = names && fields && made->a && made->b;
    for (size_t i = 0; is_good && i < most; i++) {
        const char *name =
            i < first->field_count ? first->names[i] : more->names[i - first->field_count];
        if (column_of(made, name) < made->field_count)
            continue;
        names[made->field_count] = strdup(name);
        fields[made->field_count] = joined_fields(first, more, name);
        is_good = names[made->field_count] && fields[made->field_count];
        made->field_count++;
    }
    return is_good;
}

/* Copies links that need no check: those of a list may have NaN. */
static fp3_status put(fp3_linked **list, const char *relation, const fp3_links *links, int is_more,
                      const char *place, fp3_error *error) {
    static const fp3_links none = {0};
    fp3_linked *to = (fp3_linked *)fp3_linked_find(*list, relation);
    fp3_links made;
    char *copy = place ? strdup(place) : NULL;
    fp3_linked *one = to ? to : calloc(1, sizeof *one);
    if (!join(to && is_more ? &to->links : &none, links, &made) || !one || (place && !copy)) {
        free_links(&made);
        free(copy);
        if (!to)
            free(one);
        return fp3_no_memory(error);
    }
    free_links(&one->links);
    free(one->place);
    one->links = made;
    one->place = copy;
    if (to)
        return FP3_OK;
    strcpy(one->relation, relation);
    while (*list)
        list = &(*list)->next;
    *list = one;
    return FP3_OK;
}

fp3_status fp3_linked_put(fp3_linked **list, const char *relation, const fp3_links *links,
                          int is_more, const char *place, fp3_error *error) {
    const fp3_status status = check(relation, links, error);
    return status ? status : put(list, relation, links, is_more, place, error);
}

fp3_status fp3_linked_copy_one(const fp3_linked *from, fp3_linked **list, fp3_error *error) {
    return put(list, from->relation, &from->links, 0, from->place, error);
}

fp3_status fp3_linked_copy(const fp3_linked *from, fp3_linked **list, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (; !status && from; from = from->next)
        status = fp3_linked_copy_one(from, list, error);
    return status;
}

/* Link i takes the place `to`. */
static void move(fp3_links *links, size_t i, size_t to) {
    ((uint32_t *)links->a)[to] = links->a[i];
    ((uint32_t *)links->b)[to] = links->b[i];
    for (size_t k = 0; k < links->field_count; k++)
        ((double *)links->fields[k])[to] = links->fields[k][i];
}

void fp3_linked_drop(fp3_linked *list, const uint8_t *stays) {
    for (; list; list = list->next) {
        fp3_links *links = &list->links;
        size_t count = 0;
        for (size_t i = 0; i < links->count; i++)
            if (stays[links->a[i]] && stays[links->b[i]])
                move(links, i, count++);
        links->count = count;
    }
}

/* ---- single links ---- */

/* The ends in either order. */
static uint64_t pair_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static int compare_pairs(const void *one, const void *other) {
    const uint64_t a = *(const uint64_t *)one, b = *(const uint64_t *)other;
    return (a > b) - (a < b);
}

/* The place of a link's pair in the list of those that go; count: it stays. */
static size_t find_pair(const fp3_links *links, size_t i, const uint64_t *pairs, size_t count) {
    const uint64_t wanted = pair_of(links->a[i], links->b[i]);
    const uint64_t *found = bsearch(&wanted, pairs, count, sizeof *pairs, compare_pairs);
    return found ? (size_t)(found - pairs) : count;
}

static fp3_status refuse_pair(const fp3_linked *l, uint64_t pair, const char *why,
                              fp3_error *error) {
    return fp3_fail(error, FP3_E_ARGUMENT, "links of '%s': objects %" PRIu32 " and %" PRIu32 " %s",
                    l->relation, (uint32_t)(pair >> 32), (uint32_t)pair, why);
}

/* Each of the pairs is one, and has a link. has_link: count + 1 zeros. */
static fp3_status check_gone(const fp3_linked *l, const uint64_t *pairs, size_t count,
                             uint8_t *has_link, fp3_error *error) {
    for (size_t k = 1; k < count; k++)
        if (pairs[k] == pairs[k - 1])
            return refuse_pair(l, pairs[k], "are given twice", error);
    for (size_t i = 0; i < l->links.count; i++)
        has_link[find_pair(&l->links, i, pairs, count)] = 1;
    for (size_t k = 0; k < count; k++)
        if (!has_link[k])
            return refuse_pair(l, pairs[k], "have none", error);
    return FP3_OK;
}

fp3_status fp3_linked_remove(fp3_linked *list, const uint32_t *a, const uint32_t *b, size_t count,
                             fp3_error *error) {
    fp3_links *links = &list->links;
    uint64_t *pairs = malloc((count + 1) * sizeof *pairs);
    uint8_t *has_link = calloc(count + 1, 1);
    fp3_status status = pairs && has_link ? FP3_OK : fp3_no_memory(error);
    for (size_t k = 0; !status && k < count; k++)
        pairs[k] = pair_of(a[k], b[k]);
    if (!status) {
        qsort(pairs, count, sizeof *pairs, compare_pairs);
        status = check_gone(list, pairs, count, has_link, error);
    }
    size_t stay = 0;
    for (size_t i = 0; !status && i < links->count; i++)
        if (find_pair(links, i, pairs, count) == count)
            move(links, i, stay++);
    links->count = status ? links->count : stay;
    free(pairs);
    free(has_link);
    return status;
}
