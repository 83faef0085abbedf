/* kanata_log.c - feeds the writer of Kanata logs with what a test says, without any hardware.
 *
 *     kanata_log SOURCE CONFIG LOG < EVENTS       assembles SOURCE, writes LOG; says why not
 *         t ISSUED ENDED SCHEDULER LANE CONTEXT PC OUTCOME OBJECT RESULT BITS FLAGS [WORD]
 *                            an instruction ends, of the program unless WORD is given; BITS, WORD
 * as hexadecimal n COUNT            so many end, issued in cycles 0, 1, .. kanata_log occupancy
 * COUNTER ...            the table of these counters
 */
#include <fp3/image.h>
#include <fp3/program.h>
#include <fp3/trace.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine/config.h"
#include "machine/visit.h"

/* The words that a scheduler has: the program, where there is a store with loads and stores. */
typedef struct {
    const fp3_image *image;
    fp3_visit *visit; /* NULL without a store */
} code;

static uint32_t word_at(const code *of, uint32_t pc) {
    if (of->visit)
        return pc < of->visit->code_count ? of->visit->code[pc] : UINT32_MAX;
    return pc < of->image->code_count ? of->image->code[pc] : UINT32_MAX;
}

/* 0, or 1: a line that is none of the above. */
static int feed(fp3_kanata *kanata, const code *of) {
    char line[256];
    while (fgets(line, sizeof line, stdin)) {
        fp3_traced t = {0};
        unsigned outcome = 0, count = 0;
        const int fields = sscanf(line, "t %" SCNu64 " %" SCNu64 " %u %u %u %u %u %u %d %x %u %x",
                                  &t.issued, &t.ended, &t.scheduler, &t.lane, &t.context, &t.pc,
                                  &outcome, &t.object, &t.has_result, &t.bits, &t.flags, &t.word);
        if (fields == 11 || fields == 12) {
            t.outcome = (fp3_outcome)outcome;
            t.word = fields == 12 ? t.word : word_at(of, t.pc);
            fp3_kanata_trace(kanata, &t);
        } else if (sscanf(line, "n %u", &count) == 1) {
            for (unsigned n = 0; n < count; n++)
                fp3_kanata_trace(kanata, &(fp3_traced){.issued = n, .ended = n + 1});
        } else {
            fprintf(stderr, "no event: %s", line);
            return 1;
        }
    }
    return 0;
}

static int write_kanata(const char *source, const char *config, const char *path) {
    fp3_error error = {.text = ""};
    fp3_program *program = NULL;
    fp3_kanata *kanata = NULL;
    code of = {0};
    const fp3_program_def def = fp3_program_default();
    const fp3_config *found = fp3_config_find(config);
    int failed = 0;
    fp3_status status = fp3_program_open(source, &def, &program, NULL, &error);
    if (!status && found && found->interleave)
        status = fp3_visit_make(program->image, &of.visit, &error);
    if (!status)
        status = fp3_kanata_open(path, config, program->image, &kanata, &error);
    of.image = status ? NULL : program->image;
    if (!status && (failed = feed(kanata, &of)))
        fp3_kanata_free(&kanata);
    fp3_program_close(&program); /* the writer has its own copy of the image */
    if (!status)
        status = fp3_kanata_close(&kanata, &error);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    fp3_visit_free(&of.visit);
    return failed ? 2 : (int)status;
}

int main(int argc, char **argv) {
    if (argc == 2 + FP3_COUNTER_COUNT && strcmp(argv[1], "occupancy") == 0) {
        uint64_t counter[FP3_COUNTER_COUNT];
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            counter[i] = strtoull(argv[2 + i], NULL, 10);
        fp3_occupancy_print(stdout, 0, counter);
        return 0;
    }
    if (argc == 4)
        return write_kanata(argv[1], argv[2], argv[3]);
    fprintf(stderr, "usage: %s SOURCE CONFIG LOG | occupancy COUNTER ...\n", argv[0]);
    return 2;
}
