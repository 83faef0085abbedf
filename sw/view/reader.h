/* SPDX-License-Identifier: Apache-2.0 */
/* reader.h - what a form of file provides to recording.c. */
#ifndef FP3_VIEW_READER_H
#define FP3_VIEW_READER_H

#include "recorded.h"

struct fp3_view_reader {
    fp3_status (*load)(fp3_view_recording *r, uint64_t every, fp3_error *error);
    void (*close)(fp3_view_reader *reader);
};

/* Each sets r->reader, after a failure too if there is something to close. */
fp3_status fp3_view_csv_open(fp3_view_recording *r, fp3_error *error);
fp3_status fp3_view_hdf5_open(fp3_view_recording *r, fp3_error *error);

#endif
