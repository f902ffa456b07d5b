// SPDX-License-Identifier: Apache-2.0
// Quarter of a square plate with a round hole: two blocks that meet on the diagonal, finer towards the hole.
DefineConstant [
  n = 24,      // cells along each block's arc
  nr = 32,     // cells from the hole to the edge
  growth = 10, // length of the last cell over that of the first
  shape = 0    // 0 quadrilaterals, 1 triangles
];
radius = 0.5; side = 2; // m
progression = growth ^ (1 / (nr - 1));
diagonal = Sqrt(0.5);
Point(1) = {0, 0, 0};
Point(2) = {radius, 0, 0};
Point(3) = {side, 0, 0};
Point(4) = {side, side, 0};
Point(5) = {0, side, 0};
Point(6) = {0, radius, 0};
Point(7) = {radius * diagonal, radius * diagonal, 0};
Line(1) = {2, 3};
Line(2) = {3, 4};
Line(3) = {4, 5};
Line(4) = {6, 5};
Circle(5) = {6, 1, 7};
Circle(6) = {7, 1, 2};
Line(7) = {7, 4};
Transfinite Curve {1, 4, 7} = nr + 1 Using Progression progression;
Transfinite Curve {2, 3, 5, 6} = n + 1;
Curve Loop(1) = {1, 2, -7, 6};
Curve Loop(2) = {7, 3, -4, 5};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Transfinite Surface {1, 2};
If (shape == 0)
  Recombine Surface {1, 2};
EndIf
Physical Curve("symmetry-y") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("symmetry-x") = {4};
Physical Curve("hole") = {5, 6};
Physical Surface("plate") = {1, 2};
