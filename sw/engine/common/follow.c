/* SPDX-License-Identifier: Apache-2.0 */
/* follow.c - see follow.h. */
#include "follow.h"

#include "near_few.h"
#include "remember.h"

#include <stdlib.h>

fp3_status fp3_lists_follow(fp3_lists *lists, uint32_t objects, uint32_t seekers,
                            const uint32_t *const *words, const uint32_t *row, size_t stride,
                            const fp3_crew *crew, int *is_new, fp3_error *error) {
    fp3_status status = FP3_OK;
    *is_new = 0;
    for (uint32_t i = 0; !status && i < lists->shape.list_count; i++) {
        fp3_list *list = &lists->lists[i];
        fp3_where_they_are now = {.row = row,
                                  .order = row && lists->living ? lists->living->who : lists->order,
                                  .lives = !row && lists->living ? lists->living->is : NULL,
                                  .stride = stride,
                                  .objects = objects,
                                  .dimensions = list->near.dimensions,
                                  .crew = crew};
        uint32_t *begin = NULL, *other = NULL, *field = NULL;
        for (uint32_t k = 0; list->is_near && k < FP3_NEAR_COLUMNS; k++) {
            if (!fp3_near_has(&list->near, k))
                continue;
            now.position[k] = words[list->near.regs[k]];
            now.theirs[k] = list->kind ? words[list->near.theirs[k]] : NULL;
        }
        if (list->is_near && list->near.radius)
            now.radius = words[list->near.radius - 1];
        if (list->is_near && list->kind && list->near.their_radius)
            now.their_radius = words[list->near.their_radius - 1];
        if (list->own < list->objects) { /* behind them stand objects of other kinds */
            now.own = list->own;
            now.from = list->first;
            now.objects = list->end;
        }
        if (!list->kind && !list->fields) /* pairs that remember do so on both sides */
            now.own = !now.own || seekers < now.own ? seekers : now.own;
        if (!list->is_near || !fp3_near_is_stale(&list->near, &now))
            continue;
        status = (fp3_near_are_few(&now) ? fp3_near_make_few
                                         : fp3_near_make)(&list->near, &now, &begin, &other, error);
        if (!status && list->fields)
            status = fp3_list_merge(list, &now, &begin, &other, &field, error);
        if (status && list->fields) { /* what is remembered stays */
            free(begin);
            free(other);
            fp3_near_close(&list->near);
            break;
        }
        free(list->begin);
        free(list->other);
        free(list->field);
        list->begin = begin;
        list->other = other;
        list->field = field;
        *is_new = 1;
        if (status) /* the list is none: the next run makes it, wherever objects are */
            fp3_near_close(&list->near);
    }
    return status;
}
