// SPDX-License-Identifier: Apache-2.0
// The plate as a volume; hexahedra, half as long as the fluid's.
DefineConstant[ n = 20 ];  // cells along height and width
DefineConstant[ layers = 2 ]; // through the thickness
half = 0.02;
Point(1) = {-half, 0, -0.5};
Point(2) = {half, 0, -0.5};
Point(3) = {half, 1, -0.5};
Point(4) = {-half, 1, -0.5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = layers + 1;
Transfinite Curve {2, 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
out() = Extrude {0, 0, 1} { Surface{1}; Layers{n}; Recombine; };
Physical Surface("root") = {out(2)};
Physical Surface("wet") = {1, out(0), out(3), out(4), out(5)};
Physical Volume("solid") = {out(1)};
