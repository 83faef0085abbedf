/* SPDX-License-Identifier: Apache-2.0 */
/* phases_print.c - see phases_print.h. */
#include "phases_print.h"

#include "machine/phased.h"

#include <inttypes.h>
#include <stdio.h>

static uint32_t op_at(const fp3_image *image, uint32_t at) { return image->decoded[at].in.op; }

/* Instructions of the loops over this list. */
static uint32_t per_neighbour(const fp3_image *image, uint32_t list) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < image->code_count; i++) {
        if (op_at(image, i) != FP3_OP_EACH)
            continue;
        const uint32_t end = fp3_neighbourhood_end(image->decoded, i);
        count += image->decoded[i].in.d == list ? end - i - 1 : 0;
        i = end;
    }
    return count;
}

static void print_instructions(const fp3_image *image, const fp3_neighbourhood *around) {
    uint32_t loops = 0, sequence = around->phases - 1;
    for (uint32_t i = 0; i < image->code_count; i++)
        sequence += 2 * (op_at(image, i) == FP3_OP_EACH);
    for (uint32_t i = 0; i < around->list_count; i++)
        loops += per_neighbour(image, around->lists[i].reg);
    printf("per object and step     %" PRIu32 " instructions\n",
           image->code_count - loops - sequence);
    for (uint32_t i = 0; i < around->list_count; i++)
        printf("per neighbour           %" PRIu32 " instructions in list %s, %" PRIu32 " fields\n",
               per_neighbour(image, around->lists[i].reg),
               fp3_image_name(image, around->lists[i].reg), around->lists[i].fields);
}

static uint32_t print_phase(const fp3_image *image, const fp3_config *config, uint32_t number,
                            uint32_t begin) {
    const fp3_phased program = {image->decoded, image->code_count};
    const fp3_phase_cost cost = fp3_phase_cost_of(config, &program, begin);
    printf("cycles of phase %-7" PRIu32 " %" PRIu32 " per object", number, cost.object);
    for (uint32_t i = begin; i < cost.end; i++)
        if (op_at(image, i) == FP3_OP_EACH)
            printf(", %" PRIu32 " per turn of %s", fp3_turn_cost_of(&program, i),
                   fp3_image_name(image, image->decoded[i].in.d));
    if (cost.loops)
        printf("; %" PRIu32 " per batch", cost.loops * cost.loop);
    printf("; %" PRIu32 " per phase\n", cost.around);
    return cost.end + 1;
}

void fp3_phases_print_cycles(const fp3_image *image, const fp3_config *config) {
    for (uint32_t begin = 0, number = 1; begin < image->code_count; number++)
        begin = print_phase(image, config, number, begin);
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
