/* SPDX-License-Identifier: Apache-2.0 */
/* phases_print.c - see phases_print.h. */
#include "phases_print.h"

#include "machine/phased.h"

#include <inttypes.h>
#include <stdio.h>

static uint32_t op_at(const fp3_image *image, uint32_t at) { return image->decoded[at].in.op; }

/* Instructions of a step: outside of all loops (FP3_NO_LIST), or in those over a list. */
#define FP3_NO_LIST UINT32_MAX
static uint32_t count_instructions(const fp3_image *image, uint32_t list) {
    uint32_t count = 0;
    fp3_repetition repetition = {0, 0};
    for (uint32_t i = 0; i < image->code_count;) {
        if (fp3_ends_phase(&image->decoded[i])) {
            i = fp3_neighbourhood_behind(image->decoded, i, &repetition);
            continue;
        }
        const uint32_t end =
            op_at(image, i) == FP3_OP_EACH ? fp3_neighbourhood_end(image->decoded, i) : FP3_NO_LIST;
        if (end == FP3_NO_LIST)
            count += list == FP3_NO_LIST;
        else if (image->decoded[i].in.d == list)
            count += end - i - 1;
        i = end == FP3_NO_LIST ? i + 1 : end + 1;
    }
    return count;
}

static void print_instructions(const fp3_image *image, const fp3_neighbourhood *around) {
    printf("per object and step     %" PRIu32 " instructions\n",
           count_instructions(image, FP3_NO_LIST));
    for (uint32_t i = 0; i < around->list_count; i++)
        printf("per neighbour           %" PRIu32 " instructions in list %s, %" PRIu32 " fields\n",
               count_instructions(image, around->lists[i].reg),
               fp3_image_name(image, around->lists[i].reg), around->lists[i].fields);
}

/* times: how often a step makes it. */
static uint32_t print_phase(const fp3_image *image, const fp3_config *config, uint32_t number,
                            uint32_t times, uint32_t begin) {
    const fp3_phased program = {image->decoded, image->code_count};
    const fp3_phase_cost cost = fp3_phase_cost_of(config, &program, begin);
    printf("cycles of phase %-7" PRIu32 " ", number);
    if (times > 1)
        printf("%" PRIu32 " times ", times);
    printf("%" PRIu32 " per object", cost.object);
    for (uint32_t i = begin; i < cost.end; i++)
        if (op_at(image, i) == FP3_OP_EACH)
            printf(", %" PRIu32 " per turn of %s", fp3_turn_cost_of(&program, i),
                   fp3_image_name(image, image->decoded[i].in.d));
    if (cost.loops)
        printf("; %" PRIu32 " per batch", cost.loops * cost.loop);
    printf("; %" PRIu32 " per phase\n", cost.around);
    return cost.end;
}

void fp3_phases_print_cycles(const fp3_image *image, const fp3_config *config) {
    uint32_t times = 1;
    for (uint32_t begin = 0, number = 1; begin < image->code_count; number++, begin++) {
        begin = print_phase(image, config, number, times, begin);
        if (begin < image->code_count && op_at(image, begin) != FP3_OP_PHASE)
            times = op_at(image, begin) == FP3_OP_REPEAT ? image->decoded[begin].in.d : 1;
    }
}

void fp3_phases_print(const fp3_image *image, const fp3_neighbourhood *around,
                      const fp3_config *config) {
    printf("phases of a step        %" PRIu32 "\n", around->phases);
    printf("published              ");
    for (uint32_t reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
        if (around->published >> reg & 1)
            printf(" %s", fp3_image_name(image, reg));
    printf("\n");
    print_instructions(image, around);
    fp3_phases_print_cycles(image, config);
}
