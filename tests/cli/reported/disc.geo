// SPDX-License-Identifier: Apache-2.0
// A disc of radius 1 m: a square within four sectors, or triangles.
DefineConstant[ n = 8, m = 6, triangles = 0, size = 0.15, layers = 0 ];
Point(1) = {0, 0, 0};
For i In {0:3}
  a = Pi/4 + i*Pi/2; Point(10+i) = {0.5*Cos(a), 0.5*Sin(a), 0}; Point(20+i) = {Cos(a), Sin(a), 0};
EndFor
For i In {0:3}
  j = (i + 1)%4; Circle(20+i) = {20+i, 1, 20+j};
EndFor
If (triangles)
  Mesh.MeshSizeMax = size; Curve Loop(1) = {20:23}; Plane Surface(1) = {1}; all[] = {1};
Else
  For i In {0:3}
    j = (i + 1)%4; Line(10+i) = {10+i, 10+j}; Line(30+i) = {10+i, 20+i};
    Transfinite Curve{10+i, 20+i} = n + 1; Transfinite Curve{30+i} = m + 1;
  EndFor
  Curve Loop(1) = {10:13}; Plane Surface(1) = {1};
  For i In {0:3}
    j = (i + 1)%4; Curve Loop(40+i) = {10+i, 30+j, -(20+i), -(30+i)}; Plane Surface(40+i) = {40+i};
  EndFor
  all[] = {1, 40:43}; Transfinite Surface{all[]}; Recombine Surface{all[]};
EndIf
If (layers)
  e[] = Extrude{0, 0, 0.5}{ Surface{all[]}; Layers{layers}; Recombine; };
  Physical Volume("water") = {1:#all[]};
  Physical Surface("bottom") = {all[]};
  If (triangles)
    Physical Surface("top") = {e[0]}; Physical Surface("wall") = {e[2], e[3], e[4], e[5]};
  Else
    Physical Surface("top") = {e[0], e[6], e[12], e[18], e[24]}; Physical Surface("wall") = {e[10], e[16], e[22], e[28]};
  EndIf
Else
  Physical Curve("wall") = {20:23}; Physical Surface("water") = {all[]};
EndIf
