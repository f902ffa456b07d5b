// SPDX-License-Identifier: Apache-2.0
// Quarter of the section of a thick cylinder, cells uniform in the angle and growing with the radius.
DefineConstant [
  nr = 16,  // cells through the wall
  nt = 24,  // cells over the quarter
  shape = 0 // 0 quadrilaterals, 1 triangles
];
inner = 7; outer = 18.625; // m
Point(1) = {0, 0, 0};
Point(2) = {inner, 0, 0};
Point(3) = {outer, 0, 0};
Point(4) = {0, outer, 0};
Point(5) = {0, inner, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Transfinite Curve {1} = nr + 1 Using Progression (outer / inner) ^ (1 / nr);
Transfinite Curve {-3} = nr + 1 Using Progression (outer / inner) ^ (1 / nr);
Transfinite Curve {2, 4} = nt + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1} = {2, 3, 4, 5};
If (shape == 0)
  Recombine Surface {1};
EndIf
Physical Curve("symmetry-y") = {1};
Physical Curve("outside") = {2};
Physical Curve("symmetry-x") = {3};
Physical Curve("inside") = {4};
Physical Surface("wall") = {1};
