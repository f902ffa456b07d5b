// SPDX-License-Identifier: Apache-2.0
// A rectangle or, with a depth, a box.
DefineConstant[ lx = 1, ly = 1, lz = 0, nx = 4, ny = 4, nz = 4, split = 0 ];  // split: triangles or tetrahedra
Point(1) = {0, 0, 0}; Point(2) = {lx, 0, 0}; Point(3) = {lx, ly, 0}; Point(4) = {0, ly, 0};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
Transfinite Curve {1, 3} = nx + 1; Transfinite Curve {2, 4} = ny + 1;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1}; Transfinite Surface {1} Alternate;
If (!split)
  Recombine Surface {1};
EndIf
If (lz == 0)
  Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4};
  Physical Surface("inside") = {1};
Else
  If (split)
    v() = Extrude {0, 0, lz} { Surface{1}; Layers{nz}; };
  Else
    v() = Extrude {0, 0, lz} { Surface{1}; Layers{nz}; Recombine; };
  EndIf
  Physical Surface("back") = {1}; Physical Surface("front") = {v(0)}; Physical Surface("bottom") = {v(2)}; Physical Surface("right") = {v(3)};
  Physical Surface("top") = {v(4)}; Physical Surface("left") = {v(5)}; Physical Volume("inside") = {v(1)};
EndIf
