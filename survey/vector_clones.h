/// For the functions that most of the planning time is spent in.
#pragma once

/// One copy of a function for each instruction set; the loader picks. Contraction is off (see
/// CMakeLists.txt), so that all give the same bits.
#if defined(__x86_64__) && defined(__gnu_linux__)
#define SKYCAP_VECTOR_CLONES __attribute__((target_clones("default", "arch=x86-64-v3")))
#else
#define SKYCAP_VECTOR_CLONES
#endif
