/* SPDX-License-Identifier: Apache-2.0 */
/* inks.h - the colours of pictures: those of the page in light colours (page/shaders.js). */
#ifndef FP3_VIEW_INKS_H
#define FP3_VIEW_INKS_H

#include "page.h"
#include "raster.h"

#define FP3_VIEW_SHARE 65535 /* all of a mixture */

static const fp3_view_ink fp3_view_ink_back = {238, 240, 244}, fp3_view_ink_line = {51, 61, 87};
static const fp3_view_ink fp3_view_ink_none = {128, 128, 128}, fp3_view_ink_joint = {191, 26, 20};

/* Of value `at`, which is snapshot * objects + object. */
fp3_view_ink fp3_view_ink_of(const fp3_view_page *page, size_t at);
/* With a share of b. */
fp3_view_ink fp3_view_ink_mix(fp3_view_ink a, fp3_view_ink b, uint32_t share);

#endif
