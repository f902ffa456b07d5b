// SPDX-License-Identifier: Apache-2.0
// A beam of 1 m x 1 m, L long; n cells across, nl along; shape 0: hexahedra, 1: tetrahedra.
DefineConstant [ n = 2, nl = 80, L = 40, shape = 1 ];
Point(1) = {0, 0, 0}; Point(2) = {0, 1, 0}; Point(3) = {0, 1, 1}; Point(4) = {0, 0, 1};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1:4} = n + 1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface{1};
If (shape == 0)
  Recombine Surface{1};
  o[] = Extrude {L, 0, 0} { Surface{1}; Layers{nl}; Recombine; };
Else
  o[] = Extrude {L, 0, 0} { Surface{1}; Layers{nl}; };
EndIf
Physical Surface("root") = {1};
Physical Surface("tip") = {o[0]};
Physical Surface("sides") = {o[2], o[3], o[4], o[5]};
Physical Volume("bar") = {o[1]};
