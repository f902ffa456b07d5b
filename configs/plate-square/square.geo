// SPDX-License-Identifier: Apache-2.0
// A square plate of 1 m.
DefineConstant[ n = 16 ]; // cells along a side
DefineConstant[ quadrilaterals = 0 ]; // 1: instead of triangles
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1} Alternate;
If (quadrilaterals)
  Recombine Surface {1};
EndIf
Physical Curve("edge") = {1 : 4};
Physical Surface("plate") = {1};
