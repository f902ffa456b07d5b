// SPDX-License-Identifier: Apache-2.0
// The plate behind the cylinder, from the arc of the cylinder (root) to x = 0.6 m.
DefineConstant[ nx = 70, ny = 9 ]; // cells along and across
c = 0.2; r = 0.05; h = 0.01; f = Sqrt(r ^ 2 - h ^ 2);
Point(1) = {c + f, c - h, 0};
Point(2) = {0.6, c - h, 0};
Point(3) = {0.6, c + h, 0};
Point(4) = {c + f, c + h, 0};
Point(5) = {c, c, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4};
Circle(4) = {4, 5, 1};
Transfinite Curve {1, 3} = nx + 1;
Transfinite Curve {2, 4} = ny + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("root") = {4};
Physical Curve("plate") = {1 : 3};
Physical Surface("solid") = {1};
