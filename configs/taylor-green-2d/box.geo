// SPDX-License-Identifier: Apache-2.0
// Square of edge 2 pi, quadrilaterals.
DefineConstant [ n = 32 ]; // cells an edge
l = 2 * Pi;
Point(1) = {0, 0, 0};
Point(2) = {l, 0, 0};
Point(3) = {l, l, 0};
Point(4) = {0, l, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("fluid") = {1};
