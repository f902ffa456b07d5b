// SPDX-License-Identifier: Apache-2.0
// An angle bracket: 100 mm up a wall, 120 mm out, 8 mm thick, 40 mm deep; n cells through the thickness.
DefineConstant[ n = {2, Name "n"} ];
t = 0.008; a = 0.1; b = 0.12; d = 0.04;
Point(1) = {0, 0, 0}; Point(2) = {t, 0, 0}; Point(3) = {t, a - t, 0}; Point(4) = {0, a - t, 0};
Point(5) = {t, a, 0}; Point(6) = {0, a, 0}; Point(7) = {b, a - t, 0}; Point(8) = {b, a, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Line(5) = {3, 5}; Line(6) = {5, 6}; Line(7) = {6, 4};
Line(8) = {3, 7}; Line(9) = {7, 8}; Line(10) = {8, 5};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7}; Plane Surface(2) = {2};
Curve Loop(3) = {8, 9, 10, -5}; Plane Surface(3) = {3};
Transfinite Curve {1, 3, 6, 5, 7, 9} = n + 1;
Transfinite Curve {2, 4} = 12 * n + 1;
Transfinite Curve {8, 10} = 14 * n + 1;
Transfinite Surface {1:3}; Recombine Surface {1:3};
out[] = Extrude {0, 0, d} { Surface{1:3}; Layers{5 * n}; Recombine; };
Physical Volume("bracket") = Volume{:};
all() = Boundary{ Volume{:}; };
root() = Surface In BoundingBox{-1e-6, -1e-6, -1, t + 1e-6, 1e-6, 1};
Physical Surface("root") = root();
faces() = CombinedBoundary{ Volume{:}; };
faces() -= root();
Physical Surface("rest") = faces();
