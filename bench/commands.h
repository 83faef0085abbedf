/* commands.h - what the program can be asked for. */
#ifndef BENCH_COMMANDS_H
#define BENCH_COMMANDS_H

int bench_points_command(int argc, char **argv); /* error against run time of a model */
int bench_speed_command(int argc, char **argv);  /* the ship, by objects and steps */
int bench_skip_command(int argc, char **argv);   /* what a scene does not need */

#endif
