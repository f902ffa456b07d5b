// SPDX-License-Identifier: Apache-2.0
// The fluid in the dome, around the pump at its foot.
DefineConstant [
  n = 24, // faces along the dome, even
  m = 8   // cells along the radius
];
in = 0.1; out = 0.3; // m
Point(1) = {0, 0, 0};
Point(2) = {in, 0, 0}; Point(3) = {0, in, 0}; Point(4) = {-in, 0, 0};
Point(5) = {out, 0, 0}; Point(6) = {0, out, 0}; Point(7) = {-out, 0, 0};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {5, 1, 6}; Circle(4) = {6, 1, 7};
Line(5) = {2, 5}; Line(6) = {3, 6}; Line(7) = {4, 7};
Transfinite Curve {1 : 4} = n / 2 + 1;
Transfinite Curve {5 : 7} = m + 1;
Curve Loop(1) = {5, 3, -6, -1}; Curve Loop(2) = {6, 4, -7, -2};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Transfinite Surface {1, 2};
Recombine Surface {1, 2};
Physical Curve("pump") = {1, 2};
Physical Curve("floor") = {5, 7};
Physical Curve("dome") = {3, 4};
Physical Surface("inside") = {1, 2};
