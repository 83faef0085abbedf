/* SPDX-License-Identifier: Apache-2.0 */
/* scene.c - see scene.h. */
#include "scene.h"

#include "base/rows.h"

#include <stdio.h>
#include <stdlib.h>

void fp3_bodies_scene_close(fp3_bodies_scene **scene) {
    fp3_bodies_scene *s = *scene;
    *scene = NULL;
    if (!s)
        return;
    for (size_t i = 0; i < s->file_count; i++)
        free(s->files[i]);
    fp3_bodies_close(&s->bodies);
    free(s->files);
    free(s->entries);
    free(s->handles);
    free(s->joints);
    free(s->engine);
    free(s->path);
    free(s);
}

fp3_status fp3_bodies_grow(void **array, uint32_t *room, size_t size, size_t wanted,
                           fp3_error *error) {
    if (wanted <= *room)
        return FP3_OK;
    const size_t grown = wanted > 2u * *room ? wanted : 2u * *room;
    if (!fp3_rows_grow(array, grown, size))
        return fp3_no_memory(error);
    *room = (uint32_t)grown;
    return FP3_OK;
}

void fp3_bodies_scene_name(const fp3_bodies_scene *scene, size_t body,
                           char text[FP3_NAME_SIZE + 24]) {
    size_t i = 0;
    while (i + 1 < scene->entry_count && body >= scene->entries[i].first + scene->entries[i].count)
        i++;
    const fp3_bodies_entry *entry = &scene->entries[i];
    if (!*entry->name)
        snprintf(text, FP3_NAME_SIZE + 24, "body %zu", body);
    else if (entry->count == 1)
        snprintf(text, FP3_NAME_SIZE + 24, "%s", entry->name);
    else
        snprintf(text, FP3_NAME_SIZE + 24, "%s[%zu]", entry->name, body - entry->first);
}
