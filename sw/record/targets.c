/* SPDX-License-Identifier: Apache-2.0 */
/* targets.c - see targets.h. */
#include "targets.h"

#include "engine/common/inside.h"

#include <fp3/engine.h>
#include <math.h>
#include <stdlib.h>

#define BLOCK 64 /* objects that are asked at once */

static fp3_status read_ends(const fp3_source *source, double first, fp3_targets *targets,
                            fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t done = 0, now; !status && done < source->objects; done += now) {
        fp3_adaptive_object o[BLOCK];
        now = source->objects - done < BLOCK ? source->objects - done : BLOCK;
        status = fp3_adaptive_look_all(source->engine, source->first + done, now, o);
        for (size_t i = 0; !status && i < now; i++) {
            const double start = (double)o[i].t + (double)o[i].t_low;
            targets->until[done + i] = o[i].until;
            if (start > first)
                status = fp3_fail(error, FP3_E_ARGUMENT,
                                  "time %.17g is before the start of object %zu, %.9g", first,
                                  done + i, start);
        }
    }
    return status;
}

fp3_status fp3_targets_make(const fp3_source *source, const double *times, size_t count,
                            fp3_targets *targets, fp3_error *error) {
    *targets = (fp3_targets){0};
    if (!fp3_adaptive_is(source->program->image))
        return FP3_OK;
    if (!times || !count)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "adaptive steps have no number in common: expected times of snapshots");
    targets->count = count;
    targets->times = calloc(count, sizeof *targets->times);
    targets->until = calloc(source->objects + 1, sizeof *targets->until);
    targets->next = calloc(source->objects + 1, sizeof *targets->next);
    if (!targets->times || !targets->until || !targets->next)
        return fp3_no_memory(error);
    for (size_t i = 0; i < count; i++) {
        targets->times[i] = (float)times[i];
        if (!isfinite(targets->times[i]) || (i && !(targets->times[i] > targets->times[i - 1])))
            return fp3_fail(error, FP3_E_ARGUMENT, "time %.17g does not come after %.17g in FP32",
                            times[i], i ? times[i - 1] : 0.0);
    }
    return read_ends(source, targets->times[0], targets, error);
}

void fp3_targets_free(fp3_targets *targets) {
    free(targets->times);
    free(targets->until);
    free(targets->next);
    *targets = (fp3_targets){0};
}

fp3_status fp3_targets_set(const fp3_targets *targets, const fp3_source *source, size_t number) {
    const fp3_symbol *until =
        fp3_image_find(source->program->image, "until", FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
    const int is_shared = (FP3_CLASS(until->symbol_class) & FP3_CLASSES_SHARED) != 0;
    const size_t count = is_shared ? 1 : source->objects;
    for (size_t i = 0; i < count; i++)
        targets->next[i] = fminf((float)targets->times[number], targets->until[i]);
    fp3_status status =
        is_shared
            ? fp3_engine_write_shared(source->engine, until->index, 1, targets->next)
            : fp3_engine_write(source->engine, source->first, count, until->index, targets->next);
    if (status || !fp3_engine_config(source->engine)->sleep)
        return status;
    return fp3_engine_wake(source->engine, source->first, source->objects);
}
