// SPDX-License-Identifier: Apache-2.0
DefineConstant [ n = 16, m = 16, lx = 1, ly = 1 ];
Point(1) = {0, 0, 0}; Point(2) = {lx, 0, 0}; Point(3) = {lx, ly, 0}; Point(4) = {0, ly, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1, 3} = n + 1; Transfinite Curve {2, 4} = m + 1;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4};
Physical Surface("body") = {1};
