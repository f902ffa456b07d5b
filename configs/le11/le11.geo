// SPDX-License-Identifier: Apache-2.0
// Quarter of the NAFEMS LE11 body: a sphere's cap, a taper and a cylinder, revolved about z. Four bands of cells along
// the wall; 2 x 3 x 10 cells times `refine` in each direction.
DefineConstant [
  refine = 4, // 1, 2, 4, 8: the four meshes of the thesis
  shape = 0   // 0 hexahedra, 1 prisms (two a hexahedron), 2 tetrahedra (three a prism)
];
s = Sqrt(0.5);
Point(1) = {0, 0, 0};
// inside: arc of radius 1 up to 45 degrees, then a cylinder of radius 0.7071
Point(10) = {1, 0, 0};
Point(11) = {Cos(Pi / 8), 0, Sin(Pi / 8)};
Point(12) = {s, 0, s};
Point(13) = {s, 0, 1.24855};
Point(14) = {s, 0, 1.79};
// outside: arc of radius 1.4 up to 30 degrees, a taper in two parts, a cylinder of radius 1
Point(20) = {1.4, 0, 0};
Point(21) = {1.4 * Cos(Pi / 6), 0, 0.7};
Point(22) = {(1.4 * Cos(Pi / 6) + 1) / 2, 0, 1.045};
Point(23) = {1, 0, 1.39};
Point(24) = {1, 0, 1.79};
Circle(10) = {10, 1, 11};
Circle(11) = {11, 1, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Circle(20) = {20, 1, 21};
Line(21) = {21, 22};
Line(22) = {22, 23};
Line(23) = {23, 24};
Line(30) = {10, 20};
Line(31) = {11, 21};
Line(32) = {12, 22};
Line(33) = {13, 23};
Line(34) = {14, 24};
For band In {0 : 3}
  Curve Loop(1 + band) = {30 + band, 20 + band, -(31 + band), -(10 + band)};
  Plane Surface(1 + band) = {1 + band};
EndFor
n_wall = 2 * refine;
n_first = 4 * refine;
n_other = 2 * refine;
Transfinite Curve {30 : 34} = n_wall + 1;
Transfinite Curve {10, 20} = n_first + 1;
Transfinite Curve {11 : 13, 21 : 23} = n_other + 1;
Transfinite Surface {1 : 4};
If (shape == 0)
  Recombine Surface {1 : 4};
EndIf
// out: {surface at x = 0, volume, base side, outside, top side, inside} for each band
If (shape < 2)
  out() = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Surface {1 : 4}; Layers {3 * refine}; Recombine; };
Else
  out() = Extrude {{0, 0, 1}, {0, 0, 0}, Pi / 2} { Surface {1 : 4}; Layers {3 * refine}; };
EndIf
Physical Surface("symmetry-y") = {1 : 4};
Physical Surface("symmetry-x") = {out(0), out(6), out(12), out(18)};
Physical Surface("base") = {out(2)};
Physical Surface("top") = {out(22)};
Physical Surface("outside") = {out(3), out(9), out(15), out(21)};
Physical Surface("inside") = {out(5), out(11), out(17), out(23)};
Physical Volume("body") = {out(1), out(7), out(13), out(19)};
