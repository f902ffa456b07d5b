// SPDX-License-Identifier: Apache-2.0
// A strip 200 mm x 20 mm, cells in equal parts of its edges.
DefineConstant [
  n = 16,   // cells across
  shape = 0 // 0 quadrilaterals, 1 triangles
];
mm = 1e-3;
Point(1) = {0, -10 * mm, 0};
Point(2) = {200 * mm, -10 * mm, 0};
Point(3) = {200 * mm, 10 * mm, 0};
Point(4) = {0, 10 * mm, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {2, 4} = n + 1;
Transfinite Curve {1, 3} = 10 * n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 3, 4};
If (shape == 0)
  Recombine Surface {1};
EndIf
Physical Curve("edges") = {1, 3};
Physical Curve("tip") = {2};
Physical Curve("root") = {4};
Physical Surface("strip") = {1};
