/* SPDX-License-Identifier: Apache-2.0 */
/* sections.h - the parts of the suite. Each adds its verdicts. */
#ifndef FP3_STRESS_SECTIONS_H
#define FP3_STRESS_SECTIONS_H

#include "trial.h"

/* Of one integrator. */
fp3_status fp3_section_stability(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_steps(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_events(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_drift(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_reversal(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_chance(const fp3_trial *trial, fp3_error *error);
/* Of the machine: once. */
fp3_status fp3_section_stagnation(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_subnormal(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_failures(const fp3_trial *trial, fp3_error *error);
fp3_status fp3_section_chaos(const fp3_trial *trial, fp3_error *error);

#endif
