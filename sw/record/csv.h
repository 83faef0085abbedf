/* SPDX-License-Identifier: Apache-2.0 */
/* csv.h - a recording as comma-separated values, RFC 4180: a row for each object of each snapshot.
 */
#ifndef FP3_OUTPUT_CSV_H
#define FP3_OUTPUT_CSV_H

#include "sink.h"

/* The subject must outlive the sink; the caller closes it. */
fp3_status fp3_csv_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error);

#endif
