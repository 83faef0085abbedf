/* in_flight.c - tells the rtl engine's pairing what a test says, and prints what it makes of it.
 *
 *     in_flight CONFIG < EVENTS
 *         i CYCLE SCHEDULER CONTEXT PC WORD                 an instruction issues; WORD as
 * hexadecimal e CYCLE SCHEDULER LANE CONTEXT OUTCOME RESULT REGISTER    one ends; prints its issue
 * and pc
 */
#include "engine/board/in_flight.h"

#include <inttypes.h>
#include <stdio.h>

static int feed(fp3_in_flight *f) {
    char line[256];
    while (fgets(line, sizeof line, stdin)) {
        fp3_rtl_issue i = {0};
        fp3_rtl_end e = {0};
        fp3_retirement *r = &e.result;
        fp3_traced t;
        unsigned outcome = 0;
        if (sscanf(line, "i %" SCNu64 " %u %u %u %x", &i.cycle, &i.scheduler, &i.context, &i.pc,
                   &i.word) == 5) {
            fp3_in_flight_issue(f, &i);
        } else if (sscanf(line, "e %" SCNu64 " %u %u %u %u %d %u", &r->cycle, &r->scheduler,
                          &r->lane, &r->context, &outcome, &e.has_result, &r->reg) == 7) {
            e.outcome = (fp3_outcome)outcome;
            if (fp3_in_flight_end(f, &e, &t))
                printf("%" PRIu64 " %" PRIu32 "\n", t.issued, t.pc);
            else
                printf("nothing\n");
        } else {
            fprintf(stderr, "no event: %s", line);
            return 2;
        }
    }
    return fp3_in_flight_is_lost(f);
}

int main(int argc, char **argv) {
    const fp3_config *config = argc == 2 ? fp3_config_find(argv[1]) : NULL;
    fp3_in_flight *f = config ? fp3_in_flight_make(config) : NULL;
    if (!f) {
        fprintf(stderr, "usage: %s CONFIG\n", argv[0]);
        return 2;
    }
    const int exit_code = feed(f);
    fp3_in_flight_free(f);
    return exit_code;
}
