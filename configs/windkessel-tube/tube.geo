// SPDX-License-Identifier: Apache-2.0
// A channel of height 20 mm and length 0.2 m.
DefineConstant[ n = 12 ]; // cells over the height
h = 0.02; l = 0.2;
Point(1) = {0, 0, 0}; Point(2) = {l, 0, 0}; Point(3) = {l, h, 0}; Point(4) = {0, h, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 3 * n + 1; Transfinite Curve{2, 4} = n + 1;
Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("walls") = {1, 3}; Physical Curve("outlet") = {2}; Physical Curve("inlet") = {4};
Physical Surface("fluid") = {1};
