// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a function: compiled for several processors, the best is chosen when the program starts. Not with Clang, which leaves
/// out the inline functions that only the clones call (seen with 16).
#ifdef __clang__
#define COUPLET_PROCESSOR_CLONES
#else
#define COUPLET_PROCESSOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
