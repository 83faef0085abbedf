/* SPDX-License-Identifier: Apache-2.0 */
/* kanata_log.h - the text of a Kanata log. */
#ifndef FP3_TRACE_KANATA_LOG_H
#define FP3_TRACE_KANATA_LOG_H

#include "machine/config.h"

#include <fp3/engine.h>
#include <stdio.h>

/* What is logged: instructions of lane 0, by the cycle of their issue. */
typedef struct {
    const fp3_config *config;
    const fp3_image *image; /* for the names of registers */
    const fp3_traced *rows;
    size_t count;
} fp3_kanata_rows;

#define FP3_KANATA_HEADER "Kanata\t0004\n" /* the first line of the file */

/* All behind it. What goes wrong with out itself is for the caller to find. */
fp3_status fp3_kanata_log(const fp3_kanata_rows *rows, FILE *out, fp3_error *error);

#endif
