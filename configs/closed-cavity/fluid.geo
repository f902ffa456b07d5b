// SPDX-License-Identifier: Apache-2.0
// A box of 1 x 1 m under a lid, with an inlet at the foot of its left wall.
DefineConstant [
  n = 16 // cells along each side, a multiple of 4
];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0}; Point(5) = {0, 0.25, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 1};
Transfinite Curve {1, 2, 3} = n + 1;
Transfinite Curve {4} = 3 * n / 4 + 1;
Transfinite Curve {5} = n / 4 + 1;
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 3, 4};
Recombine Surface {1};
Physical Curve("inlet") = {5};
Physical Curve("walls") = {1, 2, 4};
Physical Curve("lid") = {3};
Physical Surface("fluid") = {1};
