// SPDX-License-Identifier: Apache-2.0
// A quarter of a tube's inside: a square in the middle, two blocks around it, pulled along z.
DefineConstant[ n = 10, n_ring = 5, n_z = 80 ]; // cells of a side of the square, outwards, along the tube
R = 0.005; L = 0.05; s = 0.55 * R; d = 0.48 * R; q = R / Sqrt(2);
Point(1) = {0, 0, 0};
Point(2) = {s, 0, 0};
Point(3) = {d, d, 0};
Point(4) = {0, s, 0};
Point(5) = {R, 0, 0};
Point(6) = {q, q, 0};
Point(7) = {0, R, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {2, 5};
Line(6) = {3, 6};
Line(7) = {4, 7};
Circle(8) = {5, 1, 6};
Circle(9) = {6, 1, 7};
Transfinite Curve {1 : 4, 8, 9} = n + 1;
Transfinite Curve {5 : 7} = n_ring + 1;
Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 8, -6, -2};
Curve Loop(3) = {6, 9, -7, -3};
For i In {1 : 3}
  Plane Surface(i) = {i};
  Transfinite Surface {i};
  Recombine Surface {i};
EndFor
a() = Extrude {0, 0, L} { Surface{1}; Layers{n_z}; Recombine; };
b() = Extrude {0, 0, L} { Surface{2}; Layers{n_z}; Recombine; };
c() = Extrude {0, 0, L} { Surface{3}; Layers{n_z}; Recombine; };
// of an extruded surface: [0] the top, [1] the volume, then the sides in the order of its loop
Physical Surface("inlet") = {1, 2, 3};
Physical Surface("outlet") = {a(0), b(0), c(0)};
Physical Surface("bottom") = {a(2), b(2)};  // y = 0
Physical Surface("left") = {a(5), c(4)};    // x = 0
Physical Surface("wall") = {b(3), c(3)};
Physical Volume("fluid") = {a(1), b(1), c(1)};
