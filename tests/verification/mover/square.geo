// SPDX-License-Identifier: Apache-2.0
// Unit square, 6 x 6 quadrilaterals; the right side is the interface.
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = 7; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("walls") = {1, 3, 4}; Physical Curve("moving") = {2}; Physical Surface("fluid") = {1};
