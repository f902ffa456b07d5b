// SPDX-License-Identifier: Apache-2.0
// A flap with its root at (x, 0); its cells halve those of fluid.geo.
DefineConstant [ x = 0, n_side = 80, n_tip = 8 ];
half = 0.05; height = 1; // m
Point(1) = {x - half, 0, 0};
Point(2) = {x + half, 0, 0};
Point(3) = {x + half, height, 0};
Point(4) = {x - half, height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = n_tip + 1;
Transfinite Curve {2, 4} = n_side + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("root") = {1};
Physical Curve("flap") = {2, 3, 4};
Physical Surface("solid") = {1};
