/* SPDX-License-Identifier: Apache-2.0 */
/* run_bodies.h - fp3 run of a scene of rigid bodies. */
#ifndef FP3_CLI_RUN_BODIES_H
#define FP3_CLI_RUN_BODIES_H

#include "run_options.h"

/* Whether the file is such a scene. */
int fp3_run_is_bodies(const char *scene);
/* FP3_E_ARGUMENT: also an option that says nothing of bodies; the message says why. */
fp3_status fp3_run_bodies(fp3_run_options *options, fp3_error *error);

#endif
