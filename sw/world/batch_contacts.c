/* SPDX-License-Identifier: Apache-2.0 */
/* batch_contacts.c - contacts of a batch that begin and end, and what pairs remember. */
#include "spots.h"

#include "base/host.h"
#include "compiler/start.h"
#include "engine/common/inside.h"
#include "machine/format.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Pairs of handles: side by side, by numbers. */
typedef struct {
    uint64_t *a, *b;
    size_t count;
} handles;

/* What was told of a name. */
struct fp3_met {
    struct fp3_met *next;
    char *of;
    handles now, began, ended;
};

static void free_handles(handles *h) {
    free(h->a);
    free(h->b);
    *h = (handles){0};
}

static int open_handles(handles *h, size_t most) {
    *h = (handles){malloc((most + 1) * sizeof *h->a), malloc((most + 1) * sizeof *h->b), 0};
    return h->a && h->b;
}

static void put(handles *h, const handles *from, size_t i) {
    h->a[h->count] = from->a[i];
    h->b[h->count++] = from->b[i];
}

void fp3_met_free(struct fp3_met **list) {
    while (*list) {
        struct fp3_met *next = (*list)->next;
        free_handles(&(*list)->now);
        free_handles(&(*list)->began);
        free_handles(&(*list)->ended);
        free((*list)->of);
        free(*list);
        *list = next;
    }
}

static struct fp3_met *find(fp3_batch *b, const char *of) {
    struct fp3_met *one = b->met;
    while (one && strcmp(one->of, of) != 0)
        one = one->next;
    if (one)
        return one;
    one = calloc(1, sizeof *one);
    char *name = strdup(of);
    if (!one || !name) {
        free(one);
        free(name);
        return NULL;
    }
    one->of = name;
    one->next = b->met;
    return b->met = one;
}

/* By numbers, and of those with the same numbers who was born first. */
static int order(const handles *x, size_t i, const handles *y, size_t k) {
    const uint32_t xa = (uint32_t)x->a[i], ya = (uint32_t)y->a[k], xb = (uint32_t)x->b[i],
                   yb = (uint32_t)y->b[k];
    if (xa != ya || xb != yb)
        return xa < ya || (xa == ya && xb < yb) ? -1 : 1;
    if (x->a[i] != y->a[k])
        return x->a[i] < y->a[k] ? -1 : 1;
    return (x->b[i] > y->b[k]) - (x->b[i] < y->b[k]);
}

/* Both are in order. */
static void compare(struct fp3_met *m, const handles *before, const handles *now) {
    for (size_t i = 0, k = 0; i < before->count || k < now->count;) {
        const int way = i == before->count ? 1 : k == now->count ? -1 : order(before, i, now, k);
        if (way < 0)
            put(&m->ended, before, i);
        else if (way > 0)
            put(&m->began, now, k);
        i += way <= 0;
        k += way >= 0;
    }
}

static fp3_status meet(fp3_batch *b, struct fp3_met *m, double distance) {
    uint32_t *first, *second;
    handles now = {0};
    size_t count;
    fp3_status status = fp3_spots_pairs(b, m->of, distance, &first, &second, &count);
    free_handles(&m->began);
    free_handles(&m->ended);
    if (!status && !(open_handles(&now, count) && open_handles(&m->began, count) &&
                     open_handles(&m->ended, m->now.count)))
        status = fp3_no_memory(b->error);
    for (size_t i = 0; !status && i < count; i++) {
        now.a[i] = fp3_births_handle(&b->births, first[i]);
        now.b[i] = fp3_births_handle(&b->births, second[i]);
    }
    if (!status) {
        now.count = count;
        compare(m, &m->now, &now);
        free_handles(&m->now);
        m->now = now;
    } else {
        free_handles(&now);
    }
    free(first);
    free(second);
    return status;
}

fp3_status fp3_batch_contacts(fp3_batch *b, const char *of, double distance,
                              fp3_contacts *contacts) {
    FP3_HOST;
    *contacts = (fp3_contacts){0};
    if (!b)
        return FP3_E_ARGUMENT;
    struct fp3_met *m = find(b, of);
    const fp3_status status = m ? meet(b, m, distance) : fp3_no_memory(b->error);
    if (!status)
        *contacts = (fp3_contacts){.began = m->began.count,
                                   .ended = m->ended.count,
                                   .began_a = m->began.a,
                                   .began_b = m->began.b,
                                   .ended_a = m->ended.a,
                                   .ended_b = m->ended.b};
    return status;
}

/* ---- what pairs remember ---- */

/* The list of a relation of near objects, and which of an entry's words the field is. */
static fp3_status find_field(const fp3_batch *b, const char *relation, const char *field,
                             const fp3_list **list, uint32_t *word) {
    const fp3_model *model = b->compiled ? fp3_start_model(b->compiled) : NULL;
    const fp3_lists *lists = &fp3_engine_layout(b->engine)->groups[0].lists;
    const fp3_symbol *s = fp3_image_find(b->image, relation, FP3_CLASSES_OBJECT);
    *list = NULL;
    for (uint32_t i = 0; model && i < model->relation_count; i++) {
        const fp3_relation *r = &model->relations[i];
        if (strcmp(r->name, relation) != 0 || r->kind != FP3_NEAR)
            continue;
        for (uint32_t k = 0; s && k < r->field_count; k++)
            if (strcmp(model->fields[r->first_field + k].name, field) == 0)
                for (uint32_t n = 0; n < lists->shape.list_count; n++)
                    if (lists->lists[n].reg == s->index) {
                        *list = &lists->lists[n];
                        /* All fields of near objects are in their entries. */
                        *word = k * (lists->lists[n].fields / r->field_count);
                    }
    }
    return *list ? FP3_OK
                 : fp3_fail(b->error, FP3_E_ARGUMENT,
                            "no relation '%s' of near objects remembers '%s'", relation, field);
}

static float value_of(const fp3_batch *b, const fp3_list *list, const fp3_remembered *all,
                      uint32_t word, uint32_t a, uint32_t other) {
    for (uint32_t e = all->begin[a]; e < all->begin[a + 1]; e++)
        if (all->other[e] == other)
            return fp3_format_value(fp3_engine_config(b->engine),
                                    all->field[(size_t)e * list->fields + word]);
    return 0;
}

fp3_status fp3_batch_remembered(fp3_batch *b, const char *relation, const char *field,
                                const uint32_t *a, const uint32_t *other, size_t count,
                                float *values) {
    FP3_HOST;
    const fp3_list *list;
    uint32_t word = 0;
    fp3_remembered all = {0};
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = find_field(b, relation, field, &list, &word);
    if (!status)
        status = fp3_batch_settle_reach(b); /* the engine knows from here on that they are near */
    for (size_t i = 0; !status && i < count; i++)
        if (a[i] >= b->objects || other[i] >= b->objects)
            status = fp3_fail(b->error, FP3_E_ARGUMENT,
                              "pair %zu is of objects %" PRIu32 " and %" PRIu32
                              ": there are %zu objects",
                              i, a[i], other[i], b->objects);
    if (!status)
        status =
            fp3_list_save(list, fp3_engine_rows(b->engine), (uint32_t)b->objects, &all, b->error);
    for (size_t i = 0; !status && i < count; i++)
        values[i] = value_of(b, list, &all, word, a[i], other[i]);
    fp3_remembered_free(&all);
    return status;
}
