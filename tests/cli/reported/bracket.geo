// SPDX-License-Identifier: Apache-2.0
DefineConstant[ nx = 40, ny = 4 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 0.1, 0}; Point(4) = {0, 0.1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve {1, 3} = nx + 1; Transfinite Curve {2, 4} = ny + 1; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("left") = {4}; Physical Curve("right") = {2}; Physical Curve("bottom") = {1}; Physical Curve("top") = {3}; Physical Surface("steel") = {1};
