// SPDX-License-Identifier: Apache-2.0
// Square, finer towards the walls. The hot wall is on the left.
DefineConstant [
  n = 40,     // cells a side
  bump = 0.3, // cell size at the walls over that in the middle, roughly
  h = 0.046   // side [m]
];

Point(1) = {0, 0, 0};
Point(2) = {h, 0, 0};
Point(3) = {h, h, 0};
Point(4) = {0, h, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1 Using Bump bump;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("hot") = {4};
Physical Curve("cold") = {2};
Physical Curve("walls") = {1, 3};
Physical Surface("fluid") = {1};
