/* machine.h - all that a program knows of the system that it runs in. */
#ifndef MACHINE_H
#define MACHINE_H

#include "fp3_bare.h"

/* The way to FP3; an address that is answered with an error gives one here. */
extern const fp3_bare_bus machine_bus;

/* Takes interrupts until is_over() says that it came, at most so many cycles. What is_over() says
 * in the end. */
int machine_wait(int (*is_over)(void), uint32_t cycles);

void machine_print(const char *text);

/* ships.c, or scenes.c. FP3's interrupt is high: takes it back. */
void program_interrupt(void);
/* 0: all went well. */
int program(void);

#endif
