/* split.h - whether a run may be split into parts. */
#ifndef FP3_OUTPUT_SPLIT_H
#define FP3_OUTPUT_SPLIT_H

#include "source.h"

/* Each part executes the program's first and last part, which must only prepare and complete values
 * (docs/architecture.md). What the compiler makes is like that. FP3_E_ARGUMENT: another program is not, as some steps
 * of its first object show, made at once and one by one. That they agree is no proof. */
fp3_status fp3_split_check(const fp3_source *source, fp3_error *error);

#endif
