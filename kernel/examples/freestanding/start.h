/* What a program needs that has no C library: an entry, a few system calls of Linux, and the three memory functions that
 * the library calls. On another freestanding target this file is what changes. */
#ifndef START_H
#define START_H

#include <stddef.h>
#include <stdint.h>

#if defined(__x86_64__)

enum { OPEN = 2, WRITE = 1 };

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

static int create(const char *name)
{
    return (int)system_call(OPEN, (long)name, 0x241 /* write, create, truncate */, 0644);
}

#elif defined(__aarch64__)

enum { OPENAT = 56, WRITE = 64 };

__asm__(".globl _start\n"
        "_start:\n"
        "    mov x29, #0\n"
        "    bl run\n"
        "    mov x8, #93\n" /* exit */
        "    svc #0\n");

static long system_call4(long number, long a, long b, long c, long d)
{
    register long x8 __asm__("x8") = number;
    register long x0 __asm__("x0") = a;
    register long x1 __asm__("x1") = b;
    register long x2 __asm__("x2") = c;
    register long x3 __asm__("x3") = d;
    __asm__ volatile("svc #0" : "+r"(x0) : "r"(x8), "r"(x1), "r"(x2), "r"(x3) : "memory");
    return x0;
}

static long system_call(long number, long a, long b, long c)
{
    return system_call4(number, a, b, c, 0);
}

static int create(const char *name)
{
    return (int)system_call4(OPENAT, -100 /* relative to here */, (long)name, 0x241, 0644);
}

#else
#error "no entry and no system calls for this processor"
#endif

static int put(int file, const void *bytes, size_t length)
{
    const char *next = bytes;
    while (length > 0) {
        long written = system_call(WRITE, file, (long)next, (long)length);
        if (written <= 0) {
            return 0;
        }
        next += written;
        length -= (size_t)written;
    }
    return 1;
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

void *memmove(void *to, const void *from, size_t n)
{
    char *t = to;
    const char *f = from;
    if ((uintptr_t)t <= (uintptr_t)f) {
        return memcpy(to, from, n);
    }
    while (n > 0) {
        n--;
        t[n] = f[n];
    }
    return to;
}

/* A file's bytes within the program, aligned for a blob. */
#define INCLUDE_BLOB(name, file)                                                                                       \
    __asm__(".section .rodata\n.balign 64\n.globl " #name "\n" #name ":\n.incbin \"" file "\"\n.globl " #name          \
            "_end\n" #name "_end:\n.previous\n");                                                                      \
    extern const unsigned char name[], name##_end[]

#endif
