/* Cortex-M4F: vector table, enables the floating-point unit, then newlib's start (semihosting). */
#include <stdint.h>

extern uint32_t stack_top[];
void _start(void);

__attribute__((naked, noreturn)) void reset(void)
{
    __asm__("ldr r0, =0xE000ED88\n" /* CPACR: full access to the floating-point unit */
            "ldr r1, [r0]\n"
            "orr r1, r1, #0xF00000\n"
            "str r1, [r0]\n"
            "dsb\n"
            "isb\n"
            "b _start\n");
}

__attribute__((noreturn)) static void fault(void)
{
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    stack_top, reset, fault, fault, fault, fault, fault,
};
