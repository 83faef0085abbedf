/* SPDX-License-Identifier: Apache-2.0 */
/* video.h - a film as MP4, by ffmpeg. */
#ifndef FP3_VIEW_VIDEO_H
#define FP3_VIEW_VIDEO_H

#include <fp3/status.h>
#include <stdint.h>
#include <stdio.h>

/* Whether the name is that of a video: it ends in .mp4, in upper or lower case. */
int fp3_view_video_is_named(const char *path);
/* Before anything is drawn. FP3_E_ARGUMENT: the width or the height is odd; FP3_E_SYSTEM: ffmpeg is
 * not installed, or does not start. */
fp3_status fp3_view_video_check(uint32_t width, uint32_t height, fp3_error *error);
/* Of an animated PNG, from its beginning, into a file that exists. FP3_E_SYSTEM: ffmpeg fails;
 * error has what it said. */
fp3_status fp3_view_video_make(FILE *film, const char *path, fp3_error *error);

#endif
