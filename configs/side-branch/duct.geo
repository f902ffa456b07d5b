// SPDX-License-Identifier: Apache-2.0
// A duct of height 0.1 and length 1.2 with a closed branch of width 0.05 and length 0.24 on top, from x = 0.6 on.
DefineConstant[ n = 8 ]; // cells over the height
h = 0.1; a = 0.6; w = 0.05; l = 1.2; b = 0.24;
Point(1) = {0, 0, 0}; Point(2) = {a, 0, 0}; Point(3) = {a + w, 0, 0}; Point(4) = {l, 0, 0};
Point(5) = {0, h, 0}; Point(6) = {a, h, 0}; Point(7) = {a + w, h, 0}; Point(8) = {l, h, 0};
Point(9) = {a, h + b, 0}; Point(10) = {a + w, h + b, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {5, 6}; Line(5) = {6, 7}; Line(6) = {7, 8};
Line(7) = {1, 5}; Line(8) = {2, 6}; Line(9) = {3, 7}; Line(10) = {4, 8};
Line(11) = {6, 9}; Line(12) = {7, 10}; Line(13) = {9, 10};
Curve Loop(1) = {1, 8, -4, -7}; Plane Surface(1) = {1};
Curve Loop(2) = {2, 9, -5, -8}; Plane Surface(2) = {2};
Curve Loop(3) = {3, 10, -6, -9}; Plane Surface(3) = {3};
Curve Loop(4) = {5, 12, -13, -11}; Plane Surface(4) = {4};
Transfinite Curve{7, 8, 9, 10} = n + 1;
Transfinite Curve{1, 4} = 6 * n + 1; Transfinite Curve{2, 5, 13} = n / 2 + 1;
Transfinite Curve{3, 6} = 6 * n + 1; Transfinite Curve{11, 12} = 2 * n + 1;
Transfinite Surface{1, 2, 3, 4}; Recombine Surface{1, 2, 3, 4};
Physical Curve("inlet") = {7}; Physical Curve("outlet") = {10};
Physical Curve("walls") = {1, 2, 3, 4, 6, 11, 12, 13};
Physical Surface("fluid") = {1, 2, 3, 4};
