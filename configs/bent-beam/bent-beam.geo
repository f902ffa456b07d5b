// SPDX-License-Identifier: Apache-2.0
// A beam of square section, side 0.2 m, along z; n cells across, m along.
DefineConstant[ n = 4, m = 40, L = 2,
  shape = 0  // 0 hexahedra, 1 prisms along the beam (two a square), 2 tetrahedra (three a prism)
];
a = 0.2;
Point(1) = {-a/2, -a/2, 0};
Point(2) = {a/2, -a/2, 0};
Point(3) = {a/2, a/2, 0};
Point(4) = {-a/2, a/2, 0};
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
EndIf
If (shape < 2)
  out[] = Extrude {0, 0, L} { Surface{1}; Layers{m}; Recombine; };
Else
  out[] = Extrude {0, 0, L} { Surface{1}; Layers{m}; };
EndIf
Physical Surface("root") = {1};
Physical Surface("tip") = {out[0]};
Physical Surface("sides") = {out[2], out[3], out[4], out[5]};
Physical Volume("beam") = {out[1]};
