/* SPDX-License-Identifier: Apache-2.0 */
/* view_draw.h - the pictures of fp3 view. */
#ifndef FP3_CLI_VIEW_DRAW_H
#define FP3_CLI_VIEW_DRAW_H

#include "progress.h"
#include "view_options.h"

/* Writes --png and --film, where they are asked for; the recording is loaded. FP3_E_ARGUMENT: there
 * is no snapshot at that time. */
fp3_status fp3_view_draw(const fp3_view_options *o, fp3_progress *progress, fp3_error *error);

#endif
