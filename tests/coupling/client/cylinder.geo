// SPDX-License-Identifier: Apache-2.0
// A cylinder of diameter 1 m in the middle of a box, coarse: triangles that grow away from it.
DefineConstant[ n = 48, half = 8, far = 2 ];  // cells on the cylinder, half the box, cells at its walls
Point(1) = {-half, -half, 0, far};
Point(2) = {half, -half, 0, far};
Point(3) = {half, half, 0, far};
Point(4) = {-half, half, 0, far};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
h = 3.14159265 / n;
Point(5) = {0, 0, 0, h};
For i In {0 : 3}
  Point(6 + i) = {0.5 * Cos(i * Pi / 2), 0.5 * Sin(i * Pi / 2), 0, h};
EndFor
For i In {0 : 3}
  Circle(10 + i) = {6 + i, 5, 6 + (i + 1) % 4};
  Transfinite Curve {10 + i} = n / 4 + 1;
EndFor
Curve Loop(1) = {1 : 4};
Curve Loop(2) = {10 : 13};
Plane Surface(1) = {1, 2};
Physical Surface("fluid") = {1};
Physical Curve("inlet") = {4};
Physical Curve("outlet") = {2};
Physical Curve("sides") = {1, 3};
Physical Curve("cylinder") = {10 : 13};
