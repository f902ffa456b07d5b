// SPDX-License-Identifier: Apache-2.0
// Square of side 2 with a plate 1 x 0.02 (2 half x 0.02) in its midst, triangles, fine at the plate.
DefineConstant[ n = 50, half = 0.5 ];  // edges along the plate, half its length
Point(1) = {-1, -1, 0, 6 / n};
Point(2) = {1, -1, 0, 6 / n};
Point(3) = {1, 1, 0, 6 / n};
Point(4) = {-1, 1, 0, 6 / n};
Point(5) = {-half, -0.01, 0, 2 * half / n};
Point(6) = {half, -0.01, 0, 2 * half / n};
Point(7) = {half, 0.01, 0, 2 * half / n};
Point(8) = {-half, 0.01, 0, 2 * half / n};
For i In {0 : 3}
  Line(1 + i) = {1 + i, 1 + (i + 1) % 4};
  Line(5 + i) = {5 + i, 5 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1 : 4};
Curve Loop(2) = {5 : 8};
Plane Surface(1) = {1, 2};
Physical Curve("floor") = {1};
Physical Curve("right") = {2};
Physical Curve("lid") = {3};
Physical Curve("left") = {4};
Physical Curve("plate") = {5 : 8};
Physical Surface("fluid") = {1};
