/* SPDX-License-Identifier: Apache-2.0 */
/* suite.h - what a machine of FP32 does to integrators, beside what theory says that it does. */
#ifndef FP3_STRESS_SUITE_H
#define FP3_STRESS_SUITE_H

#include "trial.h"

#include <fp3/scene.h>

/* The suite's own equations by every integrator. FP3_E_ARGUMENT: no such section. */
fp3_status fp3_stress_suite(const fp3_stress_options *options, fp3_verdicts *verdicts,
                            fp3_error *error);
/* What applies to a model, by one integrator. */
fp3_status fp3_stress_model(const fp3_stress_options *options, const fp3_model *model,
                            const char *integrator, fp3_verdicts *verdicts, fp3_error *error);
/* How near its limits a scene comes in its steps, at each eighth of them: the springs and
 * dampers of objects that see each other, and the growth of a small error. FP3_E_PROGRAM: it has
 * what no limit is known of. */
fp3_status fp3_stress_scene(const fp3_stress_options *options, const fp3_scene *scene,
                            fp3_verdicts *verdicts, fp3_error *error);

#endif
