/* SPDX-License-Identifier: Apache-2.0 */
/* run_adaptive.h - steps that objects choose: options of fp3 run and fp3 compile, what a run
 * prints, who failed. */
#ifndef FP3_RUN_ADAPTIVE_H
#define FP3_RUN_ADAPTIVE_H

#include <argp.h>
#include <fp3/engine.h>
#include <fp3/program.h>
#include <fp3/recording.h>

/* What an option says; ends with 2 and a message where it cannot be. */
void fp3_run_adaptive_tolerance(fp3_program_def *def, struct argp_state *state, const char *text);
void fp3_run_adaptive_until(fp3_program_def *def, struct argp_state *state, const char *text);
/* Before the model is opened: it has no maxstep unless there is a value. */
fp3_status fp3_run_adaptive_maxstep(fp3_program_def *def, const fp3_params *params,
                                    fp3_error *error);
#define FP3_RUN_ADAPTIVE_TEXT_SIZE 256
/* A warning, or "": the tolerance says nothing of states that are all small beside what `absolute`
 * takes for their size. */
void fp3_run_adaptive_warning(const fp3_program *program, const fp3_params *params,
                              char text[FP3_RUN_ADAPTIVE_TEXT_SIZE]);
/* After the last option. */
void fp3_run_adaptive_check(fp3_program_def *def, int is_model, struct argp_state *state);

/* Of a run that is recorded: without --until the last time is where objects end. */
void fp3_run_adaptive_record(fp3_program_def *def, const fp3_recording_def *record,
                             struct argp_state *state);

/* Prints how many steps these objects made, all of the program image. */
fp3_status fp3_run_adaptive_print(fp3_engine *engine, const fp3_image *image, size_t first,
                                  size_t objects);
/* How many of them did not end, and of the first what is known. flags: of the run. */
fp3_status fp3_run_adaptive_failed(fp3_engine *engine, size_t first, size_t objects, uint32_t flags,
                                   size_t *failed, char text[FP3_ADAPTIVE_TEXT_SIZE]);

#endif
