// SPDX-License-Identifier: Apache-2.0
// A unit square or cube for prices.py.
DefineConstant[ n = 6, dimension = 2, split = 0 ];  // cells along a side; triangles or tetrahedra
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
If (!split)
  Recombine Surface {1};
EndIf
If (dimension == 2)
  Physical Curve("bottom") = {1};
  Physical Curve("right") = {2};
  Physical Curve("top") = {3};
  Physical Curve("left") = {4};
  Physical Surface("inside") = {1};
Else
  If (split)
    v() = Extrude {0, 0, 1} { Surface{1}; Layers{n}; };
  Else
    v() = Extrude {0, 0, 1} { Surface{1}; Layers{n}; Recombine; };
  EndIf
  Physical Surface("back") = {1};
  Physical Surface("front") = {v(0)};
  Physical Surface("bottom") = {v(2)};
  Physical Surface("right") = {v(3)};
  Physical Surface("top") = {v(4)};
  Physical Surface("left") = {v(5)};
  Physical Volume("inside") = {v(1)};
EndIf
