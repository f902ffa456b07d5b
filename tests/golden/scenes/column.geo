// SPDX-License-Identifier: Apache-2.0
// A column 1 m long, 1/slender m thick: n cells across, nl along.
DefineConstant [ n = 8, nl = 200, slender = 100 ];
h = 1 / slender;
Point(1) = {0, -h / 2, 0}; Point(2) = {1, -h / 2, 0}; Point(3) = {1, h / 2, 0}; Point(4) = {0, h / 2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = nl + 1;
Transfinite Curve{2, 4} = n + 1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("root") = {4};
Physical Curve("tip") = {2};
Physical Curve("sides") = {1, 3};
Physical Surface("column") = {1};
