// SPDX-License-Identifier: Apache-2.0
// The bar of Turek and Hron: 0.35 x 0.02 m behind a cylinder of radius 0.05 m about (0.2, 0.2); n cells across, m along.
DefineConstant[ n = 4, m = 70 ];
x = 0.2 + Sqrt(0.05^2 - 0.01^2);
Point(1) = {x, 0.19, 0};
Point(2) = {0.6, 0.19, 0};
Point(3) = {0.6, 0.21, 0};
Point(4) = {x, 0.21, 0};
Point(5) = {0.2, 0.2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Circle(4) = {4, 5, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = m + 1;
Transfinite Curve {2, 4} = n + 1;
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("cylinder") = {4};
Physical Curve("free") = {1, 2, 3};
Physical Surface("bar") = {1};
