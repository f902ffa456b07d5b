// SPDX-License-Identifier: Apache-2.0
// Beam 20 m x 2 m x 2 m along x; shape 0: hexahedra, 1: tetrahedra.
DefineConstant[ n_length = 80 ]; // cells along the beam
DefineConstant[ n_side = 8 ];    // cells along each side of the section
DefineConstant[ shape = 0 ];

length = 20; side = 2; // m

Point(1) = {0, 0, 0};
Point(2) = {0, side, 0};
Point(3) = {0, side, side};
Point(4) = {0, 0, side};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n_side + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (shape == 0)
  Recombine Surface {1};
  out() = Extrude {length, 0, 0} { Surface {1}; Layers {n_length}; Recombine; };
Else
  out() = Extrude {length, 0, 0} { Surface {1}; Layers {n_length}; };
EndIf
Physical Surface("root") = {1};
Physical Surface("tip") = {out(0)};
Physical Surface("sides") = {out(2) : out(5)};
Physical Volume("beam") = {out(1)};
