// SPDX-License-Identifier: Apache-2.0
// The fluid in the channel, around a dome of outer radius 0.33 m on its floor.
DefineConstant [
  n = 24 // faces along the dome, even
];
R = 0.33; left = -1.2; right = 2; top = 1.2; // m
h = Pi * R / n;
Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0, h}; Point(3) = {0, R, 0, h}; Point(4) = {-R, 0, 0, h};
Point(5) = {left, 0, 0, 3 * h}; Point(6) = {left, top, 0, 3 * h}; Point(7) = {right, top, 0, 3 * h}; Point(8) = {right, 0, 0, 3 * h};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4};
Line(3) = {4, 5}; Line(4) = {5, 6}; Line(5) = {6, 7}; Line(6) = {7, 8}; Line(7) = {8, 2};
Transfinite Curve {1, 2} = n / 2 + 1;
Curve Loop(1) = {1 : 7};
Plane Surface(1) = {1};
Physical Curve("dome") = {1, 2};
Physical Curve("inlet") = {4};
Physical Curve("outlet") = {6};
Physical Curve("walls") = {3, 5, 7};
Physical Surface("channel") = {1};
