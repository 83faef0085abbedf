/* SPDX-License-Identifier: Apache-2.0 */
/* inks.c - see inks.h. */
#include "inks.h"

#include <math.h>

#define STOPS 6

static uint8_t between(uint8_t from, uint8_t to, uint32_t share) {
    return (uint8_t)((from * (FP3_VIEW_SHARE - share) + to * share + FP3_VIEW_SHARE / 2) /
                     FP3_VIEW_SHARE);
}

fp3_view_ink fp3_view_ink_mix(fp3_view_ink a, fp3_view_ink b, uint32_t share) {
    return (fp3_view_ink){between(a.red, b.red, share), between(a.green, b.green, share),
                          between(a.blue, b.blue, share)};
}

fp3_view_ink fp3_view_ink_of(const fp3_view_page *page, size_t at) {
    static const fp3_view_ink plain = {36, 87, 199};
    static const fp3_view_ink stops[STOPS] = {{52, 41, 122},  {38, 98, 168},  {22, 146, 156},
                                              {74, 184, 112}, {170, 205, 66}, {250, 218, 72}};
    if (page->fields->colour == FP3_VIEW_NO_COLUMN)
        return plain;
    const fp3_view_field *field = &page->fields->list[page->fields->colour];
    const double value = fp3_view_field_value(page->recording, field, at);
    const double width = field->most - field->least;
    if (!isfinite(value))
        return fp3_view_ink_none;
    const double part = width > 0 ? fmin(1, fmax(0, (value - field->least) / width)) : 0.5;
    const uint32_t share = (uint32_t)floor(part * FP3_VIEW_SHARE * (STOPS - 1) + 0.5);
    const uint32_t stop = share / FP3_VIEW_SHARE < STOPS - 1 ? share / FP3_VIEW_SHARE : STOPS - 2;
    return fp3_view_ink_mix(stops[stop], stops[stop + 1], share - stop * FP3_VIEW_SHARE);
}
