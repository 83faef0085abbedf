/* SPDX-License-Identifier: Apache-2.0 */
/* text.h - the files of page/, as texts that end with 0. */
#ifndef FP3_VIEW_TEXT_H
#define FP3_VIEW_TEXT_H

extern const char fp3_view_text_head[], fp3_view_text_style[], fp3_view_text_body[];
extern const char fp3_view_text_data[], fp3_view_text_camera[], fp3_view_text_shaders[],
    fp3_view_text_bodies[], fp3_view_text_scene[], fp3_view_text_plot[], fp3_view_text_app[];

#endif
