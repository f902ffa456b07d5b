// SPDX-License-Identifier: Apache-2.0
// A channel of height 0.5 and length 6.
DefineConstant[ n = 12 ]; // cells over the height
Point(1) = {0, 0, 0}; Point(2) = {6, 0, 0}; Point(3) = {6, 0.5, 0}; Point(4) = {0, 0.5, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 10 * n + 1; Transfinite Curve{2, 4} = n + 1;
Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("floor") = {1};
Physical Curve("downstream") = {2};
Physical Curve("lid") = {3};
Physical Curve("upstream") = {4};
Physical Surface("fluid") = {1};
