// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 8, m = 1 ];
Point(1) = {0, 0, 0}; Point(2) = {4, 0, 0}; Point(3) = {4, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 3 * n + 1; Transfinite Curve{2, 4} = n + 1;
Transfinite Surface{1}; Recombine Surface{1};
a[] = Extrude {0, 0, 0.5} { Surface{1}; Layers{m}; Recombine; };
Physical Surface("walls") = {a[2], a[4]}; Physical Surface("outlet") = {a[3]}; Physical Surface("inlet") = {a[5]};
Physical Surface("front") = {1}; Physical Surface("back") = {a[0]};
Physical Volume("fluid") = {a[1]};
