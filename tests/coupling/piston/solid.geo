// SPDX-License-Identifier: Apache-2.0
Point(1) = {1, 0, 0}; Point(2) = {1.5, 0, 0}; Point(3) = {1.5, 0.4, 0}; Point(4) = {1, 0.4, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 21; Transfinite Curve{2, 4} = 9;
Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("sides") = {1, 3}; Physical Curve("end") = {2}; Physical Curve("face") = {4};
Physical Surface("body") = {1};
