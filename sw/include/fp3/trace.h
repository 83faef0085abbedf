/* fp3/trace.h - what happened in a run of the hardware, for a reader: a log of its pipeline, and
 * where the cycles went.
 *
 *     fp3_kanata *kanata = NULL;
 *     fp3_engine_def def = fp3_engine_default();
 *     if (fp3_kanata_open("run.kanata", def.config, image, &kanata, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     def.trace = fp3_kanata_trace, def.trace_user = kanata;
 *     // Open the engine "rtl" with def, run, then close the log; fp3_kanata_free drops it instead.
 *     status = fp3_kanata_close(&kanata, &error);
 *
 * The log is for the viewer Konata: one row for each instruction that a scheduler issues for a
 * context, seen from lane 0. docs/tracing.md has the stages.
 *
 * Threads: a log is of the thread that runs its engine.
 * Experimental.
 */
#ifndef FP3_TRACE_H
#define FP3_TRACE_H

#include <fp3/engine.h>
#include <fp3/status.h>
#include <stdio.h>

FP3_API_BEGIN

typedef struct fp3_kanata fp3_kanata;

/* More instructions than these are not recorded, and fp3_kanata_close says so. */
#define FP3_KANATA_LIMIT 2000000u

/* config is a configuration's name; path and image are copied. Nothing is written yet.
 * FP3_E_ARGUMENT: no such configuration. */
fp3_status fp3_kanata_open(const char *path, const char *config, const fp3_image *image,
                           fp3_kanata **kanata, fp3_error *error);

/* An fp3_trace_fn; the user pointer is the fp3_kanata. Other lanes than lane 0 are ignored. What goes
 * wrong is told by fp3_kanata_close. */
void fp3_kanata_trace(void *kanata, const fp3_traced *traced);

/* Writes the log to path, and frees *kanata in any case (*kanata may be NULL: nothing is done).
 * After a failure the file is what it was. FP3_E_ARGUMENT: too many instructions, or path cannot be
 * written; FP3_E_MISMATCH: an instruction that the configuration cannot have. */
fp3_status fp3_kanata_close(fp3_kanata **kanata, fp3_error *error);

/* Frees it and writes nothing. That *kanata was NULL before does no harm. */
void fp3_kanata_free(fp3_kanata **kanata);

/* The counters of one scheduler as a table: its cycles by what was issued and by why nothing was, in
 * per cent that add up to 100.0, with a bar each; and how busy its adder and multiplier were. counter
 * has FP3_COUNTER_COUNT numbers, as in fp3_stats. Rows of 0 cycles are left out. */
void fp3_occupancy_print(FILE *out, uint32_t scheduler, const uint64_t *counter);

FP3_API_END

#endif
