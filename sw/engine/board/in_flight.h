/* SPDX-License-Identifier: Apache-2.0 */
/* in_flight.h - which issued instruction is it that ends?
 *
 * A lane with contexts ends instructions in the order of issue, each of them once. Without contexts
 * all write a register, a short one may overtake a long one, and the writes of one register come in
 * the order of issue.
 */
#ifndef FP3_IN_FLIGHT_H
#define FP3_IN_FLIGHT_H

#include "fp3_rtl.h"
#include "machine/config.h"

typedef struct fp3_in_flight fp3_in_flight;

/* NULL: out of memory. */
fp3_in_flight *fp3_in_flight_make(const fp3_config *config);
/* May be NULL. */
void fp3_in_flight_free(fp3_in_flight *in_flight);

void fp3_in_flight_issue(fp3_in_flight *in_flight, const fp3_rtl_issue *issue);
/* Fills *traced, object as in *end. 0: nothing that was issued can end like this; that is
 * remembered. */
int fp3_in_flight_end(fp3_in_flight *in_flight, const fp3_rtl_end *end, fp3_traced *traced);
/* Whether some end had no issue. */
int fp3_in_flight_is_lost(const fp3_in_flight *in_flight);

#endif
