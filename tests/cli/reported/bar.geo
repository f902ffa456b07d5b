// SPDX-License-Identifier: Apache-2.0
DefineConstant[ nx = 20, ny = 4, h = 0.2 ];
Point(1) = {-0.5, 0, 0}; Point(2) = {0, 0, 0}; Point(3) = {0, h, 0}; Point(4) = {-0.5, h, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 3} = nx + 1; Transfinite Curve {2, 4} = ny + 1; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("guides") = {1, 3}; Physical Curve("wet") = {2}; Physical Curve("base") = {4}; Physical Surface("rubber") = {1};
