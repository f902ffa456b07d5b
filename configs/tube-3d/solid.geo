// SPDX-License-Identifier: Apache-2.0
// A quarter of the tube's wall; its inner faces are those of fluid.geo.
DefineConstant[ n = 10, n_wall = 4, n_z = 80 ]; // cells of an eighth of the circumference, through the wall, along the tube
R = 0.005; h = 0.001; L = 0.05; q = R / Sqrt(2); p = (R + h) / Sqrt(2);
Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0};
Point(3) = {q, q, 0};
Point(4) = {0, R, 0};
Point(5) = {R + h, 0, 0};
Point(6) = {p, p, 0};
Point(7) = {0, R + h, 0};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {5, 1, 6};
Circle(4) = {6, 1, 7};
Line(5) = {2, 5};
Line(6) = {3, 6};
Line(7) = {4, 7};
Transfinite Curve {1 : 4} = n + 1;
Transfinite Curve {5 : 7} = n_wall + 1;
Curve Loop(1) = {5, 3, -6, -1};
Curve Loop(2) = {6, 4, -7, -2};
For i In {1 : 2}
  Plane Surface(i) = {i};
  Transfinite Surface {i};
  Recombine Surface {i};
EndFor
a() = Extrude {0, 0, L} { Surface{1}; Layers{n_z}; Recombine; };
b() = Extrude {0, 0, L} { Surface{2}; Layers{n_z}; Recombine; };
Physical Surface("ends") = {1, 2, a(0), b(0)};
Physical Surface("bottom") = {a(2)};  // y = 0
Physical Surface("left") = {b(4)};    // x = 0
Physical Surface("outside") = {a(3), b(3)};
Physical Surface("wall") = {a(5), b(5)};
Physical Volume("solid") = {a(1), b(1)};
