// SPDX-License-Identifier: Apache-2.0
// Unit cube of n^3 hexahedra, finer towards all walls: corners at (1 + tanh(a (2 i/n - 1))/tanh(a))/2.
DefineConstant[ n = 40, a = 1.6 ];
one() = {};
height() = {};
For i In {1 : n}
  one() += 1;
  height() += 0.5 * (1 + Tanh(a * (2 * i / n - 1)) / Tanh(a));
EndFor
Point(1) = {0, 0, 0};
l() = Extrude {1, 0, 0} { Point{1}; Layers{one(), height()}; };
s() = Extrude {0, 1, 0} { Curve{l(1)}; Layers{one(), height()}; Recombine; };
v() = Extrude {0, 0, 1} { Surface{s(1)}; Layers{one(), height()}; Recombine; };
Physical Volume("fluid") = {v(1)};
lid() = Surface In BoundingBox {-0.1, 0.9, -0.1, 1.1, 1.1, 1.1};
all() = Abs(Boundary{ Volume{v(1)}; });
Physical Surface("lid") = {lid()};
all() -= {lid()};
Physical Surface("walls") = {all()};
