// SPDX-License-Identifier: Apache-2.0
// A column 1 x 6 x 1 m standing on its base, axis y; n cells across, m along; shape 0: hexahedra, 1: tetrahedra.
DefineConstant[ n = 8, m = 32, shape = 0 ];
Point(1) = {-0.5, 0, -0.5};
Point(2) = {0.5, 0, -0.5};
Point(3) = {0.5, 0, 0.5};
Point(4) = {-0.5, 0, 0.5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1:4} = n + 1;
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (shape == 0)
  Recombine Surface {1};
  out[] = Extrude {0, 6, 0} { Surface{1}; Layers{m}; Recombine; };
Else
  out[] = Extrude {0, 6, 0} { Surface{1}; Layers{m}; };
EndIf
Physical Surface("base") = {1};
Physical Surface("free") = {out[0], out[2], out[3], out[4], out[5]};
Physical Volume("column") = {out[1]};
