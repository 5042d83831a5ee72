/* What a program needs that has no C library: an entry, three system calls of x86-64 Linux, and the two memory functions that
 * the library calls. On another freestanding target this file is what changes. */
#ifndef START_H
#define START_H

#include <stddef.h>
#include <stdint.h>

__asm__(".globl _start\n"
        "_start:\n"
        "    xor %ebp, %ebp\n"
        "    and $-16, %rsp\n" /* the ABI's stack alignment at a call */
        "    call run\n"
        "    mov %eax, %edi\n"
        "    mov $60, %eax\n" /* exit */
        "    syscall\n");

static long system_call(long number, long a, long b, long c)
{
    long result;
    __asm__ volatile("syscall" : "=a"(result) : "a"(number), "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
    return result;
}

static int put(int file, const void *bytes, size_t length)
{
    const char *next = bytes;
    while (length > 0) {
        long written = system_call(1, file, (long)next, (long)length);
        if (written <= 0) {
            return 0;
        }
        next += written;
        length -= (size_t)written;
    }
    return 1;
}

static int create(const char *name)
{
    return (int)system_call(2, (long)name, 0x241 /* write, create, truncate */, 0644);
}

/* What compilers call by themselves (C11, §4p6 leaves them to the program). */
void *memcpy(void *restrict to, const void *restrict from, size_t n)
{
    char *t = to;
    for (const char *f = from; n > 0; n--) {
        *t++ = *f++;
    }
    return to;
}

void *memset(void *to, int value, size_t n)
{
    for (char *t = to; n > 0; n--) {
        *t++ = (char)value;
    }
    return to;
}

/* A file's bytes within the program, aligned for a blob. */
#define INCLUDE_BLOB(name, file)                                                                                       \
    __asm__(".section .rodata\n.balign 64\n.globl " #name "\n" #name ":\n.incbin \"" file "\"\n.globl " #name          \
            "_end\n" #name "_end:\n.previous\n");                                                                      \
    extern const unsigned char name[], name##_end[]

#endif
