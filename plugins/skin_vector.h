// Loops marked SKIN_VECTOR are compiled for several instruction sets; the one of this machine
// is chosen when the plugin is loaded.

#ifndef LMP_SKIN_VECTOR_H
#define LMP_SKIN_VECTOR_H

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_ADDRESS__)
#if __GNUC__ >= 12
#define SKIN_VECTOR __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define SKIN_VECTOR __attribute__((target_clones("default", "avx2", "avx512f")))
#endif
#else
#define SKIN_VECTOR
#endif

#endif
