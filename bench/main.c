/* main.c - bench: what `make bench` measures with; tools/bench.py runs it.
 *
 *     bench points MODEL.ode --json FILE    error against run time
 *     bench speed --json FILE               the ship, by objects and steps
 *     bench skip --json FILE                what a scene does not need, done and left out
 *
 * A program of its own: SUNDIALS, a compiler at run time and other people's solvers are no part of
 * the library or of the command.
 */
#include "commands.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
    if (argc > 1 && !strcmp(argv[1], "points"))
        return bench_points_command(argc - 1, argv + 1);
    if (argc > 1 && !strcmp(argv[1], "speed"))
        return bench_speed_command(argc - 1, argv + 1);
    if (argc > 1 && !strcmp(argv[1], "skip"))
        return bench_skip_command(argc - 1, argv + 1);
    fprintf(stderr, "bench: found '%s', expected points, speed or skip\n", argc > 1 ? argv[1] : "");
    return 2;
}
