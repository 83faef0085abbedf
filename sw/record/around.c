/* SPDX-License-Identifier: Apache-2.0 */
/* around.c - see around.h. */
#include "around.h"

#include "engine/common/inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int has_entry(const fp3_entries *of, uint32_t object, uint32_t wanted) {
    for (uint32_t i = of->begin[object]; i < of->begin[object + 1]; i++)
        if (of->other[i] == wanted)
            return 1;
    return 0;
}

/* Mostly both ends have the link in their lists: the lower number tells it. */
static int is_told(const fp3_entries *of, uint32_t object, uint32_t other) {
    return object < other || !has_entry(of, other, object);
}

/* Also those of objects that do not live. */
static fp3_status find_links(const fp3_list *list, fp3_around_list *found, fp3_error *error) {
    const fp3_entries all = fp3_list_given(list);
    const size_t entries = all.begin[list->objects];
    found->pairs = malloc((2 * entries + 1) * sizeof *found->pairs);
    if (!found->pairs)
        return fp3_no_memory(error);
    for (uint32_t object = 0; object < list->objects; object++)
        for (uint32_t i = all.begin[object]; i < all.begin[object + 1]; i++)
            if (is_told(&all, object, all.other[i])) {
                found->pairs[2 * found->count] = object;
                found->pairs[2 * found->count++ + 1] = all.other[i];
            }
    return FP3_OK;
}

static void find_reach(const fp3_list *list, const fp3_image *image, fp3_around_list *found) {
    size_t used = 0;
    found->reach = list->near.radius ? 0 : list->near.reach; /* radii are in the record */
    for (uint32_t k = 0; k < list->near.dimensions; k++) {
        const char *name = fp3_image_name(image, list->near.regs[k]);
        used += (size_t)snprintf(found->position + used, sizeof found->position - used, "%s%s",
                                 k ? "," : "", name ? name : "?");
    }
}

fp3_status fp3_around_find(const fp3_source *source, fp3_around *around, fp3_error *error) {
    const fp3_image *image = source->program->image;
    const fp3_lists *lists = &fp3_engine_layout(source->engine)->groups[source->group].lists;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < lists->shape.list_count; i++) {
        const fp3_list *list = &lists->lists[i];
        const char *name = fp3_image_name(image, list->reg);
        fp3_around_list *found = &around->lists[around->count];
        if (!name || !list->is_there || list->is_all || list->kind) /* of its own objects */
            continue;
        around->count++;
        snprintf(found->name, sizeof found->name, "%s", name);
        if (list->is_near)
            find_reach(list, image, found);
        else
            status = find_links(list, found, error);
    }
    return status;
}

void fp3_around_free(fp3_around *around) {
    for (size_t i = 0; i < around->count; i++)
        free(around->lists[i].pairs);
    memset(around, 0, sizeof *around);
}
