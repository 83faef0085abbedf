/* machine.c - machine.h for a SoC of LiteX with a VexRiscv: its UART, its timer, its interrupts. */
#include "machine.h"
#include <generated/csr.h>
#include <generated/mem.h>
#include <generated/soc.h>
#include <irq.h>
#include <system.h>
#ifdef CSR_SDRAM_BASE
#include <generated/sdram_phy.h>
#endif

#define END_OF_TRANSMISSION 4
#define MEIE (1u << 11)

#define EXTERNAL 0x8000000bul /* the cause of a trap that is an interrupt */

static volatile int is_late;

/* ---- the bus: VexRiscv does not notice an answer SLVERR, but the wrapper counts them ---- */

static volatile uint32_t *at(uint32_t address) {
    return (volatile uint32_t *)((uintptr_t)FP3_BASE + address);
}

static int read_word(void *user, uint32_t address, uint32_t *word) {
    (void)user;
    const uint32_t errors = fp3_errors_read();
    *word = *at(address);
    return fp3_errors_read() != errors;
}

static int write_word(void *user, uint32_t address, uint32_t word) {
    (void)user;
    const uint32_t errors = fp3_errors_read();
    *at(address) = word;
    return fp3_errors_read() != errors;
}

const fp3_bare_bus machine_bus = {read_word, write_word, 0};

/* ---- memory ---- */

#ifdef CSR_SDRAM_BASE
/* As LiteX's BIOS begins with an SDRAM. What the memory held stays. */
static void start_memory(void) {
    sdram_dfii_control_write(DFII_CONTROL_CKE | DFII_CONTROL_ODT | DFII_CONTROL_RESET_N);
    init_sequence();
    sdram_dfii_control_write(DFII_CONTROL_SEL);
}

volatile uint32_t *machine_memory(uint32_t address) {
    return (volatile uint32_t *)(uintptr_t)address;
}

/* VexRiscv's cache writes through, so there is nothing else to do; no other cache is before memory:
 * add_fp3() refuses one. */
void machine_forget(void) { flush_cpu_dcache(); }

uint64_t machine_cycles(void) {
    timer0_uptime_latch_write(1);
    return timer0_uptime_cycles_read();
}
#endif

/* ---- the UART ---- */

static void put(char letter) {
    while (uart_txfull_read()) {
    }
    uart_rxtx_write((uint8_t)letter);
}

void machine_print(const char *text) {
    while (*text)
        put(*text++);
}

/* ---- traps ---- */

static void interrupt(void) {
    const uint32_t pending = irq_pending();
    if (pending & 1u << FP3_INTERRUPT)
        program_interrupt();
    if (pending & 1u << TIMER0_INTERRUPT) {
        timer0_ev_pending_write(1);
        is_late = 1;
    }
}

static void end(void) {
    put(END_OF_TRANSMISSION);
    for (;;) {
    }
}

__attribute__((interrupt("machine"), aligned(4))) static void trap(void) {
    if (csrr(mcause) == EXTERNAL) {
        interrupt();
    } else {
        machine_print("error: a trap that is none of ours\n");
        end();
    }
}

/* A processor with something else to do would do it in the loop. */
int machine_wait(int (*is_over)(void), uint32_t cycles) {
    is_late = 0;
    timer0_en_write(0);
    timer0_reload_write(0);
    timer0_load_write(cycles);
    timer0_ev_pending_write(1);
    timer0_ev_enable_write(1);
    timer0_en_write(1);
    irq_setie(1);
    while (!is_over() && !is_late) {
    }
    irq_setie(0);
    timer0_en_write(0);
    return is_over();
}

void machine_main(void) {
    csrw(mtvec, trap);
    irq_setmask(1u << FP3_INTERRUPT | 1u << TIMER0_INTERRUPT);
    csrw(mie, MEIE);
#ifdef CSR_SDRAM_BASE
    start_memory();
#endif
    program();
    end();
}
