# start.S - the first instructions: a stack, and zeros in memory.
    .section .start, "ax"
    .global _start
_start:
    la   sp, _stack
    la   a0, _bss
    la   a1, _bss_end
clear:
    beq  a0, a1, cleared
    sw   zero, 0(a0)
    addi a0, a0, 4
    j    clear
cleared:
    j    machine_main
