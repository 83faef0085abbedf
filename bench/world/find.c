/* find.c - see hand.h. */
#include "hand.h"

#include <string.h>

const hand_loop *hand_find(const char *scene) {
    static const hand_loop *const wide[] = {&hand_net_v4, &hand_stars_v4, &hand_balls_v4};
    static const hand_loop *const narrow[] = {&hand_net_v3, &hand_stars_v3, &hand_balls_v3};
    __builtin_cpu_init();
    for (size_t i = 0; i < sizeof wide / sizeof *wide; i++) {
        if (strcmp(wide[i]->scene, scene) != 0)
            continue;
        if (__builtin_cpu_supports("x86-64-v4"))
            return wide[i];
        if (__builtin_cpu_supports("x86-64-v3"))
            return narrow[i];
    }
    return NULL;
}
