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

/* The memory that FP3's second port sees, word by word, from this byte address on. A word that is
 * written here is in memory at once. */
volatile uint32_t *machine_memory(uint32_t address);
/* Later reads of memory get what FP3 has written: the cache forgets all words. */
void machine_forget(void);
/* Cycles since reset. */
uint64_t machine_cycles(void);

/* ships.c, scenes.c or memory.c. FP3's interrupt is high: takes it back. */
void program_interrupt(void);
/* 0: all went well. */
int program(void);

#endif
