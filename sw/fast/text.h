/* text.h - place.h and lanes.h as text. */
#ifndef FP3_TEXT_H
#define FP3_TEXT_H

extern const char fp3_text_place[], fp3_text_lanes[];

#endif
