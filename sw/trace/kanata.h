/* kanata.h - the pipeline, instruction by instruction, as a log for the viewer Konata.
 *
 *     fp3_kanata *kanata = NULL;
 *     if (fp3_kanata_open("run.kanata", def.config, image, &kanata, &error))
 *         return ...;
 *     def.issue = fp3_kanata_issue, def.issue_user = kanata;
 *     def.retire = fp3_kanata_retire, def.retire_user = kanata;
 *     ... open the engine, run ...
 *     status = fp3_kanata_close(&kanata, &error);    or, to give up: fp3_kanata_free(&kanata);
 *
 * Of the engine "rtl". One Kanata instruction for each instruction that a unit issues for a
 * context, seen from lane 0; docs/tracing.md has the stages.
 */
#ifndef FP3_KANATA_H
#define FP3_KANATA_H

#include <fp3/engine.h>

typedef struct fp3_kanata fp3_kanata;

/* More than these are not recorded, and fp3_kanata_close says so. */
#define FP3_KANATA_LIMIT 2000000u

/* config is a configuration's name; both strings and the image are copied. Nothing is written yet.
 * FP3_E_ARGUMENT: no such configuration. */
fp3_status fp3_kanata_open(const char *path, const char *config, const fp3_image *image,
                           fp3_kanata **kanata, fp3_error *error);

/* An fp3_issue_fn and an fp3_retire_fn; the user pointer is the fp3_kanata. What goes wrong in them
 * is told by fp3_kanata_close. Retirements of other lanes than lane 0 of each unit are ignored. */
void fp3_kanata_issue(void *kanata, const fp3_issue *issue);
void fp3_kanata_retire(void *kanata, const fp3_retirement *retirement);

/* Writes the whole log to path, and frees *kanata in any case (*kanata may be NULL: nothing is
 * done). After a failure the file is what it was. FP3_E_ARGUMENT: too many instructions, or path
 * cannot be written; FP3_E_MISMATCH: a result that no issued instruction explains. */
fp3_status fp3_kanata_close(fp3_kanata **kanata, fp3_error *error);

/* Frees it and writes nothing. That *kanata was NULL before does no harm. */
void fp3_kanata_free(fp3_kanata **kanata);

#endif
