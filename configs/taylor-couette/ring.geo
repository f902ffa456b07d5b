// SPDX-License-Identifier: Apache-2.0
// The gap between two circles of radius 1 and 2.
DefineConstant[ n = 12 ]; // cells across the gap
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0}; Point(3) = {0, 1, 0}; Point(4) = {-1, 0, 0}; Point(5) = {0, -1, 0};
Point(6) = {2, 0, 0}; Point(7) = {0, 2, 0}; Point(8) = {-2, 0, 0}; Point(9) = {0, -2, 0};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Circle(5) = {6, 1, 7}; Circle(6) = {7, 1, 8}; Circle(7) = {8, 1, 9}; Circle(8) = {9, 1, 6};
Line(9) = {2, 6}; Line(10) = {3, 7}; Line(11) = {4, 8}; Line(12) = {5, 9};
Curve Loop(1) = {9, 5, -10, -1}; Plane Surface(1) = {1};
Curve Loop(2) = {10, 6, -11, -2}; Plane Surface(2) = {2};
Curve Loop(3) = {11, 7, -12, -3}; Plane Surface(3) = {3};
Curve Loop(4) = {12, 8, -9, -4}; Plane Surface(4) = {4};
Transfinite Curve{1:8} = 2 * n + 1; Transfinite Curve{9:12} = n + 1;
Transfinite Surface{:}; Recombine Surface{:};
Physical Curve("inner") = {1:4}; Physical Curve("outer") = {5:8};
Physical Surface("fluid") = {1:4};
