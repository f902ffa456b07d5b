// SPDX-License-Identifier: Apache-2.0
// The lid, 5 cm thick; its faces are those of fluid.geo.
DefineConstant [
  n = 16, // cells along it
  m = 4   // over its thickness
];
t = 0.05; // m
Point(1) = {0, 1, 0}; Point(2) = {1, 1, 0}; Point(3) = {1, 1 + t, 0}; Point(4) = {0, 1 + t, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = m + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("ends") = {2, 4};
Physical Curve("wet") = {1};
Physical Curve("dry") = {3};
Physical Surface("solid") = {1};
