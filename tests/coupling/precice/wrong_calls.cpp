// SPDX-License-Identifier: Apache-2.0
// Says what the library answers to wrong calls, one a line, then goes down with one that nobody catches.
// Usage: precice_wrong_calls Left XML
#include <cmath>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "precice/precice.hpp"

namespace {

void refused(const char* what, const std::function<void()>& call) {
  try {
    call();
    std::cout << what << " | accepted" << std::endl;
  } catch (const precice::Error& error) {
    std::cout << what << " | " << error.what() << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string xml = argv[2], mesh = "Left-Mesh", datum = "Displacement-Left",
                    read = "Displacement-Right";
  refused("unknown participant", [&] { precice::Participant("Middle", xml, 0, 1); });
  refused("no configuration", [&] { precice::Participant("Left", "none.xml", 0, 1); });
  refused("rank", [&] { precice::Participant("Left", xml, 1, 1); });
  precice::Participant p("Left", xml, 0, 1);
  refused("second participant", [&] { precice::Participant("Right", xml, 0, 1); });
  std::vector<double> one(1), two(2), line{0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0}, values(6);
  std::vector<int> ids(6), first{0};
  refused("advance first", [&] { p.advance(0.1); });
  refused("read first", [&] { p.readData(mesh, read, first, 0, one); });
  refused("unknown mesh", [&] { p.setMeshVertices("Mesh", line, ids); });
  refused("received mesh", [&] { p.setMeshVertices("Right-Mesh", line, ids); });
  refused("coordinates", [&] { p.setMeshVertices(mesh, two, ids); });
  refused("no vertex", [&] { p.writeData(mesh, datum, first, one); });
  refused("edge", [&] { p.setMeshEdge(mesh, 0, 0); });
  p.setMeshVertices(mesh, line, ids);
  refused("twice in an edge", [&] { p.setMeshEdge(mesh, 1, 1); });
  refused("initial data", [&] { p.initialize(); });
  if (p.requiresInitialData()) p.writeData(mesh, datum, ids, values);
  p.initialize();
  refused("initialize twice", [&] { p.initialize(); });
  refused("mesh is locked", [&] { p.setMeshVertices(mesh, line, ids); });
  refused("unknown data", [&] { p.writeData(mesh, "Force", first, one); });
  refused("data is read", [&] { p.writeData(mesh, read, first, one); });
  refused("data is written", [&] { p.readData(mesh, datum, first, 0, one); });
  refused("sizes", [&] { p.writeData(mesh, datum, ids, one); });
  refused("id", [&] { p.readData(mesh, read, std::vector<int>{6}, 0, one); });
  refused("not finite", [&] { p.writeData(mesh, datum, first, std::vector<double>{NAN}); });
  refused("read time", [&] { p.readData(mesh, read, first, 1, one); });
  refused("negative read time", [&] { p.readData(mesh, read, first, -0.1, one); });
  refused("step", [&] { p.advance(1); });
  refused("no step", [&] { p.advance(0); });
  refused("checkpoint", [&] { p.advance(p.getMaxTimeStepSize()); });
  refused("direct access", [&] { p.setMeshAccessRegion("Right-Mesh", line); });
  refused("just-in-time", [&] { p.mapAndReadData("Right-Mesh", read, two, 0, one); });
  refused("gradients", [&] { p.writeGradientData(mesh, datum, first, two); });
  refused("resetMesh", [&] { p.resetMesh(mesh); });
  if (argc > 3) return 0;  // leaves while the coupling is ongoing
  p.advance(-1);           // nobody catches it
}
