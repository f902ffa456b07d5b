// SPDX-License-Identifier: Apache-2.0
// Unit square, finer towards the walls.
DefineConstant [
  n = 64,     // cells a side
  bump = 0.25 // cell size at the walls over that in the middle, roughly
];

Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1 Using Bump bump;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("walls") = {1, 2, 4};
Physical Curve("lid") = {3};
Physical Surface("fluid") = {1};
