// SPDX-License-Identifier: Apache-2.0
// Cook's membrane, corners in millimetres, cells in equal parts of its edges.
DefineConstant [
  n = 16,   // cells a side
  shape = 0 // 0 quadrilaterals, 1 triangles
];
mm = 1e-3;
Point(1) = {0, 0, 0};
Point(2) = {48 * mm, 44 * mm, 0};
Point(3) = {48 * mm, 60 * mm, 0};
Point(4) = {0, 44 * mm, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 3, 4};
If (shape == 0)
  Recombine Surface {1};
EndIf
Physical Curve("bottom") = {1};
Physical Curve("loaded") = {2};
Physical Curve("top") = {3};
Physical Curve("clamped") = {4};
Physical Surface("membrane") = {1};
