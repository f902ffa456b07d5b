// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::app::watching {

/// From now on this process tells the others of waits that last, each a sign of life, and looks whether all of them
/// wait: nobody is left then to send what any of them waits for, and the job ends with the names, whatever the hang
/// timeout. Only where all processes of the job can be seen: a guest, or another machine, may be the one that works.
void watch_waits();

}  // namespace couplet::app::watching
