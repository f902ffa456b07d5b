// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Compiles a function for several processors; the best one is chosen at program start. Disabled for Clang,
/// which drops inline functions called only by the clones (seen with version 16).
#ifdef __clang__
#define COUPLET_PROCESSOR_CLONES
#else
#define COUPLET_PROCESSOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
