/* SPDX-License-Identifier: Apache-2.0 */
/* same.c - whether ranks that begin to share a world have the same one: by a hash of all that a
 * checkpoint has, and of the texts of the laws. All engines make the same bits of these. */
#include "fields.h"
#include "share.h"

#include <string.h>

static void add_list(uint64_t *hash, fp3_bodies *bodies, const fp3_kept_list *list) {
    const fp3_kept_part part = fp3_kept_elements(bodies, list);
    const char *elements = part.array ? *part.array : (const char *)bodies;
    const uint32_t rows = part.count ? *part.count : 1;
    fp3_words_hash(hash, &rows, sizeof rows);
    for (uint32_t i = 0; i < rows; i++)
        for (size_t f = 0; f < list->count; f++)
            fp3_words_hash(hash, elements + i * part.size + list->fields[f].at,
                           list->fields[f].is_byte ? 1 : fp3_field_size(&list->fields[f]));
}

static fp3_status make_hash(fp3_bodies *bodies, uint64_t *hash) {
    const fp3_status status = fp3_kept_tidy(bodies);
    const char *law;
    for (size_t i = 0; !status && i < fp3_kept_list_count; i++)
        if (fp3_list_is_of(&fp3_kept_lists[i], bodies->def.dimensions))
            add_list(hash, bodies, &fp3_kept_lists[i]);
    for (uint32_t i = 0; (law = fp3_laws_text(bodies->laws, bodies->def.dimensions, i)); i++)
        fp3_words_hash(hash, law, strlen(law) + 1);
    if (bodies->space)
        fp3_forms_forget(bodies);
    return status;
}

/* Every rank asks as often as all others. */
static int is_same(const fp3_ranks *ranks, uint64_t hash) {
    const int is_most = ranks->calls->most(ranks->world, hash) == hash,
              is_least = ranks->calls->most(ranks->world, ~hash) == ~hash;
    return !ranks->calls->most(ranks->world, !is_most || !is_least);
}

fp3_status fp3_share_begin(fp3_bodies *bodies, const fp3_ranks *ranks, uint64_t steps) {
    uint64_t hash = fp3_bodies_hash(bodies);
    fp3_words_hash(&hash, &steps, sizeof steps);
    fp3_status status = fp3_share_make(bodies, ranks);
    if (!status)
        status = make_hash(bodies, &hash);
    const uint64_t worst = ranks->calls->most(ranks->world, (uint64_t)status);
    if (status)
        return status;
    if (worst)
        return fp3_fail(bodies->error, (fp3_status)worst, "another rank is out of memory");
    return is_same(ranks, hash)
               ? FP3_OK
               : fp3_fail(bodies->error, FP3_E_ARGUMENT, "ranks have different worlds of bodies");
}
