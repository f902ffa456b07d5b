// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::testing {

/// Leaves the tests of named sources: `--only=order_test.cpp,seat_test.cpp` beside any --gtest_filter. The argument is
/// taken out of argv; called after InitGoogleTest. False, with a message, where a named source has no test or a chosen
/// test has the name of one of another source, which would run with it.
bool choose_files(int& argc, char** argv);

}  // namespace couplet::testing
