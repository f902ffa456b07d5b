// SPDX-License-Identifier: Apache-2.0
// Quarter of a thick elliptic plate with an elliptic hole: x = (2 + 1.25 s) cos(phi), y = (1 + 1.75 s) sin(phi), with
// vertices uniform in s, phi and z and straight edges between them. A transfinite surface keeps both families of lines:
// the spokes are straight and evenly divided, the ellipses are given point by point.
DefineConstant [
  nr = 16,   // cells from the hole to the outer edge
  nt = 24,   // cells over the quarter
  nz = 12,   // cells over the thickness
  shape = 0  // 0 hexahedra, 1 prisms, 2 tetrahedra
];
thickness = 0.6; // m

For i In {0 : nt}
  phi = i * Pi / 2 / nt;
  Point(1 + i) = {2 * Cos(phi), Sin(phi), 0};
  Point(1001 + i) = {3.25 * Cos(phi), 2.75 * Sin(phi), 0};
EndFor
Point(3001) = {0, 0, 0};
Point(3002) = {2, 0, 0};    // on the longer axis of the hole
Point(3003) = {3.25, 0, 0}; // of the outer edge
For i In {1 : nt}
  Ellipse(i) = {i, 3001, 3002, i + 1};
  Ellipse(1000 + i) = {1000 + i, 3001, 3003, 1001 + i};
EndFor
Line(2001) = {1, 1001};       // y = 0
Line(2002) = {1 + nt, 1001 + nt}; // x = 0
Transfinite Curve {1 : nt, 1001 : 1000 + nt} = 2;
Transfinite Curve {2001, 2002} = nr + 1;
Curve Loop(1) = {2001, 1001 : 1000 + nt, -2002, -(nt) : -1};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 1001, 1001 + nt, 1 + nt};
If (shape == 0)
  Recombine Surface {1};
EndIf
If (shape < 2)
  out() = Extrude {0, 0, thickness} { Surface {1}; Layers {nz}; Recombine; };
Else
  out() = Extrude {0, 0, thickness} { Surface {1}; Layers {nz}; };
EndIf
Physical Surface("bottom") = {1};
Physical Surface("top") = {out(0)};
Physical Surface("symmetry-y") = {out(2)};
Physical Surface("outer") = {out(3) : out(2 + nt)};
Physical Surface("symmetry-x") = {out(3 + nt)};
Physical Surface("hole") = {out(4 + nt) : out(3 + 2 * nt)};
Physical Volume("plate") = {out(1)};
