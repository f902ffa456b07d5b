// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace precice {

using VertexID = int;  ///< position among the vertices of a mesh on this process, from 0

}  // namespace precice
