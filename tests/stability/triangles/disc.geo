// SPDX-License-Identifier: Apache-2.0
DefineConstant[ h = 0.08 ];
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h}; Point(3) = {0, 1, 0, h}; Point(4) = {-1, 0, 0, h}; Point(5) = {0, -1, 0, h};
Point(12) = {0.5, 0, 0, h / 2}; Point(13) = {0, 0.5, 0, h / 2}; Point(14) = {-0.5, 0, 0, h / 2}; Point(15) = {0, -0.5, 0, h / 2};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Circle(11) = {12, 1, 13}; Circle(12) = {13, 1, 14}; Circle(13) = {14, 1, 15}; Circle(14) = {15, 1, 12};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {11, 12, 13, 14}; Plane Surface(1) = {1, 2};
Physical Curve("outer") = {1, 2, 3, 4}; Physical Curve("inner") = {11, 12, 13, 14}; Physical Surface("fluid") = {1};
