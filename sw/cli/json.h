/* SPDX-License-Identifier: Apache-2.0 */
/* json.h - what commands write as JSON. */
#ifndef FP3_CLI_JSON_H
#define FP3_CLI_JSON_H

#include <fp3/status.h>
#include <jansson.h>

/* Writes numbers with so many digits, and drops the reference to root, which is NULL if there was
 * no memory. */
fp3_status fp3_json_write(const char *path, json_t *root, int digits, fp3_error *error);

/* null for what JSON has no number for. */
json_t *fp3_json_number(double x);

#endif
