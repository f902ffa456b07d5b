// SPDX-License-Identifier: Apache-2.0
// Quarter of the NAFEMS LE1 membrane between the ellipses 2 x 1 m and 3.25 x 2.75 m.
DefineConstant [
  nr = 16, // cells from the inner to the outer edge
  nt = 24, // cells around
  shape = 0 // 0 quadrilaterals, 1 triangles, two a quadrilateral
];
Point(1) = {0, 0, 0};
Point(2) = {2, 0, 0};
Point(3) = {3.25, 0, 0};
Point(4) = {0, 2.75, 0};
Point(5) = {0, 1, 0};
Line(1) = {2, 3};
Ellipse(2) = {3, 1, 3, 4};
Line(3) = {4, 5};
Ellipse(4) = {5, 1, 2, 2};
Transfinite Curve {1, -3} = nr + 1 Using Progression 1.0;
Transfinite Curve {2, 4} = nt + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (shape == 0)
  Recombine Surface {1};
EndIf
Physical Curve("symmetry-y") = {1};
Physical Curve("outer") = {2};
Physical Curve("symmetry-x") = {3};
Physical Curve("inner") = {4};
Physical Surface("membrane") = {1};
