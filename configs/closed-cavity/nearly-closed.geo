// SPDX-License-Identifier: Apache-2.0
// The box of fluid.geo with an opening of m cells at the foot of its right wall.
DefineConstant [
  n = 16, // cells along each side, a multiple of 4
  m = 1 // cells of the opening: 1 / n of the side each
];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, m / n, 0}; Point(4) = {1, 1, 0}; Point(5) = {0, 1, 0};
Point(6) = {0, 0.25, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Transfinite Curve {1, 4} = n + 1;
Transfinite Curve {2} = m + 1;
Transfinite Curve {3} = n - m + 1;
Transfinite Curve {5} = 3 * n / 4 + 1;
Transfinite Curve {6} = n / 4 + 1;
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 4, 5};
Recombine Surface {1};
Physical Curve("inlet") = {6};
Physical Curve("outlet") = {2};
Physical Curve("walls") = {1, 3, 5};
Physical Curve("lid") = {4};
Physical Surface("fluid") = {1};
