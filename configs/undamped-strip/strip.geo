// SPDX-License-Identifier: Apache-2.0
// A strip of 1 m x 0.15 m along x, triangles; n cells across.
DefineConstant [ n = 4 ];
length = 1; height = 0.15; // m
h = height / n;
Point(1) = {0, 0, 0, h}; Point(2) = {length, 0, 0, h}; Point(3) = {length, height, 0, h}; Point(4) = {0, height, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Curve("root") = {4};
Physical Curve("rest") = {1, 2, 3};
Physical Surface("strip") = {1};
