// SPDX-License-Identifier: Apache-2.0
// A plate of length 1 and thickness 0.05 in a circle of radius 10.
DefineConstant[ n = 24 ]; // cells along the plate
r = 10; a = 0.5; b = 0.025; s = 1 / n;
Point(1) = {-a, -b, 0, s}; Point(2) = {a, -b, 0, s}; Point(3) = {a, b, 0, s}; Point(4) = {-a, b, 0, s};
Point(5) = {0, 0, 0}; Point(6) = {0, -r, 0, 1}; Point(7) = {r, 0, 0, 1}; Point(8) = {0, r, 0, 1}; Point(9) = {-r, 0, 0, 1};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 8}; Circle(7) = {8, 5, 9}; Circle(8) = {9, 5, 6};
Curve Loop(1) = {5, 6, 7, 8}; Curve Loop(2) = {1, 2, 3, 4};
Plane Surface(1) = {1, 2};
Physical Curve("plate") = {1, 2, 3, 4};
Physical Curve("upstream") = {7, 8};
Physical Curve("downstream") = {5, 6};
Physical Surface("fluid") = {1};
