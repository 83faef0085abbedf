/* SPDX-License-Identifier: Apache-2.0 */
/* drive.h - lanes through all steps of a run: visits, parts, those who fall asleep on the way. */
#ifndef FP3_DRIVE_H
#define FP3_DRIVE_H

#include "block.h"

typedef struct {
    const fp3_fast *fast;
    fp3_fast_worker *worker;
    const fp3_fast_run *run;
    fp3_fast_lanes *lanes;
    int is_watching; /* lanes are executed with their witness; else suspects are noted */
    /* Lanes that are through with the run: all of lanes. */
    void (*settle)(void *user, fp3_fast_lanes *lanes);
    void *user;
} fp3_drive;

/* Sets lanes->common from what is known of each lane, or from the objects' status. */
void fp3_drive_know(const fp3_fast_run *run, fp3_fast_lanes *lanes);

/* All rows and records that the first part reads are there. */
void fp3_drive_run(fp3_drive *drive);

#endif
