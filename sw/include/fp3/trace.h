/* SPDX-License-Identifier: Apache-2.0 */
/* fp3/trace.h - shows what happened in a run of the hardware: a log of its pipeline, and where the
 * cycles went.
 *
 *     fp3_kanata *kanata = NULL;
 *     fp3_engine_def def = fp3_engine_default();
 *     if (fp3_kanata_open("run.kanata", def.config, image, &kanata, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     def.trace = fp3_kanata_trace, def.trace_user = kanata;
 *     // Open the engine "rtl" with def, run, then close the log (or drop it: fp3_kanata_free).
 *     status = fp3_kanata_close(&kanata, &error);
 *
 * The log is for the viewer Konata. It has one row for each instruction that a scheduler issues for
 * a context, as lane 0 sees it. docs/tracing.md describes the stages.
 *
 * Threads: a log belongs to the thread that runs its engine.
 * Experimental.
 */
#ifndef FP3_TRACE_H
#define FP3_TRACE_H

#include <fp3/engine.h>
#include <fp3/status.h>
#include <stdio.h>

FP3_API_BEGIN

typedef struct fp3_kanata fp3_kanata;

/* The most instructions that are recorded; with more, fp3_kanata_close fails. */
#define FP3_KANATA_LIMIT 2000000u

/* Begins a log. config is a configuration's name; path and image are copied. The file is begun
 * under another name. FP3_E_ARGUMENT: no such configuration, or path cannot be written.
 * FP3_E_SYSTEM: the disk is full. */
fp3_status fp3_kanata_open(const char *path, const char *config, const fp3_image *image,
                           fp3_kanata **kanata, fp3_error *error);

/* An fp3_trace_fn; the user pointer is the fp3_kanata. Lanes other than 0 are ignored.
 * fp3_kanata_close reports failures of this function. */
void fp3_kanata_trace(void *kanata, const fp3_traced *traced);

/* Writes the log to path. Always frees *kanata and sets it to NULL; if it is NULL already, nothing
 * is done. A failure leaves the file as it was. FP3_E_ARGUMENT: too many instructions, or path
 * cannot be written. FP3_E_MISMATCH: the log has an instruction that the configuration cannot
 * have. */
fp3_status fp3_kanata_close(fp3_kanata **kanata, fp3_error *error);

/* Frees *kanata, sets it to NULL and writes nothing. *kanata may be NULL already. */
void fp3_kanata_free(fp3_kanata **kanata);

/* Prints the counters of one scheduler as a table: the cycles by instruction or by cause of a
 * stall, as percentages that add up to 100.0, each with a bar; then the use of its adder and
 * multiplier. counter has FP3_COUNTER_COUNT numbers, as in fp3_stats. Rows with 0 cycles are left
 * out. */
void fp3_occupancy_print(FILE *out, uint32_t scheduler, const uint64_t *counter);

FP3_API_END

#endif
