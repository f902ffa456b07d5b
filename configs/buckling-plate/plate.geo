// SPDX-License-Identifier: Apache-2.0
// A square plate of 1 m, t thick: n cells along the sides, nt through the thickness.
DefineConstant [ n = 48, nt = 1, t = 0.01 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1:4} = n + 1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface{1}; Recombine Surface{1};
o[] = Extrude {0, 0, t} { Surface{1}; Layers{nt}; Recombine; };
Physical Surface("edges") = {o[2], o[3], o[4], o[5]};
Physical Surface("faces") = {1, o[0]};
Physical Volume("plate") = {o[1]};
