/* kanata_log.c - feeds the writer of Kanata logs with what a test says, without any hardware.
 *
 *     kanata_log SOURCE CONFIG LOG < EVENTS       assembles SOURCE, writes LOG; says why not
 *         i CYCLE UNIT CONTEXT PC [WORD]     an instruction issues, of the program unless WORD is given
 *         r CYCLE UNIT LANE CONTEXT OBJECT REGISTER BITS FLAGS    one retires; BITS as hexadecimal
 *         n COUNT                            so many issue, in cycles 0, 1, ..
 *     kanata_log occupancy COUNTER ...            the table of these counters
 */
#include "trace/kanata.c"
#include "trace/occupancy.c"

static fp3_assembly *assemble(const char *path) {
    fp3_error error;
    char *text;
    size_t size;
    fp3_assembly *assembly = NULL;
    if (fp3_file_read(path, &text, &size, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return NULL;
    }
    if (fp3_assemble(text, size, path, &assembly, &error)) {
        fprintf(stderr, "%s\n", error.text);
        fp3_assembly_free(&assembly);
    }
    free(text);
    return assembly;
}

static uint32_t word_at(const fp3_kanata *kanata, const fp3_visit *visit, uint32_t pc) {
    const int is_composed = kanata->config->interleave;
    const uint32_t count = is_composed ? visit->code_count : kanata->image->code_count;
    const uint32_t *code = is_composed ? visit->code : kanata->image->code;
    return pc < count ? code[pc] : UINT32_MAX;
}

/* 0, or 1: a line that is none of the above. */
static int feed(fp3_kanata *kanata, const fp3_visit *visit) {
    char line[256];
    while (fgets(line, sizeof line, stdin)) {
        fp3_issue i = {0};
        fp3_retirement r = {0};
        unsigned count = 0;
        const int fields = sscanf(line, "i %" SCNu64 " %u %u %u %x", &i.cycle, &i.scheduler,
                                  &i.context, &i.pc, &i.word);
        if (fields == 4 || fields == 5) {
            i.word = fields == 5 ? i.word : word_at(kanata, visit, i.pc);
            fp3_kanata_issue(kanata, &i);
        } else if (sscanf(line, "r %" SCNu64 " %u %u %u %u %u %x %u", &r.cycle, &r.scheduler,
                          &r.lane, &r.context, &r.object, &r.reg, &r.bits, &r.flags) == 8) {
            fp3_kanata_retire(kanata, &r);
        } else if (sscanf(line, "n %u", &count) == 1) {
            for (unsigned n = 0; n < count; n++)
                fp3_kanata_issue(kanata, &(fp3_issue){.cycle = n});
        } else {
            fprintf(stderr, "no event: %s", line);
            return 1;
        }
    }
    return 0;
}

static int write_kanata(const char *source, const char *config, const char *path) {
    fp3_error error = {""};
    fp3_assembly *assembly = assemble(source);
    if (!assembly)
        return 2;
    fp3_visit *visit = NULL;
    fp3_kanata *kanata = NULL;
    fp3_status status = fp3_visit_make(assembly->image, &visit, &error);
    if (!status)
        status = fp3_kanata_open(path, config, assembly->image, &kanata, &error);
    fp3_assembly_free(&assembly); /* the writer has its own copy of the image */
    int failed = 0;
    if (!status && (failed = feed(kanata, visit)))
        fp3_kanata_free(&kanata);
    if (!status)
        status = fp3_kanata_close(&kanata, &error);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    fp3_visit_free(&visit);
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
