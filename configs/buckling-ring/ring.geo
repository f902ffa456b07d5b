// SPDX-License-Identifier: Apache-2.0
// Quarter of a ring of mean radius 1 m, t thick: n cells across, na around.
DefineConstant [ n = 10, na = 160, t = 0.005 ];
a = 1 - t / 2; b = 1 + t / 2;
Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0}; Point(3) = {b, 0, 0}; Point(4) = {0, b, 0}; Point(5) = {0, a, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Line(3) = {4, 5}; Circle(4) = {5, 1, 2};
Transfinite Curve{1, 3} = n + 1;
Transfinite Curve{2, 4} = na + 1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface{1} = {2, 3, 4, 5}; Recombine Surface{1};
Physical Curve("below") = {1};
Physical Curve("outside") = {2};
Physical Curve("left") = {3};
Physical Curve("inside") = {4};
Physical Surface("ring") = {1};
